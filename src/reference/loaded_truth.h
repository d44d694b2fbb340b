// The truth of a scene that is packed too, in the same local coordinates.
#pragma once

#include <memory>

#include "pack/loaded_scene.h"
#include "reference/truth/truth.h"

namespace glint::reference {

inline std::shared_ptr<Model> truthOf(const LoadedScene& loaded, unsigned threads = 0) {
    return std::make_shared<Model>(truthOf(loaded.scene, loaded.packed.origin, threads));
}

// The camera of the scene's picture.
inline rows::Camera truthCamera(const LoadedScene& loaded) {
    const Scene& scene = loaded.scene;
    return truthCamera(scene.camera, scene.image.width, scene.image.height, loaded.packed.origin);
}

}  // namespace glint::reference
