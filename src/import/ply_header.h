// The header of a PLY file (Turk, The PLY Polygon File Format, 1994).
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "core/binary_numbers.h"
#include "core/context.h"

namespace glint {

struct PlyProperty {
    std::string name;
    NumberType type = NumberType::Float32;
    bool isList = false;
    NumberType countType = NumberType::Uint8;  // of a list
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;

    // The property of that name, or null.
    const PlyProperty* find(std::string_view property) const {
        const auto at = std::ranges::find(properties, property, &PlyProperty::name);
        return at == properties.end() ? nullptr : &*at;
    }
};

enum class PlyFormat { Ascii, LittleEndian, BigEndian };

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> textures;  // "comment TextureFile NAME", as MeshLab writes it
    size_t bodyOffset = 0;              // the first byte after the header
    size_t bodyLine = 1;                // the number of the first line after it
};

// Throws Error(Scene) "FILE:LINE: ..." for anything unsupported.
PlyHeader readPlyHeader(const Context& context, std::string_view bytes, const std::string& file);

}  // namespace glint
