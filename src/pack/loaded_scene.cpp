#include "pack/loaded_scene.h"

namespace glint {

shared::Camera cameraOf(const LoadedScene& loaded) {
    const Scene& scene = loaded.scene;
    return packCamera(scene.camera, scene.image.width, scene.image.height, loaded.packed.origin);
}

}  // namespace glint
