// The numbers behind glTF accessors (specification, section 3.6.2).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "import/gltf_file.h"

namespace glint {

// Accessor `index`: of any component type, interleaved or not, normalised integers as fractions, with its
// sparse substitutions. `types` are the element types that its user can take ("VEC3"). Throws Error(Scene) if
// it is of another, or does not fit its buffer view.
GltfNumbers readAccessor(GltfFile& file, size_t index, std::initializer_list<std::string_view> types);

// The same for vertex indices: SCALAR, of an unsigned type.
std::vector<uint32_t> readIndexAccessor(GltfFile& file, size_t index);

}  // namespace glint
