#include "core/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/call_terms.h"
#include "core/thread_count.h"

namespace glint {

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

namespace {

// The innermost KeptThreads of this thread, or null.
thread_local KeptThreads::Team* teamInForce = nullptr;

// Fewer where no further thread is to be had (a limit on processes): those that run do the work.
template <class Body>
void startUpTo(size_t count, std::vector<std::jthread>& threads, const Body& body) {
    try {
        while (threads.size() < count) threads.emplace_back(body);
    } catch (const std::system_error&) {
    }
}

}  // namespace

class KeptThreads::Team {
  public:
    ~Team() {
        {
            const std::lock_guard lock(mutex_);
            ended_ = true;
        }
        called_.notify_all();
    }

    // False, and nothing is done, in a body of the same thread's.
    bool run(IndexLoop& loop, size_t helpers, const CallTerms* terms) {
        if (busy_) return false;
        busy_ = true;
        startUpTo(helpers, threads_, [this] { serve(); });
        {
            const std::lock_guard lock(mutex_);
            loop_ = &loop;
            terms_ = terms;
            places_ = helpers;
        }
        for (size_t i = 0; i < helpers; ++i) called_.notify_one();
        loop.work();
        std::unique_lock lock(mutex_);
        places_ = 0;  // who has not come by now is not waited for
        left_.wait(lock, [this] { return working_ == 0; });
        busy_ = false;
        return true;
    }

  private:
    void serve() {
        std::unique_lock lock(mutex_);
        for (;;) {
            called_.wait(lock, [this] { return ended_ || places_ > 0; });
            if (ended_) return;
            --places_;
            ++working_;
            IndexLoop* const loop = loop_;
            const CallTerms* const terms = terms_;
            lock.unlock();
            loop->workFor(terms);
            lock.lock();
            if (--working_ == 0) left_.notify_one();
        }
    }

    std::mutex mutex_;
    std::condition_variable called_, left_;
    IndexLoop* loop_ = nullptr;
    const CallTerms* terms_ = nullptr;
    size_t places_ = 0, working_ = 0;
    bool ended_ = false;
    bool busy_ = false;                  // of the thread that has the team
    std::vector<std::jthread> threads_;  // joined before anything else goes
};

KeptThreads::KeptThreads()
    : team_(std::make_unique<Team>()), before_(std::exchange(teamInForce, team_.get())) {}
KeptThreads::~KeptThreads() {
    teamInForce = before_;
}

namespace {
std::atomic<unsigned> mostThreads = 0;  // 0: no limit
}

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

void parallelFor(size_t count, const std::function<void(size_t)>& body, unsigned threads) {
    const CallTerms* const terms = CallScope::current();
    if (threads == 0) threads = terms != nullptr ? terms->threads : 0;
    const size_t wanted = std::min<size_t>(count, threads == 0 ? defaultThreadCount() : threads);
    IndexLoop loop(count, body);
    const bool kept = wanted > 1 && teamInForce != nullptr && teamInForce->run(loop, wanted - 1, terms);
    if (!kept) {
        std::vector<std::jthread> helpers;  // joined at the end of this block
        if (wanted > 1) startUpTo(wanted - 1, helpers, [&loop, terms] { loop.workFor(terms); });
        loop.work();
    }
    loop.rethrow();
}

void parallelTasks(const std::vector<std::function<void()>>& tasks, unsigned threads) {
    parallelFor(
        tasks.size(), [&](size_t i) { tasks[i](); }, threads);
}

}  // namespace glint
