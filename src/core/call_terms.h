// What the caller of a library's call has to say about threads, cancelling and memory. In force in the thread
// that has a CallScope, and in those that parallelFor starts for it: nothing is global.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace glint {

// Who keeps count of memory, and may refuse it by an exception.
class MemoryAccount {
  public:
    MemoryAccount() = default;
    virtual ~MemoryAccount() = default;
    MemoryAccount(const MemoryAccount&) = delete;
    MemoryAccount& operator=(const MemoryAccount&) = delete;
    // From any thread.
    virtual void take(uint64_t bytes) = 0;
    virtual void give(uint64_t bytes) noexcept = 0;
};

// Bytes that an account counts as long as this lives.
class MemoryCharge {
  public:
    MemoryCharge() = default;
    MemoryCharge(std::shared_ptr<MemoryAccount> account, uint64_t bytes);
    ~MemoryCharge();
    MemoryCharge(MemoryCharge&& other) noexcept;
    MemoryCharge& operator=(MemoryCharge&& other) noexcept;
    uint64_t bytes() const { return bytes_; }

  private:
    std::shared_ptr<MemoryAccount> account_;
    uint64_t bytes_ = 0;
};

// On the account in force, if there is one. To be called before memory is taken: throws if it is refused.
MemoryCharge chargeMemory(uint64_t bytes);

struct CallTerms {
    unsigned threads = 0;             // that parallelFor uses by default; 0: defaultThreadCount()
    std::function<bool()> cancelled;  // asked by parallelFor, which ends with Error(Interrupted)
    std::shared_ptr<MemoryAccount> account;
};

// Its terms are in force in this thread until its end, in place of those before. Copies nothing.
class CallScope {
  public:
    explicit CallScope(const CallTerms* terms);
    ~CallScope();
    CallScope(const CallScope&) = delete;
    CallScope& operator=(const CallScope&) = delete;
    // Null: none.
    static const CallTerms* current();

  private:
    const CallTerms* before_;
};

}  // namespace glint
