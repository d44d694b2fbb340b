// A view and a light for models that bring none.
#pragma once

#include "scene/scene.h"

namespace glint {

// Background of a model without one. Unlit sides stay visible against it.
inline constexpr Color kModelBackground{0.42, 0.50, 0.60};
inline constexpr Color kModelAmbient{0.2};

// A camera and, if there is none, a light that show all of `scene`'s finite geometry: frameCamera and
// lightModel; background and ambient light as above.
void frameModel(Scene& scene);

// A view from the front, above and to the right, 40 degrees, that holds all finite geometry but planes.
void frameCamera(Scene& scene);

// Adds a directional light from the upper left of `scene.camera`'s picture, which must be valid.
void lightModel(Scene& scene);

}  // namespace glint
