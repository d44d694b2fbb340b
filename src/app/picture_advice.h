// For the newcomer before a black picture: the likely reason.
#pragma once

#include <optional>
#include <string>

#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::app {

// One line for a complete picture that shows nothing but background, nothing but black, or nothing but the
// unlit inside of one object; nothing for any other. Looks for the reason with a few camera rays of its own.
// `tracing`: what the picture was made with.
std::optional<std::string> pictureAdvice(const Picture& picture, const Scene& scene,
                                         const PackedScene& packed, const Request& request = {});

}  // namespace glint::app
