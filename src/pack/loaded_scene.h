// A scene as it was read, with the arrays that were packed from it.
#pragma once

#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "trace/request.h"

namespace glint {

struct LoadedScene {
    Scene scene;
    PackedScene packed;
    double loadSeconds = 0, packSeconds = 0;
};

// The scene's camera for an image of the request's size.
inline shared::Camera cameraOf(const LoadedScene& loaded, const Request& request) {
    return packCamera(loaded.scene.camera, request.width, request.height, loaded.packed.origin);
}

}  // namespace glint
