#include "app/output_check.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>

#include "core/error.h"
#include "core/image_io.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannotWrite(const fs::path& path, const std::string& reason) {
    throw Error(ErrorKind::Failed, path.string() + ": cannot write: " + reason);
}

std::string reasonOf(int errorNumber) {
    return std::generic_category().message(errorNumber);
}

// The number after `key` in a file of the kernel's, or the first number if `key` is empty; `fallback` without
// either ("max").
uint64_t numberIn(const char* file, const std::string& key, uint64_t fallback) {
    std::ifstream stream(file);
    for (std::string word; !key.empty() && stream >> word && word != key;) {
    }
    uint64_t value = 0;
    return stream >> value ? value : fallback;
}

std::string gibibytes(uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.1f GiB", static_cast<double>(bytes) / (1024.0 * 1024.0 * 1024.0));
    return text;
}

}  // namespace

void checkPicturePath(const fs::path& path) {
    if (!isWritableImagePath(path)) {
        throw Error(ErrorKind::Argument,
                    path.string() + ": unknown picture format (use .png, .exr, .pfm or .hdr)");
    }
    std::error_code ignored;
    const fs::path linked = fs::canonical(path, ignored);  // empty if there is no such file
    const fs::path target = linked.empty() ? path : linked;
    if (fs::is_directory(target, ignored)) cannotWrite(path, "it is a folder");
    if (fs::exists(target, ignored)) {
        if (access(target.c_str(), W_OK) != 0) cannotWrite(path, reasonOf(errno));
        if (!fs::is_regular_file(target, ignored)) return;  // a device or pipe is written to in place
    }
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (!fs::exists(folder, ignored)) cannotWrite(path, "there is no folder " + folder.string());
    if (!fs::is_directory(folder, ignored)) cannotWrite(path, folder.string() + " is not a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0) cannotWrite(path, reasonOf(errno));
}

void checkOutputFolder(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::exists(folder, ignored)) cannotWrite(folder, "there is no such folder");
    if (!fs::is_directory(folder, ignored)) cannotWrite(folder, "not a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0) cannotWrite(folder, reasonOf(errno));
}

uint64_t availableMemory() {
    constexpr uint64_t kUnknown = std::numeric_limits<uint64_t>::max();
    uint64_t available = kUnknown;
    const uint64_t system = numberIn("/proc/meminfo", "MemAvailable:", kUnknown);
    if (system != kUnknown) available = system * 1024;
    const char* const groups[][2] = {
        {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"},
        {"/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"}};
    for (const auto& [limitFile, usageFile] : groups) {
        const uint64_t limit = numberIn(limitFile, "", kUnknown);
        const uint64_t used = numberIn(usageFile, "", 0);
        if (limit != kUnknown) available = std::min(available, limit - std::min(limit, used));
    }
    return available;
}

void checkMemory(int width, int height, uint64_t bytesPerPixel, uint64_t available) {
    const uint64_t needed = static_cast<uint64_t>(width) * static_cast<uint64_t>(height) * bytesPerPixel;
    if (needed <= available) return;
    throw Error(ErrorKind::Failed,
                "a picture of " + std::to_string(width) + "x" + std::to_string(height) + " pixels takes " +
                    gibibytes(needed) + " of memory, " + gibibytes(available) +
                    " are free; ask for a smaller --size, or for parts with glint render --crop");
}

}  // namespace glint::app
