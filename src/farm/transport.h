// Messages between processes that render one image. Each process has a number, its rank, from 0.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace glint::farm {

using Bytes = std::vector<uint8_t>;

// One call at a time, from any thread; only finish() waits. Messages of one sender arrive in their order.
class Transport {
  public:
    struct Message {
        int from = 0;
        Bytes bytes;
    };

    virtual ~Transport() = default;
    virtual int rank() const = 0;
    virtual int size() const = 0;
    virtual void send(int to, const Bytes& bytes) = 0;
    virtual std::optional<Message> receive() = 0;
    // True while messages from here are on their way.
    virtual bool sending() = 0;
    // The last call; waits until all ranks make it.
    virtual void finish() = 0;
    // Ends all ranks.
    virtual void abort(int exitCode) = 0;
};

// ---- transport by MPI ----

// The rank of this process, from the environment that an MPI launcher sets. Empty without a launcher, or if
// this is its only process.
std::optional<int> launchedRank();

// True if openMpi() finds the module glint-mpi.so.
bool hasMpiModule();

// Joins the other processes. Throws Error(Failed) without the module, or with MPI's own error.
Transport& openMpi();

// finish() of that transport, which is gone then.
void finishMpi();

// Ends all processes with this exit code if openMpi() has joined them and they have not finished; otherwise
// does nothing.
void abortMpi(int exitCode);

}  // namespace glint::farm
