// What the tests of the command line share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/image.h"
#include "support/support.h"

namespace glint::app::test {

struct Ran {
    int code = -1;
    std::string out, err;
};

// The words of a command line: "render a.json -q", in which '' is an empty word, or a list where words hold
// spaces.
class Words : public std::vector<std::string> {
  public:
    Words() = default;
    Words(const char* line);
    Words(const std::string& line) : Words(line.c_str()) {}
    Words(std::initializer_list<std::string> words) : vector(words) {}
    Words& operator+=(const Words& more);
};
Words operator+(Words words, const Words& more);

// Runs a command line inside this process.
Ran runGlint(const Words& args, const Words& more = {});

// Runs a command line that must end with this exit code and print the line "glint: LINE" alone, on standard
// error.
void expectError(const Words& args, int code, const std::string& line);

// Runs a command line that must succeed without warnings, and reads the JSON that it prints.
nlohmann::json jsonOf(const Words& args);

// The numbers of a CSV's rows below its heading; NaN for empty fields.
std::vector<std::vector<double>> csvRows(const std::string& csv);

// Renders the scene at once and in so many parts, which must give the bytes of the same EXR file.
void expectPartsAreTheWhole(const std::string& scene, const Words& options, int parts);

// Whether the device that commands take has packets of rays.
bool hasPackets();

using FolderTest = glint::test::WorkingFolderTest;
using glint::test::errorOf;
using glint::test::readBytes;
using glint::test::writeText;

// A sphere of radius 1 round the origin, a triangle to its right and a mirror sphere to its left; camera at
// (0, 0, 5), one light. 64 x 48 pixels.
void writeSmallScene(const std::filesystem::path& path);

// The folder holds the small scene as a.json.
class SmallSceneTest : public FolderTest {
  protected:
    SmallSceneTest() { writeSmallScene("a.json"); }
    // Renders it; expects success and no output.
    static void render(const Words& options);
};

// The camera's right and up at unit distance for a picture with fovY 90 degrees are 1 and 1: easy to compute
// with. `rest` is JSON that follows the camera: objects, lights, materials.
std::string sceneText(int width, int height, const std::string& rest);

}  // namespace glint::app::test
