// Paths, files, temporary folders and checks of texts for the tests of several modules.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace glint::test {

// ---- paths ----

// The path of a file of the repository: sourcePath("scenes/glass.json"). Only support.cpp holds the
// repository's path, so that a compiler cache serves every checkout.
std::string sourcePath(const std::string& name);

// A third-party model: in the folder that the environment variable GLINT_ASSETS names, or in ../shared/assets
// next to the repository. Reports a failure if it is not there.
std::filesystem::path assetPath(const std::string& name);

// ---- files ----

void writeText(const std::filesystem::path& path, const std::string& text);
void writeBytes(const std::filesystem::path& path, const std::vector<uint8_t>& bytes);
std::string readText(const std::filesystem::path& path);
std::vector<uint8_t> readBytes(const std::filesystem::path& path);

// An empty folder of its own that is gone afterwards.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const;

  private:
    std::filesystem::path path_;
};

// A test with such a folder.
class FolderTest : public testing::Test {
  protected:
    std::filesystem::path file(const std::string& name) const { return folder_ / name; }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        return owned_.write(name, bytes);
    }
    std::set<std::string> names() const;  // every name in the folder, hidden ones included

  private:
    const TemporaryFolder owned_;

  protected:
    const std::filesystem::path folder_ = owned_.path();
};

// The folder is the current one: messages then hold short, fixed file names.
class WorkingFolderTest : public FolderTest {
  protected:
    WorkingFolderTest();
    ~WorkingFolderTest() override;

  private:
    std::filesystem::path before_;
};

// ---- texts ----

// The text contains a part, lacks it, starts or ends with it. A failure prints both.
#define EXPECT_HAS(text, part) EXPECT_PRED_FORMAT2(::testing::IsSubstring, part, text)
#define EXPECT_LACKS(text, part) EXPECT_PRED_FORMAT2(::testing::IsNotSubstring, part, text)
#define EXPECT_STARTS(text, start) EXPECT_PRED2(::glint::test::startsWith, text, start)
#define EXPECT_ENDS(text, end) EXPECT_PRED2(::glint::test::endsWith, text, end)

inline bool startsWith(std::string_view text, std::string_view start) {
    return text.starts_with(start);
}
inline bool endsWith(std::string_view text, std::string_view end) {
    return text.ends_with(end);
}

// ---- numbers ----

// Each component to within the tolerance.
void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12);

// Compares the bytes of rows, which have no padding (shared/layout.h).
template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return std::ranges::equal(std::as_bytes(std::span(a)), std::as_bytes(std::span(b)));
}

// ---- errors ----

// The message of the Error that `action` throws: it must be of that kind, and one line. "no error" if nothing
// is thrown.
std::string errorOf(ErrorKind kind, const std::function<void()>& action);

// Runs `action` in a child process without the privileges of root, to whom permissions of files mean nothing;
// `folder` is made the child's own. What fails there fails here.
void withoutPrivileges(const std::filesystem::path& folder, const std::function<void()>& action);

}  // namespace glint::test
