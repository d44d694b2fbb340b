#include "core/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/call_terms.h"

namespace glint {
namespace {

// The state of one parallelFor call; each of its threads runs work().
class IndexLoop {
  public:
    IndexLoop(size_t count, const std::function<void(size_t)>& body) : count_(count), body_(body) {}

    // For a helper: as the thread that started it.
    void workFor(const CallTerms* terms) {
        const CallScope scope(terms);
        work();
    }

    void work() {
        while (!stopped_.load(std::memory_order_relaxed)) {
            // A size_t counter cannot wrap: it passes count_ by at most the number of threads.
            const size_t index = next_.fetch_add(1, std::memory_order_relaxed);
            if (index >= count_) {
                return;
            }
            try {
                checkCancelled();
                body_(index);
            } catch (...) {
                const std::lock_guard lock(mutex_);
                if (!exception_) {
                    exception_ = std::current_exception();
                }
                stopped_ = true;
            }
        }
    }

    void rethrow() const {
        if (exception_) {
            std::rethrow_exception(exception_);
        }
    }

  private:
    const size_t count_;
    const std::function<void(size_t)>& body_;
    std::atomic<size_t> next_{0};
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;
    std::exception_ptr exception_;
};

}  // namespace

unsigned defaultThreadCount() {
    // The affinity mask and not hardware_concurrency(): containers and taskset narrow the former only.
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof(set), &set) == 0) {
        return std::max(1u, static_cast<unsigned>(CPU_COUNT(&set)));
    }
    // More than CPU_SETSIZE (1024) processors.
    return std::max(1u, std::thread::hardware_concurrency());
}

void parallelFor(size_t count, const std::function<void(size_t)>& body, unsigned threads) {
    const CallTerms* const terms = CallScope::current();
    if (threads == 0) threads = terms != nullptr ? terms->threads : 0;
    const size_t wanted = std::min<size_t>(count, threads == 0 ? defaultThreadCount() : threads);
    IndexLoop loop(count, body);
    {
        std::vector<std::jthread> helpers;  // joined at the end of this block
        try {
            for (size_t i = 1; i < wanted; ++i) {
                helpers.emplace_back([&loop, terms] { loop.workFor(terms); });
            }
        } catch (const std::system_error&) {
            // No further thread to be had (a limit on processes): those that run do the work.
        }
        loop.work();
    }
    loop.rethrow();
}

void parallelTasks(const std::vector<std::function<void()>>& tasks, unsigned threads) {
    parallelFor(
        tasks.size(), [&](size_t i) { tasks[i](); }, threads);
}

}  // namespace glint
