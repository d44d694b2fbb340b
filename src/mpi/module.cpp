// glint-mpi.so, which glint loads if an MPI launcher has started it: glint itself runs without MPI.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <climits>
#include <deque>
#include <list>
#include <map>
#include <stdexcept>
#include <string>

#include "farm/transport.h"

namespace glint::farm {

namespace {

constexpr int kTag = 1;

struct Outgoing {
    Bytes bytes;
    MPI_Request request = MPI_REQUEST_NULL;
};
struct Incoming {
    Bytes bytes;
    MPI_Request request = MPI_REQUEST_NULL;
    bool whole = false;
};

void check(int code, const char* what) {
    char text[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    if (code == MPI_SUCCESS) return;
    MPI_Error_string(code, text, &length);
    throw std::runtime_error(std::string("MPI: ") + what + ": " + text);
}

class MpiTransport : public Transport {
  public:
    MpiTransport() {
        int provided = 0;
        check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "MPI_Init_thread");
        MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &size_);
    }
    int rank() const override { return rank_; }
    int size() const override { return size_; }
    void send(int to, const Bytes& bytes) override {
        if (bytes.size() > INT_MAX) throw std::runtime_error("MPI: a message of more than 2 GiB");
        Outgoing& made = outgoing_.emplace_back(Outgoing{bytes});
        check(MPI_Isend(made.bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, kTag, MPI_COMM_WORLD,
                        &made.request),
              "MPI_Isend");
    }
    std::optional<Message> receive() override {
        sending();
        listen();
        for (auto& [sender, messages] : incoming_) {
            if (messages.empty() || !messages.front().whole) continue;
            Message message{sender, std::move(messages.front().bytes)};
            messages.pop_front();
            return message;
        }
        return std::nullopt;
    }
    bool sending() override {
        outgoing_.remove_if([](Outgoing& message) {
            int done = 0;
            return MPI_Test(&message.request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0;
        });
        return !outgoing_.empty();
    }
    void finish() override { MPI_Finalize(); }
    void abort(int exitCode) override { MPI_Abort(MPI_COMM_WORLD, exitCode); }

  private:
    // Receives without waiting; a large message takes several calls.
    void listen();

    int rank_ = 0, size_ = 1;
    std::list<Outgoing> outgoing_;
    // By sender. Whole ones are given out in the order in which they were sent: a small one may be whole
    // before a large one that was sent first.
    std::map<int, std::deque<Incoming>> incoming_;
};

void MpiTransport::listen() {
    while (true) {
        int found = 0;
        MPI_Status status{};
        MPI_Message message = MPI_MESSAGE_NULL;
        if (MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &found, &message, &status) != MPI_SUCCESS ||
            found == 0)
            break;
        int size = 0;
        MPI_Get_count(&status, MPI_BYTE, &size);
        Incoming& made = incoming_[status.MPI_SOURCE].emplace_back();
        made.bytes.resize(static_cast<size_t>(std::max(size, 0)));
        if (MPI_Imrecv(made.bytes.data(), size, MPI_BYTE, &message, &made.request) != MPI_SUCCESS)
            incoming_[status.MPI_SOURCE].pop_back();
    }
    for (auto& [from, messages] : incoming_)
        for (Incoming& message : messages) {
            int done = 0;
            if (!message.whole && MPI_Test(&message.request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS)
                message.whole = done != 0;
        }
}

}  // namespace

}  // namespace glint::farm

extern "C" __attribute__((visibility("default"))) glint::farm::Transport* glint_mpi_transport_3() {
    return new glint::farm::MpiTransport;
}
