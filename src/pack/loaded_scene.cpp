#include "pack/loaded_scene.h"

namespace glint {

shared::Camera cameraOf(const LoadedScene& loaded) {
    const Scene& scene = loaded.scene;
    return packCamera(scene.camera, scene.image.width, scene.image.height, loaded.packed.origin);
}

PackedSamples samplesOf(const LoadedScene& loaded) {
    return packSamples(loaded.scene.image, loaded.scene.camera.lensRadius > 0);
}

}  // namespace glint
