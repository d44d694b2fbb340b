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
    std::atomic<size_t> next{0};
    std::atomic<bool> stopped{false};
    std::mutex mutex;  // guards the exception
    std::exception_ptr exception;
    const auto work = [&] {
        while (!stopped.load(std::memory_order_relaxed)) {
            // A size_t counter cannot wrap: it passes `count` by at most the number of threads.
            const size_t index = next.fetch_add(1, std::memory_order_relaxed);
            if (index >= count) return;
            try {
                context.checkCancelled();
                body(index);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!exception) exception = std::current_exception();
                stopped = true;
            }
        }
    };
    {
        std::vector<std::jthread> helpers;  // joined at the end of this block
        try {
            while (helpers.size() + 1 < wanted) helpers.emplace_back(work);
        } catch (const std::system_error&) {
            // A limit on processes: the threads that run do the work.
        }
        work();
    }
    if (exception) std::rethrow_exception(exception);
}

void parallelTasks(const Context& context, const std::vector<std::function<void()>>& tasks) {
    parallelFor(context, tasks.size(), [&](size_t i) { tasks[i](); });
}

}  // namespace glint
