#include "core/call_terms.h"

#include <utility>

namespace glint {

namespace {

thread_local const CallTerms* termsInForce = nullptr;

}  // namespace

MemoryCharge::MemoryCharge(std::shared_ptr<MemoryAccount> account, uint64_t bytes)
    : account_(std::move(account)) {
    if (account_) account_->take(bytes);
    bytes_ = bytes;
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

MemoryCharge chargeMemory(uint64_t bytes) {
    const CallTerms* const terms = CallScope::current();
    return terms != nullptr && terms->account ? MemoryCharge(terms->account, bytes) : MemoryCharge();
}

CallScope::CallScope(const CallTerms* terms) : before_(std::exchange(termsInForce, terms)) {}
CallScope::~CallScope() {
    termsInForce = before_;
}
const CallTerms* CallScope::current() {
    return termsInForce;
}

bool callCancelled() {
    const CallTerms* const terms = CallScope::current();
    return terms != nullptr && terms->cancelled && terms->cancelled();
}

void tellProgress(double fraction) {
    const CallTerms* const terms = CallScope::current();
    if (terms != nullptr && terms->progress) terms->progress(fraction);
}

void ReadingPace::pause(const char* at) {
    pause_ = at + kBytes;
    checkCancelled();
    tellProgress(static_cast<double>(at - begin_) / static_cast<double>(end_ - begin_));
}

ProgressPart::ProgressPart(double from, double to) {
    const CallTerms* const outer = CallScope::current();
    if (outer == nullptr || !outer->progress) return;
    outer->progress(from);
    terms_ = *outer;
    terms_->progress = [outer, from, to](double fraction) { outer->progress(from + fraction * (to - from)); };
    scope_.emplace(&*terms_);
}

}  // namespace glint
