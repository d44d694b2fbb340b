// Scenes as text for the tests of the readers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "import/load.h"
#include "import/readers.h"
#include "scene/scene.h"
#include "support/support.h"

namespace glint::test {

// What `action` throws: an Error with ErrorKind::Scene. The line and column before a JSON pointer, which
// hang on how a test lays out its text, are left out, but by placedErrorOf.
std::string placedErrorOf(const std::function<void()>& action);
std::string errorOf(const std::function<void()>& action);

using Lines = std::vector<std::string>;

// Parses with the file name "s.json" and an empty folder.
Scene parse(const std::string& text);
std::string parseErrorOf(const std::string& text);

std::vector<Shape> shapesOf(const Scene& scene);
// The mesh of an object, which must be one.
const Mesh& meshOf(const Scene& scene, size_t object = 0);

// Reads files of one name. Warnings come without the path and ": ", errors without the path (":3: what").
class OneFile {
  public:
    explicit OneFile(const std::string& name) : path_(folder_.path() / name) {}
    Scene scene(const std::string& bytes) const;
    ImportedMesh mesh(const std::string& bytes) const;
    std::string error(const std::string& bytes) const;  // of reading it as a scene

  private:
    TemporaryFolder folder_;
    std::filesystem::path path_;
};

// Appends a value; the tests run on little-endian machines.
template <typename T>
void put(std::string& bytes, T value, bool bigEndian = false) {
    const auto* const first = reinterpret_cast<const char*>(&value);
    const size_t begin = bytes.size();
    bytes.append(first, sizeof(T));
    if (bigEndian) std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.end());
}

// A cube [0,1]^3 with outward winding as OBJ text: 8 vertices, 6 quads.
extern const char* const kCubeObj;

}  // namespace glint::test
