#include "mpi/module.h"

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <climits>
#include <cstring>
#include <deque>
#include <list>
#include <map>
#include <string>
#include <vector>

namespace glint::mpi {

namespace {

constexpr int kTag = 1;

struct Outgoing {
    std::vector<uint8_t> bytes;
    MPI_Request request = MPI_REQUEST_NULL;
};
struct Incoming {
    std::vector<uint8_t> bytes;
    MPI_Request request = MPI_REQUEST_NULL;
    bool whole = false;
};

std::list<Outgoing> outgoing;
// By sender. Whole ones are given out in the order in which they were sent: a small one may be whole before a
// large one that was sent first.
std::map<int, std::deque<Incoming>> incoming;
std::vector<uint8_t> arrived;
std::string fault;

const char* faultOf(int code, const char* what) {
    char text[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(code, text, &length);
    fault = std::string(what) + ": " + text;
    return fault.c_str();
}

const char* begin(int* rank, int* size) {
    int provided = 0;
    if (const int code = MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided))
        return faultOf(code, "MPI_Init_thread");
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_rank(MPI_COMM_WORLD, rank);
    MPI_Comm_size(MPI_COMM_WORLD, size);
    return nullptr;
}

const char* send(int to, const uint8_t* bytes, uint64_t size) {
    if (size > INT_MAX) {
        fault = "a message of more than 2 GiB";
        return fault.c_str();
    }
    Outgoing& made = outgoing.emplace_back();
    made.bytes.assign(bytes, bytes + size);
    const int code = MPI_Isend(made.bytes.data(), static_cast<int>(size), MPI_BYTE, to, kTag, MPI_COMM_WORLD,
                               &made.request);
    return code == MPI_SUCCESS ? nullptr : faultOf(code, "MPI_Isend");
}

void sweep() {
    outgoing.remove_if([](Outgoing& message) {
        int done = 0;
        return MPI_Test(&message.request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0;
    });
}

// Receives without waiting; a large message takes several calls.
void listen() {
    while (true) {
        int found = 0;
        MPI_Status status{};
        MPI_Message message = MPI_MESSAGE_NULL;
        if (MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &found, &message, &status) != MPI_SUCCESS ||
            found == 0)
            break;
        int size = 0;
        MPI_Get_count(&status, MPI_BYTE, &size);
        Incoming& made = incoming[status.MPI_SOURCE].emplace_back();
        made.bytes.resize(static_cast<size_t>(std::max(size, 0)));
        if (MPI_Imrecv(made.bytes.data(), size, MPI_BYTE, &message, &made.request) != MPI_SUCCESS)
            incoming[status.MPI_SOURCE].pop_back();
    }
    for (auto& [from, messages] : incoming)
        for (Incoming& message : messages) {
            int done = 0;
            if (!message.whole && MPI_Test(&message.request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS)
                message.whole = done != 0;
        }
}

int64_t next(int* from) {
    sweep();
    listen();
    for (auto& [sender, messages] : incoming) {
        if (messages.empty() || !messages.front().whole) continue;
        arrived = std::move(messages.front().bytes);
        messages.pop_front();
        *from = sender;
        return static_cast<int64_t>(arrived.size());
    }
    return -1;
}

void take(uint8_t* bytes) {
    std::copy(arrived.begin(), arrived.end(), bytes);
    arrived.clear();
}

int sending() {
    sweep();
    return static_cast<int>(outgoing.size());
}

void end() {
    MPI_Finalize();
}

void abort(int exitCode) {
    MPI_Abort(MPI_COMM_WORLD, exitCode);
}

constexpr Module kModule = {kInterface, begin, send, next, take, sending, end, abort};

}  // namespace

}  // namespace glint::mpi

extern "C" __attribute__((visibility("default"))) const glint::mpi::Module* glint_mpi_module() {
    return &glint::mpi::kModule;
}
