#include "view/settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "core/error.h"

namespace glint::view {

namespace {

template <typename T>
void followOne(T& mine, const T& before, const T& now) {
    if (mine == before) mine = now;
}

using Json = nlohmann::ordered_json;

// Calls visit(name, field) for each field of a light or material that a scene file may hold and the panel can
// change.
template <typename Kind, typename Visit>
void forFields(const Kind& kind, const Visit& visit) {
    if constexpr (requires { kind.position; }) visit("position", &Kind::position);
    if constexpr (requires { kind.direction; }) visit("direction", &Kind::direction);
    if constexpr (requires { kind.angle; }) {
        visit("angle", &Kind::angle);
        visit("penumbra", &Kind::penumbra);
    }
    if constexpr (requires { kind.intensity; }) visit("intensity", &Kind::intensity);
    if constexpr (std::is_same_v<Kind, Material>) {
        visit("ambient", &Material::ambient);
        visit("diffuse", &Material::diffuse);
        visit("specular", &Material::specular);
        visit("shininess", &Material::shininess);
        visit("mirror", &Material::mirror);
        visit("transmission", &Material::transmission);
        visit("ior", &Material::ior);
    }
}

Json numberJson(double value) {
    return value;
}
Json numberJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

Json lightJson(const Light& light) {
    Json json = {{"type", kLightTypes[light.index()]}};
    std::visit(
        [&](const auto& l) {
            forFields(l, [&](const char* name, auto field) { json[name] = numberJson(l.*field); });
            if constexpr (requires { l.falloff; }) json["falloff"] = nameOf(l.falloff);
        },
        light);
    return json;
}

// A light of another kind than before is taken as it is now.
void followLight(Light& mine, const Light& before, const Light& now) {
    if (mine.index() != now.index() || before.index() != now.index()) {
        mine = now;
        return;
    }
    std::visit(
        [&](auto& m) {
            using Kind = std::remove_reference_t<decltype(m)>;
            const Kind &b = std::get<Kind>(before), &n = std::get<Kind>(now);
            forFields(m, [&](const char*, auto field) { followOne(m.*field, b.*field, n.*field); });
            if constexpr (requires { m.falloff; }) m.falloff = n.falloff;
        },
        mine);
}

}  // namespace

PictureSettings PictureSettings::of(const Scene& scene, const Wishes& wishes) {
    PictureSettings s;
    s.maxDepth = wishes.depth ? static_cast<int>(*wishes.depth) : scene.maxDepth;
    for (const Light& light : scene.lights) s.lights.push_back({.light = light});
    s.background = glm::vec3(scene.environment ? scene.environment->intensity : scene.background);
    s.sampling = scene.image;
    s.sampling.samplesPerPixel = wishes.samplesPerPixel.value_or(scene.image.samplesPerPixel);
    s.edits = SceneEdits::of(scene);
    return s;
}

void PictureSettings::follow(const PictureSettings& before, const PictureSettings& now) {
    followOne(maxDepth, before.maxDepth, now.maxDepth);
    followOne(background, before.background, now.background);
    sampling = now.sampling;
    edits.follow(before.edits, now.edits);
    const std::vector<LightSetting> mine = std::move(lights);
    lights = now.lights;
    for (size_t i = 0; i < std::min({mine.size(), before.lights.size(), now.lights.size()}); ++i) {
        lights[i] = mine[i];
        followLight(lights[i].light, before.lights[i].light, now.lights[i].light);
    }
}

SceneEdits SceneEdits::of(const Scene& scene) {
    return {scene.materials, scene.transmissiveShadows};
}

void SceneEdits::follow(const SceneEdits& before, const SceneEdits& now) {
    if (transmissiveShadows == before.transmissiveShadows) transmissiveShadows = now.transmissiveShadows;
    const std::vector<Material> mine = std::exchange(materials, now.materials);
    for (size_t i = 0; i < std::min({mine.size(), before.materials.size(), materials.size()}); ++i) {
        if (mine[i].name != materials[i].name) continue;
        forFields(mine[i], [&](const char*, auto field) {
            if (mine[i].*field != before.materials[i].*field) materials[i].*field = mine[i].*field;
        });
    }
}

void setDiffuse(Material& material, const Color& diffuse) {
    if (material.ambient == material.diffuse) material.ambient = diffuse;
    material.diffuse = diffuse;
}

namespace {

Json lightsOf(const std::vector<LightSetting>& lights) {
    Json json = Json::array();
    for (const LightSetting& setting : lights) {
        if (!setting.on || setting.dim <= 0) continue;
        Light light = setting.light;
        std::visit([&](auto& l) { l.intensity *= static_cast<double>(setting.dim); }, light);
        json.push_back(lightJson(light));
    }
    return json;
}

// A color, or the factor of its texture.
Json colorJson(const Material& material, std::string_view name, const Color& color) {
    for (const auto& [key, texture] : kMaterialTextures)
        if (key == name && material.*texture != Material::kNoTexture) return {{"color", numberJson(color)}};
    return numberJson(color);
}

// A missing "ambient" means "diffuse" in a scene file, so a changed diffuse color comes with its ambient one,
// unless both have one texture.
Json materialsOf(const std::vector<Material>& materials, const std::vector<Material>& before) {
    Json json;
    for (size_t i = 0; i < std::min(materials.size(), before.size()); ++i) {
        const Material &now = materials[i], &then = before[i];
        forFields(now, [&](const char* name, auto field) {
            if (now.*field == then.*field) return;
            if constexpr (std::is_same_v<decltype(field), Color Material::*>)
                json[now.name][name] = colorJson(now, name, now.*field);
            else
                json[now.name][name] = numberJson(now.*field);
        });
        if (now.diffuse == then.diffuse) continue;
        json[now.name]["ambient"] = colorJson(now, "ambient", now.ambient);
        if (now.ambientTexture == now.diffuseTexture && now.ambientTexture != Material::kNoTexture &&
            now.ambient == now.diffuse)
            json[now.name].erase("ambient");
    }
    return json;
}

// Members of a scene file for what differs from it.
Json changes(const PictureSettings& settings, const PictureSettings& file) {
    Json json = Json::object();
    if (settings.lights != file.lights) json["lights"] = lightsOf(settings.lights);
    Json materials = materialsOf(settings.edits.materials, file.edits.materials);
    if (!materials.is_null()) json["materials"] = std::move(materials);
    if (settings.edits.transmissiveShadows != file.edits.transmissiveShadows)
        json["transmissiveShadows"] = nameOf(settings.edits.transmissiveShadows);
    return json;
}

}  // namespace

std::map<std::string, std::string> changedMembers(const PictureSettings& settings,
                                                  const PictureSettings& file) {
    const Json changed = changes(settings, file);
    std::map<std::string, std::string> members;
    for (const auto& [name, value] : changed.items()) members[name] = value.dump();
    return members;
}

std::string editedSceneText(const std::string& text, const PictureSettings& settings,
                            const PictureSettings& file) {
    Json json = Json::parse(text, nullptr, true, true);
    const Json changed = changes(settings, file);
    const Json materials = changed.value("materials", Json::object());
    for (const auto& [name, fields] : materials.items())
        if (!json["materials"].contains(name))
            throw Error(ErrorKind::Argument,
                        "the material \"" + name + "\" comes from another file: edit that file");
    json.merge_patch(changed);
    for (const auto& [name, fields] : materials.items()) {
        Json& material = json["materials"][name];
        const auto ambient = material.find("ambient");
        if (ambient == material.end() || !ambient->is_object()) continue;
        if (ambient->contains("texture") || ambient->contains("checker")) continue;
        Json own = material["diffuse"];  // whose texture it had
        own.merge_patch(*ambient);
        *ambient = std::move(own);
    }
    return json.dump(2) + '\n';
}

void History::note(Undoable now) {
    if (std::exchange(stepEnded_, false)) {
        states_.resize(++at_);
        states_.emplace_back();
        if (at_ > kMost) states_.erase(states_.begin());
        at_ = states_.size() - 1;
    }
    states_[at_] = std::move(now);
}

}  // namespace glint::view
