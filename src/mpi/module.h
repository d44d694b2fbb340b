// What glint asks of the file glint-mpi.so, which is loaded where a launcher of MPI has started glint. It
// stands by itself, so that glint runs without MPI and starts without loading it. All calls come from one
// thread.
#pragma once

#include <cstdint>

namespace glint::mpi {

struct Module {
    int interface;  // kInterface
    // Null, or what went wrong. So do all that return a text; it is valid until the next call.
    const char* (*begin)(int* rank, int* size);
    // Copies the bytes and does not wait.
    const char* (*send)(int to, const uint8_t* bytes, uint64_t size);
    // Size of the next message that has arrived whole, or -1; `from` is set.
    int64_t (*next)(int* from);
    // Copies that message.
    void (*take)(uint8_t* bytes);
    // Messages on their way.
    int (*pending)();
    // Waits for all ranks.
    void (*end)();
};

inline constexpr int kInterface = 1;
inline constexpr const char* kEntry = "glint_mpi_module";  // const Module* (*)()

}  // namespace glint::mpi
