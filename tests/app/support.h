// What the tests of the command line share.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/image.h"

namespace glint::app::test {

struct Ran {
    int code = -1;
    std::string out, err;
};

// Runs a command line inside this process.
Ran runGlint(const std::vector<std::string>& args);

// A test with a folder of its own, which is the current one: messages then hold short, fixed file names.
class FolderTest : public ::testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

    std::set<std::string> names() const;  // every name in the folder, hidden ones included

    std::filesystem::path folder_;

  private:
    std::filesystem::path before_;
};

void writeText(const std::filesystem::path& path, const std::string& text);
std::vector<uint8_t> readBytes(const std::filesystem::path& path);

// A sphere of radius 1 round the origin, a triangle to its right and a mirror sphere to its left; camera at
// (0, 0, 5), one light. 64 x 48 pixels.
void writeSmallScene(const std::filesystem::path& path);

// The camera's right and up at unit distance for a picture with fovY 90 degrees are 1 and 1: easy to compute
// with. `rest` is JSON that follows the camera: objects, lights, materials.
std::string sceneText(int width, int height, const std::string& rest);

}  // namespace glint::app::test
