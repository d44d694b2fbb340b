// What the system, control groups and limits of the process leave.
#include "core/available_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include "support/support.h"

namespace glint::available_memory_test {
constexpr uint64_t kMebibyte = uint64_t{1} << 20;

// A machine of folders and files.
class AvailableMemory : public test::FolderTest {
  protected:
    void write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories(file(name).parent_path());
        test::writeText(file(name), text);
    }
    static std::string mebibytes(uint64_t count) { return std::to_string(count * kMebibyte) + "\n"; }
    void SetUp() override {
        write("proc/meminfo", "MemTotal:       9000000 kB\nMemFree: 1 kB\nMemAvailable:    4096000 kB\n");
    }
};

TEST_F(AvailableMemory, IsWhatTheSystemSays) {
    EXPECT_EQ(availableMemory(folder_), 4000 * kMebibyte);
    EXPECT_EQ(availableMemory(folder_ / "nowhere"), std::numeric_limits<uint64_t>::max());
}

// The group's own limit is above that of the group around it; pages of files can be had back.
TEST_F(AvailableMemory, IsLessInControlGroups) {
    write("proc/self/cgroup", "0::/box/inner\n");
    write("sys/fs/cgroup/box/inner/memory.max", "max\n");
    write("sys/fs/cgroup/box/inner/memory.current", mebibytes(100));
    EXPECT_EQ(availableMemory(folder_), 4000 * kMebibyte);
    write("sys/fs/cgroup/box/memory.max", mebibytes(500));
    write("sys/fs/cgroup/box/memory.current", mebibytes(200));
    EXPECT_EQ(availableMemory(folder_), 300 * kMebibyte);
    write("sys/fs/cgroup/box/memory.stat", "anon 5\ninactive_file " + mebibytes(50));
    EXPECT_EQ(availableMemory(folder_), 350 * kMebibyte);
    write("sys/fs/cgroup/box/memory.current", mebibytes(600));
    EXPECT_EQ(availableMemory(folder_), 0u);
}

TEST_F(AvailableMemory, IsLessInControlGroupsOfVersion1) {
    write("proc/self/cgroup", "5:devices:/\n4:cpu,memory:/box\n0::/\n");
    write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    EXPECT_EQ(availableMemory(folder_), 4000 * kMebibyte);
    write("sys/fs/cgroup/memory/box/memory.limit_in_bytes", mebibytes(300));
    write("sys/fs/cgroup/memory/box/memory.usage_in_bytes", mebibytes(100));
    EXPECT_EQ(availableMemory(folder_), 200 * kMebibyte);
}

TEST_F(AvailableMemory, IsLessWithLittleAddressSpace) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
    write("proc/self/statm", "10000 1 1\n");  // pages
    const auto page = static_cast<uint64_t>(::getpagesize());
    rlimit limit = before;
    limit.rlim_cur = std::min<rlim_t>(before.rlim_max, rlim_t{1} << 50);
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
    write("proc/meminfo", "MemAvailable: 9000000000000000 kB\n");
    const uint64_t available = availableMemory(folder_);
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(available, limit.rlim_cur - 10000 * page);
}

}  // namespace glint::available_memory_test
