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

void followSampling(ImageSettings& mine, const ImageSettings& before, const ImageSettings& now) {
    followOne(mine.samplesPerPixel, before.samplesPerPixel, now.samplesPerPixel);
    followOne(mine.sampler, before.sampler, now.sampler);
    // A radius belongs to its filter.
    if (mine.filter == before.filter && mine.filterRadius == before.filterRadius) {
        mine.filter = now.filter;
        mine.filterRadius = now.filterRadius;
    }
    followOne(mine.seed, before.seed, now.seed);
    followOne(mine.adaptive, before.adaptive, now.adaptive);
}

using Json = nlohmann::ordered_json;

Json vectorJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

// Calls visit(name, field) for each field of a light or material that a scene file may hold and the panel can
// change.
template <typename Visit>
void forFields(const PointLight&, const Visit& visit) {
    visit("position", &PointLight::position);
    visit("intensity", &PointLight::intensity);
}
template <typename Visit>
void forFields(const DirectionalLight&, const Visit& visit) {
    visit("direction", &DirectionalLight::direction);
    visit("intensity", &DirectionalLight::intensity);
}
template <typename Visit>
void forFields(const SpotLight&, const Visit& visit) {
    visit("position", &SpotLight::position);
    visit("direction", &SpotLight::direction);
    visit("angle", &SpotLight::angle);
    visit("penumbra", &SpotLight::penumbra);
    visit("intensity", &SpotLight::intensity);
}
template <typename Visit>
void forFields(const Material&, const Visit& visit) {
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

Json lightJson(const Light& light) {
    constexpr const char* kTypes[] = {"point", "directional", "spot"};
    Json json = {{"type", kTypes[light.index()]}};
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

PictureSettings PictureSettings::of(const Scene& scene) {
    PictureSettings s;
    s.maxDepth = scene.maxDepth;
    for (const Light& light : scene.lights) s.lights.push_back({.light = light});
    s.background = glm::vec3(scene.environment ? scene.environment->intensity : scene.background);
    s.sampling = scene.image;
    s.edits = SceneEdits::of(scene);
    return s;
}

void PictureSettings::follow(const PictureSettings& before, const PictureSettings& now) {
    followOne(maxDepth, before.maxDepth, now.maxDepth);
    followOne(background, before.background, now.background);
    followSampling(sampling, before.sampling, now.sampling);
    edits.follow(before.edits, now.edits);
    const std::vector<LightSetting> mine = std::move(lights);
    lights = now.lights;
    for (size_t i = 0; i < std::min({mine.size(), before.lights.size(), now.lights.size()}); ++i) {
        lights[i] = mine[i];
        followLight(lights[i].light, before.lights[i].light, now.lights[i].light);
    }
}

double steppedExposure(double exposure, double step) {
    return std::clamp(exposure + step, -kMostExposure, kMostExposure);
}

bool SceneEdits::operator==(const SceneEdits& other) const {
    return transmissiveShadows == other.transmissiveShadows &&
           std::equal(materials.begin(), materials.end(), other.materials.begin(), other.materials.end(),
                      [](const Material& a, const Material& b) {
                          bool equal = a.name == b.name;
                          forFields(a,
                                    [&](const char*, auto field) { equal = equal && a.*field == b.*field; });
                          return equal;
                      });
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

Scene edited(Scene scene, const SceneEdits& edits) {
    scene.materials = edits.materials;
    scene.transmissiveShadows = edits.transmissiveShadows;
    return scene;
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

// A missing "ambient" means "diffuse" in a scene file, so a changed diffuse color comes with its ambient one.
Json materialsOf(const std::vector<Material>& materials, const std::vector<Material>& before) {
    Json json;
    for (size_t i = 0; i < std::min(materials.size(), before.size()); ++i) {
        const Material &now = materials[i], &then = before[i];
        forFields(now, [&](const char* name, auto field) {
            if (now.*field != then.*field) json[now.name][name] = numberJson(now.*field);
        });
        if (now.diffuse != then.diffuse) json[now.name]["ambient"] = vectorJson(now.ambient);
    }
    return json;
}

}  // namespace

std::string lightsJson(const std::vector<LightSetting>& lights) {
    return lightsOf(lights).dump();
}

std::string materialsJson(const std::vector<Material>& materials, const std::vector<Material>& before) {
    const Json json = materialsOf(materials, before);
    return json.is_null() ? "" : json.dump();
}

std::string editedSceneText(const std::string& text, const PictureSettings& settings,
                            const PictureSettings& file) {
    Json json = Json::parse(text, nullptr, true, true);
    if (settings.lights != file.lights) json["lights"] = lightsOf(settings.lights);
    const Json materials = materialsOf(settings.edits.materials, file.edits.materials);
    for (const auto& [name, fields] : materials.items()) {
        if (!json["materials"].contains(name))
            throw Error(ErrorKind::Argument,
                        "the material \"" + name + "\" comes from another file: edit that file");
        json["materials"][name].update(fields);
    }
    if (settings.edits.transmissiveShadows != file.edits.transmissiveShadows)
        json["transmissiveShadows"] = nameOf(settings.edits.transmissiveShadows);
    return json.dump(2) + '\n';
}

void History::note(Undoable now, double seconds) {
    if (std::exchange(stepEnded_, false) || seconds - changedAt_ > kStepSeconds) {
        before_.push_back(std::move(seen_));
        if (before_.size() > kMost) before_.pop_front();
        after_.clear();
    }
    changedAt_ = seconds;
    seen_ = std::move(now);
}

std::optional<Undoable> History::undo() {
    if (before_.empty()) return std::nullopt;
    after_.push_back(std::exchange(seen_, std::move(before_.back())));
    before_.pop_back();
    stepEnded_ = true;
    return seen_;
}

std::optional<Undoable> History::redo() {
    if (after_.empty()) return std::nullopt;
    before_.push_back(std::exchange(seen_, std::move(after_.back())));
    after_.pop_back();
    stepEnded_ = true;
    return seen_;
}

}  // namespace glint::view
