#include "farm/post.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/stopwatch.h"

namespace glint::farm {

namespace {

using namespace std::chrono_literals;

constexpr double kTick = 0.05;        // seconds between two ticks, or somewhat more
constexpr double kLongestTick = 0.5;  // that counts
constexpr double kLastWords = 3;      // seconds for what is still to be sent at the end

// How long to sleep where nothing came: messages come in crowds or hardly ever, and in a machine with more
// processes than processors whoever looks for them takes the time of those who draw.
class Rest {
  public:
    void disturb() { time_ = kShortest; }
    // `pending`: large messages go piece by piece, one with each look.
    std::chrono::microseconds next(bool pending) {
        const auto now = time_;
        time_ = std::min(pending ? kLongestPending : kLongest, 2 * time_);
        return now;
    }

  private:
    static constexpr std::chrono::microseconds kShortest = 10us, kLongestPending = 200us, kLongest = 2000us;
    std::chrono::microseconds time_ = kShortest;
};

}  // namespace

Post::Post(Open open) : thread_([this, open = std::move(open)] { run(open); }) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return open_ || error_; });
    if (!error_) return;
    lock.unlock();
    thread_.join();
    std::rethrow_exception(error_);
}

Post::~Post() {
    leave(false);
}

void Post::run(const Open& open) {
    std::unique_ptr<Transport> transport;
    try {
        transport = open();
    } catch (...) {
        const std::lock_guard lock(mutex_);
        error_ = std::current_exception();
        changed_.notify_all();
        return;
    }
    {
        std::unique_lock lock(mutex_);
        rank_ = transport->rank();
        size_ = transport->size();
        open_ = true;
        changed_.notify_all();
        changed_.wait(lock, [&] { return handler_ || leaving_; });
    }
    if (handler_) serve(*transport);
    finish(*transport);
}

void Post::start(Handler& handler) {
    const std::lock_guard lock(mutex_);
    handler_ = &handler;
    changed_.notify_all();
}

void Post::send(int to, Bytes bytes) {
    const std::lock_guard lock(mutex_);
    outbox_.emplace_back(to, std::move(bytes));
    changed_.notify_all();
}

void Post::leave(bool together) {
    {
        const std::lock_guard lock(mutex_);
        if (!leaving_) together_ = together;
        leaving_ = true;
        changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
}

template <typename Act>
void Post::guarded(const Act& act) {
    try {
        act();
    } catch (const Error& error) {
        if (handler_) handler_->fail(error);
    } catch (const std::exception& error) {
        if (handler_) handler_->fail(Error(ErrorKind::Failed, error.what()));
    }
}

bool Post::sendAll(Transport& transport) {
    std::deque<std::pair<int, Bytes>> letters;
    {
        const std::lock_guard lock(mutex_);
        letters.swap(outbox_);
    }
    for (const auto& letter : letters) guarded([&] { transport.send(letter.first, *letter.second); });
    return !letters.empty();
}

bool Post::receiveAll(Transport& transport) {
    bool any = false;
    guarded([&] {
        while (auto message = transport.receive()) {
            any = true;
            handler_->receive(message->from, std::move(message->bytes));
        }
    });
    return any;
}

void Post::serve(Transport& transport) {
    Rest rest;
    Stopwatch sinceTick;
    int pending = 0;
    while (true) {
        const bool moved = sendAll(transport) | receiveAll(transport) | (transport.pending() != pending);
        pending = transport.pending();
        if (moved) rest.disturb();
        if (const double passed = sinceTick.seconds(); passed >= kTick) {
            sinceTick.restart();
            guarded([&] { handler_->tick(std::min(passed, kLongestTick)); });
        }
        std::unique_lock lock(mutex_);
        if (leaving_) return;
        if (!moved && outbox_.empty()) changed_.wait_for(lock, rest.next(pending > 0));
    }
}

void Post::finish(Transport& transport) {
    sendAll(transport);
    const Stopwatch watch;
    while (transport.pending() > 0 && watch.seconds() < kLastWords) {
        // What arrives now is taken and forgotten: some messages leave only when they are received.
        if (!transport.receive()) std::this_thread::sleep_for(100us);
    }
    transport.leave(together_);
}

}  // namespace glint::farm
