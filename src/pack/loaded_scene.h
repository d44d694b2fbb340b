// A scene as it was read, with the arrays that were packed from it.
#pragma once

#include "pack/packed_scene.h"
#include "scene/scene.h"

namespace glint {

struct LoadedScene {
    Scene scene;
    PackedScene packed;
    double loadSeconds = 0, packSeconds = 0;
};

}  // namespace glint
