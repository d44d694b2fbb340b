// Changes of a scene that need it packed again: materials, and what shadows of glass do.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace glint::view {

struct SceneEdits {
    std::vector<Material> materials;  // as in Scene::materials
    TransmissiveShadows transmissiveShadows = TransmissiveShadows::Colored;

    static SceneEdits of(const Scene& scene);
    // After the file has changed, as PictureSettings::follow. Materials are told apart by their place.
    void follow(const SceneEdits& before, const SceneEdits& now);
};
bool same(const Material& a, const Material& b);
bool same(const SceneEdits& a, const SceneEdits& b);

Scene edited(Scene scene, const SceneEdits& edits);

// As a scene file writes them: "lights": [...], and "materials": {...} with those fields of each that differ
// from `before`; empty if nothing does.
std::string lightsJson(const std::vector<Light>& lights);
std::string materialsJson(const std::vector<Material>& materials, const std::vector<Material>& before);

}  // namespace glint::view
