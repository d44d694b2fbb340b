// The "transform" of an object.
#pragma once

#include <string>

#include "import/json_cursor.h"
#include "scene/transform.h"

namespace glint {

// A list of steps, applied first to last, or 16 numbers by rows. The result is finite and has a condition
// number of at most kMaxCondition, else Error(Scene).
Affine parseTransform(const JsonCursor& transform);

// Throws the same error for a transform worked out elsewhere, which `context` names, from a blank on.
void checkTransform(const Affine& result, const JsonCursor& transform, const std::string& context);

}  // namespace glint
