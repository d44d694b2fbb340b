// A scene as the window holds it.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "view/camera_control.h"
#include "view/view.h"

namespace glint::view {

struct ViewScene {
    std::filesystem::path path;
    Scene scene;
    PackedScene packed;  // as loaded: every light on
    // What the panel may switch on though the scene does without: mirrors, if a material reflects, cameras
    // with parallel rays, and a lens.
    SceneFeatures also;
};

// With what the command line says instead of the file.
Scene withOverrides(Scene scene, const Loading& loading);

// `memory`: of trees, may be null; see pack/tree_memory.h.
std::shared_ptr<const ViewScene> packViewScene(const std::filesystem::path& path, Scene scene,
                                               BuildQuality quality, TreeMemory* memory = nullptr);

// Around everything that is finite; around eye and target if nothing is.
Ball boundsOf(const ViewScene& scene);
// Around an object; around `hit` (world), as large as a tenth of the way there, for one without end.
Ball boundsOf(const ViewScene& scene, uint32_t object, const glm::dvec3& hit, double distance);

}  // namespace glint::view
