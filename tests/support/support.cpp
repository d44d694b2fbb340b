#include "support/support.h"

#include <grp.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace glint::test {

namespace fs = std::filesystem;

std::string sourcePath(const std::string& name) {
    return GLINT_SOURCE_DIR "/" + name;
}

fs::path assetPath(const std::string& name) {
    const char* given = std::getenv("GLINT_ASSETS");
    const fs::path folder = given ? fs::path(given) : fs::path(sourcePath("../shared/assets"));
    EXPECT_TRUE(fs::exists(folder / name))
        << folder / name << " is not there; GLINT_ASSETS may name the folder";
    return folder / name;
}

void writeText(const fs::path& path, const std::string& text) {
    std::ofstream stream(path, std::ios::binary);
    stream << text;
    EXPECT_TRUE(stream.good()) << path;
}

void writeBytes(const fs::path& path, const std::vector<uint8_t>& bytes) {
    writeText(path, std::string(bytes.begin(), bytes.end()));
}

std::string readText(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    EXPECT_TRUE(stream.good()) << path;
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::vector<uint8_t> readBytes(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TemporaryFolder::TemporaryFolder() {
    static std::atomic<int> count{0};
    path_ = fs::temp_directory_path() /
            ("glint_test_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::remove_all(path_);  // of a process of the same number that was killed
    fs::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::permissions(path_, fs::perms::owner_all, ignored);
    fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::write(const std::string& name, const std::string& bytes) const {
    writeText(path_ / name, bytes);
    return path_ / name;
}

std::set<std::string> FolderTest::names() const {
    std::set<std::string> result;
    for (const auto& entry : fs::directory_iterator(folder_)) result.insert(entry.path().filename().string());
    return result;
}

WorkingFolderTest::WorkingFolderTest() : before_(fs::current_path()) {
    fs::current_path(folder_);
}

WorkingFolderTest::~WorkingFolderTest() {
    fs::current_path(before_);
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

std::string errorOf(ErrorKind kind, const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << "not one line: " << message;
        return message;
    }
    return "no error";
}

void withoutPrivileges(const fs::path& folder, const std::function<void()>& action) {
    if (::geteuid() != 0) return action();
    constexpr uid_t kNobody = 65534;
    ASSERT_EQ(::chown(folder.c_str(), kNobody, kNobody), 0);
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        ASSERT_EQ(::lchown(entry.path().c_str(), kNobody, kNobody), 0);
    const pid_t child = ::fork();
    ASSERT_NE(child, -1);
    if (child == 0) {
        if (::setgroups(0, nullptr) != 0 || ::setgid(kNobody) != 0 || ::setuid(kNobody) != 0) ::_exit(2);
        action();  // prints what fails
        ::_exit(testing::Test::HasFailure() ? 1 : 0);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0) << "1: see the failures above; 2: privileges could not be dropped";
}

}  // namespace glint::test
