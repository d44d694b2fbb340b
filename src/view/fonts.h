// Where the window's letters come from.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

namespace glint::view {

struct FontPlace {
    const char* package;  // of Debian
    const char* file;
};

// In the order in which they are looked for.
std::span<const FontPlace> fontPlaces();

// The first that is there; empty: Dear ImGui's own font, which is made of pixels, must do.
std::optional<std::filesystem::path> findFont();

}  // namespace glint::view
