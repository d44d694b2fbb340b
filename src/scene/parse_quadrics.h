// The objects that are quadrics.
#pragma once

#include <optional>
#include <string_view>

#include "scene/json_cursor.h"
#include "scene/scene.h"
#include "scene/scene_keys.h"

namespace glint {

// The keys of an object of this type, or null if it is no quadric.
const KeyTable* quadricKeys(std::string_view type);

// `object` has the type `type`; nothing if that is no quadric.
std::optional<Shape> parseQuadric(const JsonCursor& object, std::string_view type);

}  // namespace glint
