#include "core/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace glint {

namespace {

// The state of one parallelFor call; each of its threads runs work().
class IndexLoop {
  public:
    IndexLoop(const Context& context, size_t count, const std::function<void(size_t)>& body)
        : context_(context), count_(count), body_(body) {}

    void work() {
        while (!stopped_.load(std::memory_order_relaxed)) {
            // A size_t counter cannot wrap: it passes count_ by at most the number of threads.
            const size_t index = next_.fetch_add(1, std::memory_order_relaxed);
            if (index >= count_) {
                return;
            }
            try {
                context_.checkCancelled();
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
    const Context& context_;
    const size_t count_;
    const std::function<void(size_t)>& body_;
    std::atomic<size_t> next_{0};
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;
    std::exception_ptr exception_;
};

std::atomic<unsigned> mostThreads = 0;  // 0: no limit

}  // namespace

void limitThreads(unsigned count) {
    mostThreads = count;
}

unsigned defaultThreadCount() {
    if (const unsigned most = mostThreads) return most;
    // The affinity mask and not hardware_concurrency(): containers and taskset narrow the former only.
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof(set), &set) == 0) {
        return std::max(1u, static_cast<unsigned>(CPU_COUNT(&set)));
    }
    // More than CPU_SETSIZE (1024) processors.
    return std::max(1u, std::thread::hardware_concurrency());
}

void parallelFor(const Context& context, size_t count, const std::function<void(size_t)>& body) {
    const size_t wanted =
        std::min<size_t>(count, context.threads == 0 ? defaultThreadCount() : context.threads);
    IndexLoop loop(context, count, body);
    {
        std::vector<std::jthread> helpers;  // joined at the end of this block
        try {
            while (helpers.size() + 1 < wanted) helpers.emplace_back([&loop] { loop.work(); });
        } catch (const std::system_error&) {
            // A limit on processes: the threads that run do the work.
        }
        loop.work();
    }
    loop.rethrow();
}

void parallelTasks(const Context& context, const std::vector<std::function<void()>>& tasks) {
    parallelFor(context, tasks.size(), [&](size_t i) { tasks[i](); });
}

}  // namespace glint
