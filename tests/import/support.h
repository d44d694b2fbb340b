// Files and errors for the scene tests.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "scene/scene.h"

namespace glint::test {

// A folder of its own that is gone after the test.
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

// What `action` throws: it must be an Error with ErrorKind::Scene, and one line. "no error" if it throws
// nothing.
std::string errorOf(const std::function<void()>& action);

// Parses with the file name "s.json" and an empty folder.
Scene parse(const std::string& text);
std::string parseErrorOf(const std::string& text);

// The folder with third-party models beside the source tree, or an empty path.
std::filesystem::path assetsFolder();

// A cube [0,1]^3 with outward winding as OBJ text: 8 vertices, 6 quads.
extern const char* const kCubeObj;

}  // namespace glint::test
