#include "core/context.h"

#include <utility>

namespace glint {

MemoryCharge::MemoryCharge(std::shared_ptr<MemoryAccount> account, uint64_t bytes)
    : account_(std::move(account)) {
    if (account_) account_->take(bytes);
    bytes_ = account_ ? bytes : 0;
}

MemoryCharge::~MemoryCharge() {
    if (account_ && bytes_ > 0) account_->give(bytes_);
}

MemoryCharge::MemoryCharge(MemoryCharge&& other) noexcept
    : account_(std::move(other.account_)), bytes_(std::exchange(other.bytes_, 0)) {}

MemoryCharge& MemoryCharge::operator=(MemoryCharge&& other) noexcept {
    std::swap(account_, other.account_);
    std::swap(bytes_, other.bytes_);
    return *this;
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
