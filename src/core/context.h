// Terms of a call, passed as `const Context&` to every function that takes long: host threads, cancelling,
// progress and memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
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

// Bytes that an account counts until the last copy is gone; empty without an account.
using MemoryCharge = std::shared_ptr<void>;

// Ends a call. Not an Error: the reader of a damaged file turns some Errors into warnings.
class Cancelled : public std::runtime_error {
  public:
    Cancelled() : std::runtime_error("cancelled by the caller") {}
};

// The default: all processors, never cancelled, no progress, no account. All functions may be called from any
// thread.
struct Context {
    unsigned threads = 0;                       // host threads of parallelFor; 0: defaultThreadCount()
    std::function<bool()> cancelled = {};       // true: the call should end
    std::function<void(double)> progress = {};  // receives the fraction done
    std::shared_ptr<MemoryAccount> account = {};

    bool isCancelled() const { return cancelled && cancelled(); }
    // Throws Cancelled.
    void checkCancelled() const {
        if (isCancelled()) throw Cancelled();
    }
    void report(double fraction) const {
        if (progress) progress(fraction);
    }
    // For each step of a long loop of short steps: checks for cancellation, and with a count reports
    // progress, now and then.
    void pace(uint64_t step, uint64_t count = 0) const {
        constexpr uint64_t kSteps = 1u << 14;  // some milliseconds
        if (step % kSteps != 0) return;
        checkCancelled();
        if (count > 0) report(static_cast<double>(step) / static_cast<double>(count));
    }
    // To be called before memory is taken: throws if the account refuses it.
    MemoryCharge charge(uint64_t bytes) const;

    // The context of a part of the call, whose progress 0 to 1 is `from` to `to` of this one's. Reports
    // `from`.
    Context part(double from, double to) const;
    // Part i of `count` parts that take the same time.
    Context step(size_t i, size_t count) const {
        const auto n = static_cast<double>(count);
        return part(static_cast<double>(i) / n, static_cast<double>(i + 1) / n);
    }
};

// Checks for cancellation and reports progress at intervals while bytes are read. The context must outlive
// it.
class ReadingPace {
  public:
    ReadingPace(const Context& context, const char* begin, const char* end)
        : context_(&context), begin_(begin), end_(end), pause_(begin + kBytes) {}
    void reached(const char* at) {
        if (at >= pause_) pause(at);
    }

  private:
    static constexpr std::ptrdiff_t kBytes = 1 << 18;  // some milliseconds
    void pause(const char* at);

    const Context* context_;
    const char* begin_;
    const char* end_;
    const char* pause_;  // may lie past the end
};

}  // namespace glint
