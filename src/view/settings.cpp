#include "view/settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "scene/limits.h"

namespace glint {

bool operator==(const AdaptiveSampling& a, const AdaptiveSampling& b) {
    return a.maxSamples == b.maxSamples && a.threshold == b.threshold;
}

bool operator==(const ImageSettings& a, const ImageSettings& b) {
    const auto fields = [](const ImageSettings& s) {
        return std::tie(s.width, s.height, s.samplesPerPixel, s.sampler, s.filter, s.filterRadius, s.seed,
                        s.adaptive);
    };
    return fields(a) == fields(b);
}

}  // namespace glint

namespace glint::view {

namespace {

template <typename T>
void followOne(T& mine, const T& before, const T& now) {
    if (mine == before) mine = now;
}

void followLight(LightSetting& mine, const LightSetting& before, const LightSetting& now) {
    followOne(mine.position, before.position, now.position);
    followOne(mine.direction, before.direction, now.direction);
    followOne(mine.intensity, before.intensity, now.intensity);
    followOne(mine.angle, before.angle, now.angle);
    followOne(mine.penumbra, before.penumbra, now.penumbra);
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

LightSetting LightSetting::of(const Light& light) {
    LightSetting s;
    std::visit([&](const auto& l) { s.intensity = l.intensity; }, light);
    if (const auto* point = std::get_if<PointLight>(&light)) s.position = point->position;
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) s.direction = sun->direction;
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
        s.position = spot->position;
        s.direction = spot->direction;
        s.angle = spot->angle;
        s.penumbra = spot->penumbra;
    }
    return s;
}

Light LightSetting::applied(const Light& light) const {
    Light result = light;
    std::visit([&](auto& l) { l.intensity = intensity; }, result);
    const bool turned = glm::length(direction) >= kMinLength;
    if (auto* point = std::get_if<PointLight>(&result)) point->position = position;
    if (auto* sun = std::get_if<DirectionalLight>(&result); sun != nullptr && turned)
        sun->direction = direction;
    if (auto* spot = std::get_if<SpotLight>(&result)) {
        spot->position = position;
        if (turned) spot->direction = direction;
        const double whole = angle + penumbra;
        if (angle >= 0 && penumbra >= 0 && whole >= kMinSpotAngle && whole <= 180) {
            spot->angle = angle;
            spot->penumbra = penumbra;
        }
    }
    return result;
}

PictureSettings PictureSettings::of(const Scene& scene) {
    PictureSettings s;
    s.maxDepth = scene.maxDepth;
    for (const Light& light : scene.lights) s.lights.push_back(LightSetting::of(light));
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
        followLight(lights[i], before.lights[i], now.lights[i]);
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
                          forFields([&](const char*, auto field) { equal = equal && a.*field == b.*field; });
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

void setDiffuse(Material& material, const Color& diffuse) {
    if (material.ambient == material.diffuse) material.ambient = diffuse;
    material.diffuse = diffuse;
}

namespace {

Json lightsOf(const std::vector<LightSetting>& settings, const Scene& scene) {
    Json json = Json::array();
    for (size_t i = 0; i < std::min(settings.size(), scene.lights.size()); ++i) {
        if (!settings[i].on || settings[i].dim <= 0) continue;
        Light light = settings[i].applied(scene.lights[i]);
        std::visit([&](auto& l) { l.intensity *= static_cast<double>(settings[i].dim); }, light);
        json.push_back(lightJson(light));
    }
    return json;
}

// A missing "ambient" means "diffuse" in a scene file, so a changed diffuse color comes with its ambient one.
Json materialsOf(const std::vector<Material>& materials, const std::vector<Material>& before) {
    Json json;
    for (size_t i = 0; i < std::min(materials.size(), before.size()); ++i) {
        const Material &now = materials[i], &then = before[i];
        forFields([&](const char* name, auto field) {
            if (now.*field != then.*field) json[now.name][name] = numberJson(now.*field);
        });
        if (now.diffuse != then.diffuse) json[now.name]["ambient"] = vectorJson(now.ambient);
    }
    return json;
}

}  // namespace

std::string lightsJson(const std::vector<LightSetting>& settings, const Scene& scene) {
    return lightsOf(settings, scene).dump();
}

std::string materialsJson(const std::vector<Material>& materials, const std::vector<Material>& before) {
    const Json json = materialsOf(materials, before);
    return json.is_null() ? "" : json.dump();
}

std::string editedSceneText(const std::string& text, const Scene& scene, const PictureSettings& settings,
                            const PictureSettings& file) {
    Json json = Json::parse(text, nullptr, true, true);
    if (settings.lights != file.lights) json["lights"] = lightsOf(settings.lights, scene);
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
