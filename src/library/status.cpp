#include "library/status.h"

#include <new>

#include "core/context.h"
#include "core/error.h"
#include "core/text_file.h"

namespace glint::library {

namespace {

thread_local std::string lastError;

void remember(const char* message) noexcept {
    try {
        lastError = printable(message);  // names are the caller's, or a file's
    } catch (...) {
        lastError.clear();
    }
}

glint_status statusOf(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::Argument:
            return GLINT_ERROR_ARGUMENT;
        case ErrorKind::Scene:
            return GLINT_ERROR_SCENE;
        case ErrorKind::Device:
            return GLINT_ERROR_DEVICE;
        case ErrorKind::Interrupted:
            return GLINT_ERROR_CANCELLED;
        case ErrorKind::Failed:
            return GLINT_ERROR_FAILED;
    }
    return GLINT_ERROR_FAILED;
}

}  // namespace

void refuse(const std::string& message) {
    throw Failure(GLINT_ERROR_ARGUMENT, message);
}

glint_status statusOfException() noexcept {
    try {
        throw;
    } catch (const Failure& failure) {
        remember(failure.what());
        return failure.status();
    } catch (const Error& error) {
        remember(error.what());
        return statusOf(error.kind());
    } catch (const Cancelled& cancelled) {
        remember(cancelled.what());
        return GLINT_ERROR_CANCELLED;
    } catch (const std::bad_alloc&) {
        remember("out of memory");
        return GLINT_ERROR_MEMORY;
    } catch (const std::length_error&) {
        remember("out of memory");
        return GLINT_ERROR_MEMORY;
    } catch (const std::exception& exception) {
        remember(exception.what());
        return GLINT_ERROR_FAILED;
    } catch (...) {
        remember("an unknown exception");
        return GLINT_ERROR_FAILED;
    }
}

}  // namespace glint::library

uint32_t glint_version() {
    return GLINT_VERSION_MAJOR * 1000000u + GLINT_VERSION_MINOR * 1000u + GLINT_VERSION_PATCH;
}

const char* glint_last_error() {
    return glint::library::lastError.c_str();
}

const char* glint_status_name(glint_status status) {
    switch (status) {
        case GLINT_OK:
            return "ok";
        case GLINT_ERROR_ARGUMENT:
            return "argument";
        case GLINT_ERROR_SCENE:
            return "scene";
        case GLINT_ERROR_DEVICE:
            return "device";
        case GLINT_ERROR_MEMORY:
            return "memory";
        case GLINT_ERROR_CANCELLED:
            return "cancelled";
        case GLINT_ERROR_CAPACITY:
            return "capacity";
        case GLINT_ERROR_FAILED:
            return "failed";
        default:
            return "unknown";
    }
}
