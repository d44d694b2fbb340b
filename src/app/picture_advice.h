// Explains images that show nothing.
#pragma once

#include <optional>
#include <string>

#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::app {

// One line with the likely reason if a complete image shows only background, only black, only white, or only
// the unlit inside of one object; empty for any other. Traces a few camera rays to find the reason.
// `request`: of the whole image. `scale`: factor of the colours in an 8-bit file; 0: the file holds floats.
std::optional<std::string> pictureAdvice(const Picture& picture, const Scene& scene,
                                         const PackedScene& packed, const Request& request, float scale);

}  // namespace glint::app
