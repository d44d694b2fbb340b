// The truth of a scene that is packed too, in the same local coordinates.
#pragma once

#include <memory>

#include "pack/loaded_scene.h"
#include "reference/truth/truth.h"

namespace glint::reference {

inline std::shared_ptr<Model> truthOf(const LoadedScene& loaded, const Context& context = {}) {
    return std::make_shared<Model>(truthOf(loaded.scene, loaded.packed.origin, context));
}

// The scene's camera for an image of the request's size.
inline rows::Camera truthCamera(const LoadedScene& loaded, const Request& request) {
    return truthCamera(loaded.scene.camera, request.width, request.height, loaded.packed.origin);
}

}  // namespace glint::reference
