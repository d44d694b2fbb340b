// Messages between processes that draw one picture, each of which has a number, its rank, from 0.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace glint::farm {

// All calls come from one thread, and none of them waits. What is sent to a rank that has ended is lost, and
// nobody says so. Messages of one sender arrive in their order.
class Transport {
  public:
    struct Message {
        int from = 0;
        std::vector<uint8_t> bytes;
    };

    virtual ~Transport() = default;
    virtual int rank() const = 0;
    virtual int size() const = 0;
    virtual void send(int to, const std::vector<uint8_t>& bytes) = 0;
    virtual std::optional<Message> receive() = 0;
    // Messages that are on their way from here, or are arriving.
    virtual int pending() const = 0;
    // The last call. `together`: all ranks make it, and it waits for them; otherwise some have gone.
    virtual void leave(bool together) = 0;
};

}  // namespace glint::farm
