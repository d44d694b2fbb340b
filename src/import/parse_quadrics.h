// The objects that are quadrics.
#pragma once

#include <optional>
#include <string_view>

#include "import/json_cursor.h"
#include "import/scene_keys.h"
#include "scene/scene.h"

namespace glint {

// The keys of an object of this type, or null if it is no quadric.
const KeyTable* quadricKeys(std::string_view type);

// `object` has the type `type`; nothing if that is no quadric.
std::optional<Shape> parseQuadric(const JsonCursor& object, std::string_view type);

}  // namespace glint
