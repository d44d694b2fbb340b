// Converts exceptions to statuses of the C API.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>

#include "glint/glint.h"

namespace glint::library {

// A failure with a status of its own.
class Failure : public std::runtime_error {
  public:
    Failure(glint_status status, const std::string& message) : std::runtime_error(message), status_(status) {}
    glint_status status() const { return status_; }

  private:
    glint_status status_;
};

// Throws Failure(GLINT_ERROR_ARGUMENT).
[[noreturn]] void refuse(const std::string& message);
inline void require(bool holds, const char* message) {
    if (!holds) refuse(message);
}

// Stores the current exception's message for this thread and returns its status. Call it in a handler.
glint_status statusOfException() noexcept;

// Runs the body of an API call.
template <class Body>
glint_status guarded(Body&& body) noexcept {
    try {
        body();
        return GLINT_OK;
    } catch (...) {
        return statusOfException();
    }
}

// Runs the body of a call whose refusals all begin with its name.
template <class Body>
glint_status guarded(const char* call, Body&& body) noexcept {
    return guarded([&] {
        try {
            body();
        } catch (const Failure& failure) {
            if (failure.status() != GLINT_ERROR_ARGUMENT) throw;
            refuse(std::string(call) + ": " + failure.what());
        }
    });
}

// A caller's struct in this version's layout; members that an older caller lacks are zero. `what` names it.
template <class Struct>
Struct readStruct(const Struct* given, const char* what) {
    if (given == nullptr) refuse(std::string(what) + " is NULL");
    constexpr uint64_t kMostPlausible = 4096;
    if (given->size < sizeof(uint64_t) || given->size > kMostPlausible)
        refuse(std::string(what) + ".size is not set: GLINT_INIT does it");
    Struct known{};
    std::memcpy(&known, given, given->size < sizeof(Struct) ? given->size : sizeof(Struct));
    known.size = sizeof(Struct);
    return known;
}

// Writes as much as the caller's struct holds.
template <class Struct>
void writeStruct(Struct* wanted, Struct known, const char* what) {
    readStruct(wanted, what);
    known.size = wanted->size;
    std::memcpy(static_cast<void*>(wanted), &known,
                wanted->size < sizeof(Struct) ? wanted->size : sizeof(Struct));
}

}  // namespace glint::library
