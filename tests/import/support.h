// Scenes as text for the tests of the readers.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "scene/scene.h"
#include "support/support.h"

namespace glint::test {

// What `action` throws: an Error with ErrorKind::Scene. The line and column before a JSON pointer, which
// hang on how a test lays out its text, are left out, but by placedErrorOf.
std::string placedErrorOf(const std::function<void()>& action);
std::string errorOf(const std::function<void()>& action);

// Parses with the file name "s.json" and an empty folder.
Scene parse(const std::string& text);
std::string parseErrorOf(const std::string& text);

// A cube [0,1]^3 with outward winding as OBJ text: 8 vertices, 6 quads.
extern const char* const kCubeObj;

}  // namespace glint::test
