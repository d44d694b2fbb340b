#include "core/available_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/format.h"

namespace glint {

namespace {

namespace fs = std::filesystem;

constexpr uint64_t kUnknown = std::numeric_limits<uint64_t>::max();

// The number after the word `key` in a file of the kernel's, or the first number if `key` is empty;
// `fallback` without either ("max").
uint64_t numberIn(const fs::path& file, const std::string& key, uint64_t fallback) {
    std::ifstream stream(file);
    for (std::string word; !key.empty() && stream >> word && word != key;) {
    }
    uint64_t value = 0;
    return stream >> value ? value : fallback;
}

struct GroupFiles {
    const char* limit;
    const char* usage;
    const char* cache;  // the key in memory.stat of pages of files, which the kernel frees under pressure
};

constexpr GroupFiles kVersion1 = {"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr GroupFiles kVersion2 = {"memory.max", "memory.current", "inactive_file"};

uint64_t leftIn(const fs::path& group, const GroupFiles& files) {
    const uint64_t limit = numberIn(group / files.limit, "", kUnknown);
    if (limit == kUnknown) return kUnknown;
    const uint64_t usage = numberIn(group / files.usage, "", 0);
    const uint64_t used = usage - std::min(usage, numberIn(group / "memory.stat", files.cache, 0));
    return limit - std::min(limit, used);
}

// In the group `path` below `mount`, and in those around it. Inside a container the path may be that of the
// host, where there are no such folders but the root.
uint64_t leftInGroups(const fs::path& mount, std::string path, const GroupFiles& files) {
    uint64_t left = leftIn(mount, files);
    while (path.size() > 1) {
        left = std::min(left, leftIn(mount / path.substr(1), files));
        path.resize(path.rfind('/'));
    }
    return left;
}

// Lines of /proc/self/cgroup are NUMBER:CONTROLLERS:PATH; version 2 has number 0 and no controllers.
uint64_t leftInControlGroups(const fs::path& root) {
    const fs::path mounts = root / "sys/fs/cgroup";
    uint64_t left = std::min(leftIn(mounts, kVersion2), leftIn(mounts / "memory", kVersion1));
    std::ifstream stream(root / "proc/self/cgroup");
    for (std::string line; std::getline(stream, line);) {
        const size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos || line.compare(second + 1, 1, "/") != 0) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const std::string path = line.substr(second + 1);
        if (controllers == ",,") left = std::min(left, leftInGroups(mounts, path, kVersion2));
        if (controllers.find(",memory,") != std::string::npos)
            left = std::min(left, leftInGroups(mounts / "memory", path, kVersion1));
    }
    return left;
}

uint64_t leftOfAddressSpace(const fs::path& root) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
    const uint64_t pages = numberIn(root / "proc/self/statm", "", 0);
    const uint64_t used = pages * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
    return limit.rlim_cur - std::min<uint64_t>(limit.rlim_cur, used);
}

}  // namespace

uint64_t availableMemory(const fs::path& root) {
    const uint64_t system = numberIn(root / "proc/meminfo", "MemAvailable:", kUnknown);
    return std::min(
        {system == kUnknown ? kUnknown : system * 1024, leftInControlGroups(root), leftOfAddressSpace(root)});
}

std::string gibibytes(uint64_t bytes) {
    return format("%.1f GiB", static_cast<double>(bytes) / (1024.0 * 1024.0 * 1024.0));
}

void requireMemory(const std::string& what, uint64_t needed, uint64_t available, const std::string& remedy) {
    if (needed > available)
        throw Error(ErrorKind::Failed, what + " takes " + gibibytes(needed) + " of memory, " +
                                           gibibytes(available) + " are free; " + remedy);
}

void checkMemory(int width, int height, uint64_t bytesPerPixel, uint64_t available, const char* advice) {
    const uint64_t needed = static_cast<uint64_t>(width) * static_cast<uint64_t>(height) * bytesPerPixel;
    if (needed <= available) return;
    // Keep the aspect ratio.
    const double scale = std::sqrt(static_cast<double>(available) / static_cast<double>(needed));
    const auto fitting = [scale](int side) {
        return std::to_string(std::max(static_cast<int>(scale * side), 1));
    };
    requireMemory(format("an image of %dx%d pixels", width, height), needed, available,
                  "ask for a smaller --size (" + fitting(width) + "x" + fitting(height) + " fits)" + advice);
}

}  // namespace glint
