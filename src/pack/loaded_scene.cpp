#include "pack/loaded_scene.h"

namespace glint {

shared::Camera cameraOf(const LoadedScene& loaded, const Request& request) {
    return packCamera(loaded.scene.camera, request.width, request.height, loaded.packed.origin);
}

}  // namespace glint
