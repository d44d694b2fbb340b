// The thread that sends and receives the messages of a process, so that drawing need not.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "core/error.h"
#include "farm/scene_stream.h"
#include "farm/transport.h"

namespace glint::farm {

class Post {
  public:
    using Open = std::function<std::unique_ptr<Transport>()>;

    // What is to be done in the thread. Must not wait.
    class Handler {
      public:
        virtual ~Handler() = default;
        virtual void receive(int from, std::vector<uint8_t> bytes) = 0;
        // Now and then. `passed`: seconds since the last time, but no more than a process that was stopped
        // meanwhile had to listen.
        virtual void tick(double passed) = 0;
        // A message could not be sent, or what came could not be taken.
        virtual void fail(const Error& error) = 0;
    };

    // The transport is made in the thread. Throws what `open` throws.
    explicit Post(Open open);
    ~Post();
    Post(const Post&) = delete;
    Post& operator=(const Post&) = delete;

    int rank() const { return rank_; }
    int size() const { return size_; }

    // From then on messages are received.
    void start(Handler& handler);
    // From any thread.
    void send(int to, Bytes bytes);
    // Sends what is still to be sent, for at most a few seconds, and ends the thread. `together` as in
    // Transport::leave. The handler is not called any more when this returns.
    void leave(bool together);

  private:
    void run(const Open& open);
    void serve(Transport& transport);
    template <typename Act>
    void guarded(const Act& act);
    bool sendAll(Transport& transport);
    bool receiveAll(Transport& transport);
    void finish(Transport& transport);

    int rank_ = 0, size_ = 1;
    std::mutex mutex_;  // guards what follows
    std::condition_variable changed_;
    bool open_ = false, leaving_ = false, together_ = true;
    std::exception_ptr error_;
    Handler* handler_ = nullptr;
    std::deque<std::pair<int, Bytes>> outbox_;
    std::thread thread_;
};

}  // namespace glint::farm
