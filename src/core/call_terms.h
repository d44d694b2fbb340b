// Terms of a library call: threads, cancelling, progress and memory. They hold in the thread with a CallScope
// and in threads that parallelFor starts for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>

namespace glint {

// Counts memory and may refuse it by an exception.
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
    unsigned threads = 0;                  // that parallelFor uses by default; 0: defaultThreadCount()
    std::function<bool()> cancelled;       // asked by checkCancelled(), which parallelFor calls too
    std::function<void(double)> progress;  // by tellProgress(), from any thread
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

// Ends a call. Not an Error: those of a file that something is missing in may become warnings.
class Cancelled : public std::runtime_error {
  public:
    Cancelled() : std::runtime_error("cancelled by the caller") {}
};

// True if the caller wants no more.
bool callCancelled();
inline void checkCancelled() {
    if (callCancelled()) throw Cancelled();
}

// Tells the caller the part that is done, of the innermost ProgressPart.
void tellProgress(double fraction);

// For each step of a long loop of short steps, of which now and then one asks; with a count, it tells too.
inline void paceLoop(uint64_t step, uint64_t count = 0) {
    constexpr uint64_t kSteps = 1u << 14;  // some milliseconds
    if (step % kSteps != 0) return;
    checkCancelled();
    if (count > 0) tellProgress(static_cast<double>(step) / static_cast<double>(count));
}

// Checks for cancellation and reports progress at intervals while bytes are read.
class ReadingPace {
  public:
    ReadingPace(const char* begin, const char* end) : begin_(begin), end_(end), pause_(begin + kBytes) {}
    void reached(const char* at) {
        if (at >= pause_) pause(at);
    }

  private:
    static constexpr std::ptrdiff_t kBytes = 1 << 18;  // some milliseconds
    void pause(const char* at);

    const char* begin_;
    const char* end_;
    const char* pause_;  // may lie past the end
};

// While it lives, what is told in this thread, and in those that parallelFor starts for it, is the part from
// `from` to `to` of what was told before. Costs nothing where nobody listens.
class ProgressPart {
  public:
    ProgressPart(double from, double to);
    // The i-th of so many parts that take as long.
    static ProgressPart step(size_t i, size_t count) {
        const auto n = static_cast<double>(count);
        return {static_cast<double>(i) / n, static_cast<double>(i + 1) / n};
    }

  private:
    std::optional<CallTerms> terms_;
    std::optional<CallScope> scope_;
};

}  // namespace glint
