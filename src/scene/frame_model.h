// A view and a light for models that bring none.
#pragma once

#include "core/enum_names.h"
#include "scene/scene.h"

namespace glint {

// Background of a model without one. Unlit sides stay visible against it.
inline constexpr Color kModelBackground{0.42, 0.50, 0.60};
inline constexpr Color kModelAmbient{0.2};

// The axis that points up in a file.
enum class UpAxis { X, Y, Z };
constexpr auto entriesOf(UpAxis) {
    return std::to_array<EnumEntry<UpAxis>>({{UpAxis::X, "x"}, {UpAxis::Y, "y"}, {UpAxis::Z, "z"}});
}

// Turns a direction of a scene whose y axis points up. The front of a model with z up is -y.
glm::dvec3 fromYUp(const glm::dvec3& v, UpAxis up);

// A camera and, if there is none, a light that show all of `scene`'s finite geometry: frameCamera and
// lightModel; background and ambient light as above.
void frameModel(Scene& scene, UpAxis up = UpAxis::Y);

// A view from the front, above and to the right, 40 degrees, that holds all finite geometry but planes.
void frameCamera(Scene& scene, UpAxis up = UpAxis::Y);

// Adds a directional light from the upper left of `scene.camera`'s picture, which must be valid.
void lightModel(Scene& scene);

}  // namespace glint
