#include "view/edits.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace glint::view {

namespace {

using Json = nlohmann::ordered_json;

Json vectorJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

Json lightJson(const Light& light) {
    Json json;
    if (const auto* point = std::get_if<PointLight>(&light)) {
        json = {{"type", "point"}, {"position", vectorJson(point->position)}};
        json["intensity"] = vectorJson(point->intensity);
        json["falloff"] = nameOf(point->falloff);
    } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
        json = {{"type", "spot"}, {"position", vectorJson(spot->position)}};
        json["direction"] = vectorJson(spot->direction);
        json["angle"] = spot->angle;
        json["penumbra"] = spot->penumbra;
        json["intensity"] = vectorJson(spot->intensity);
        json["falloff"] = nameOf(spot->falloff);
    } else {
        const auto& sun = std::get<DirectionalLight>(light);
        json = {{"type", "directional"}, {"direction", vectorJson(sun.direction)}};
        json["intensity"] = vectorJson(sun.intensity);
    }
    return json;
}

// Calls visit(name, field) for each that a scene file may hold and the panel can change.
template <typename Visit>
void forFields(const Visit& visit) {
    visit("ambient", &Material::ambient);
    visit("diffuse", &Material::diffuse);
    visit("specular", &Material::specular);
    visit("shininess", &Material::shininess);
    visit("mirror", &Material::mirror);
    visit("transmission", &Material::transmission);
    visit("ior", &Material::ior);
    visit("attenuation", &Material::attenuation);
}

Json numberJson(double value) {
    return value;
}
Json numberJson(const glm::dvec3& value) {
    return vectorJson(value);
}

}  // namespace

bool same(const Material& a, const Material& b) {
    bool equal = a.name == b.name;
    forFields([&](const char*, auto field) { equal = equal && a.*field == b.*field; });
    return equal;
}

bool same(const SceneEdits& a, const SceneEdits& b) {
    return a.transmissiveShadows == b.transmissiveShadows &&
           std::equal(a.materials.begin(), a.materials.end(), b.materials.begin(), b.materials.end(),
                      [](const Material& x, const Material& y) { return same(x, y); });
}

SceneEdits SceneEdits::of(const Scene& scene) {
    return {scene.materials, scene.transmissiveShadows};
}

void SceneEdits::follow(const SceneEdits& before, const SceneEdits& now) {
    if (transmissiveShadows == before.transmissiveShadows) transmissiveShadows = now.transmissiveShadows;
    const std::vector<Material> mine = std::exchange(materials, now.materials);
    for (size_t i = 0; i < std::min({mine.size(), before.materials.size(), materials.size()}); ++i) {
        if (mine[i].name != materials[i].name) continue;
        forFields([&](const char*, auto field) {
            if (mine[i].*field != before.materials[i].*field) materials[i].*field = mine[i].*field;
        });
    }
}

Scene edited(Scene scene, const SceneEdits& edits) {
    scene.materials = edits.materials;
    scene.transmissiveShadows = edits.transmissiveShadows;
    return scene;
}

std::string lightsJson(const std::vector<Light>& lights) {
    Json json = Json::array();
    for (const Light& light : lights) json.push_back(lightJson(light));
    return "\"lights\": " + json.dump();
}

std::string materialsJson(const std::vector<Material>& materials, const std::vector<Material>& before) {
    Json json;
    for (size_t i = 0; i < std::min(materials.size(), before.size()); ++i) {
        forFields([&](const char* name, auto field) {
            if (materials[i].*field != before[i].*field)
                json[materials[i].name][name] = numberJson(materials[i].*field);
        });
    }
    return json.is_null() ? "" : "\"materials\": " + json.dump();
}

}  // namespace glint::view
