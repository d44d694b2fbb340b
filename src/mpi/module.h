// The interface of glint-mpi.so, which glint loads if an MPI launcher has started it. The module stands by
// itself, so that glint runs without MPI. One call at a time, from any thread.
#pragma once

#include <cstdint>

namespace glint::mpi {

struct Module {
    int interface;  // kInterface
    // Null, or an error that is valid until the next call.
    const char* (*begin)(int* rank, int* size);
    // Copies the bytes and does not wait. Null, or an error.
    const char* (*send)(int to, const uint8_t* bytes, uint64_t size);
    // Size of the next message that has arrived whole, or -1; sets `from`.
    int64_t (*next)(int* from);
    // Copies that message.
    void (*take)(uint8_t* bytes);
    // Messages from here that are on their way.
    int (*sending)();
    // Waits for all ranks.
    void (*end)();
    // Ends all ranks.
    void (*abort)(int exitCode);
};

inline constexpr int kInterface = 2;
inline constexpr const char* kEntry = "glint_mpi_module";  // const Module* (*)()

}  // namespace glint::mpi
