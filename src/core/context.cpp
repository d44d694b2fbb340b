#include "core/context.h"

namespace glint {

MemoryCharge Context::charge(uint64_t bytes) const {
    if (!account) return {};
    account->take(bytes);
    return {account.get(), [held = account, bytes](MemoryAccount*) { held->give(bytes); }};
}

Context Context::part(double from, double to) const {
    report(from);
    Context part = *this;
    if (progress)
        part.progress = [whole = progress, from, to](double fraction) {
            whole(from + fraction * (to - from));
        };
    return part;
}

void ReadingPace::pause(const char* at) {
    pause_ = at + kBytes;
    context_->checkCancelled();
    context_->report(static_cast<double>(at - begin_) / static_cast<double>(end_ - begin_));
}

}  // namespace glint
