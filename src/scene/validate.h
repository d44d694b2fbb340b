// The checks of validateScene, part by part, for use at the place in the file where a part is read.
#pragma once

#include <string>
#include <string_view>

#include "scene/scene.h"

namespace glint {

// Where something stands, for messages: "FILE: POINTER/KEY: what".
struct Place {
    std::string file;
    std::string pointer;
    [[noreturn]] void fail(std::string_view key, const std::string& what) const;
};

void validateImage(const ImageSettings& image, const Place& place);
void validateCamera(const Camera& camera, const Place& place);
void validateLight(const Light& light, const Place& place);
void validateMaterial(const Material& material, const Place& place);
void validateTexture(const Texture& texture, const Place& place);
// Every vertex of a mesh is looked at; materials are checked against `materialCount`.
void validateShape(const Shape& shape, const Place& place, size_t materialCount);

}  // namespace glint
