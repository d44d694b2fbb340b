// The panel's groups that change the image.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>

#include "scene/limits.h"
#include "scene/sampling.h"
#include "view/panel.h"

namespace glint::view {

void drawView(Gui& gui, Model& m) {
    choice(gui, "layer", m.settings.layer, "what the colors stand for (L: next)");
    slider(gui, "exposure", m.display.exposure, -kMostExposure, kMostExposure, "%+.1f stops",
           "brighter or darker, in powers of two (- and +)");
    choice(gui, "tone map", m.display.toneMap, "from radiance to the screen (T: next)");
    const Camera& camera = m.control.camera();
    double fov = camera.fovY;
    if (!camera.window && camera.projection == Projection::Perspective &&
        slider(gui, "fov", fov, 1, 170, "%.1f deg", "vertical field of view"))
        m.control.zoom(fov / camera.fovY);
    checkbox(gui, "fly", m.flying, "W A S D, Q and E move through the scene (Tab)");
    ImGui::SameLine();
    checkbox(gui, "inspect", m.inspects, "what is under the mouse, in numbers (I)");
    ImGui::SameLine();
    checkbox(gui, "dock", m.docked, "the panel beside the image, or over it (Shift+H)");
    if (m.flying) slider(gui, "speed", m.flySpeed, 0.05, 20, "x %.2f", "of flying", true);
    if (!resetButton(gui, "view", !(m.display == Display{}) || m.flySpeed != 1)) return;
    m.display = {};
    m.flySpeed = 1;
}

void drawLens(Gui& gui, Model& m) {
    const Camera& camera = m.control.camera();
    if (camera.projection != Projection::Perspective) return;
    ImGui::Separator();
    text("lens");
    double radius = camera.lensRadius, focus = camera.focusDistance;
    slider(gui, "radius", radius, 0, 0.2 * boundsOf(*m.scene).radius, "%.4g",
           "of the lens; 0 is a pinhole: all is sharp");
    slider(gui, "focus", focus, 0, 10 * boundsOf(*m.scene).radius, "%.5g",
           "distance that is sharp; 0: the camera's target. Ctrl+click on the image sets it", true);
    if (radius != camera.lensRadius || focus != camera.focusDistance) m.control.setLens(radius, focus);
    wrapped("Ctrl+click on the image focuses there.", kDim);
}

namespace {

constexpr double kFirstError = 0.01, kLeastError = 1e-4, kMostError = 0.1;

}  // namespace

void drawTracing(Gui& gui, Model& m) {
    if (!group(gui, "tracing", false, "depth, samples, shadows, reflections")) return;
    PictureSettings& s = m.settings;
    const PictureSettings& file = m.fileSettings;
    slider(gui, "depth", s.maxDepth, 0, std::max({16, file.maxDepth, s.maxDepth}),
           "reflections and refractions that are followed, one after the other");
    checkbox(gui, "shadows", s.shadows, "off: lights shine through everything");
    ImGui::SameLine();
    checkbox(gui, "reflections", s.reflections, "off: as with depth 0");
    bool byError = s.until.error > 0;
    if (byError)
        slider(gui, "error", s.until.error, kLeastError, kMostError, "%.2g",
               "root mean square over the image of what it may be off, with 95 % confidence or what "
               "--confidence says; as glint render --error",
               true);
    else
        slider(gui, "samples", s.sampleLimit, 1, 1024, "of the image in the window, at rest", true);
    glm::dvec3 background(s.background);
    if (colorEdit(gui, "background", background,
                  "what rays see that hit nothing; the factor of an environment map", true))
        s.background = background;
    if (checkbox(gui, "until error", byError,
                 "samples are taken until the image's error is small enough, not so many"))
        s.until.error = byError ? kFirstError : 0;
    bool within = !s.until.depthCounts;
    if (byError && checkbox(gui, "within depth", within,
                            "reflections beyond the depth are not missed; else what they may bring counts"))
        s.until.depthCounts = !within;
    choice(gui, "triangles", s.methods.triangles,
           "how rays are tried against triangles; watertight is right, the others show why");
    choice(gui, "spheres", s.methods.spheres,
           "how rays are tried against spheres; robust is right, the others show why");
    double target = 1e3 * m.targetSeconds;
    if (slider(gui, "aim", target, 8, 200, "%.0f ms a frame", "while the camera moves: less is coarser"))
        m.targetSeconds = 1e-3 * target;
    resetButton<PathSettings>(gui, "tracing", s, file);
}

void drawSampling(Gui& gui, Model& m) {
    if (!group(gui, "sampling", false, "of rendered images (Alt+S); filter and seed of the window's too"))
        return;
    ImageSettings& s = m.settings.sampling;
    slider(gui, "per pixel", s.samplesPerPixel, 1, 1024, "samples of a rendered image", true);
    choice(gui, "sampler", s.sampler, "where the samples of a pixel lie");
    if (choice(gui, "filter", s.filter, "how samples are weighted into pixels"))
        s.filterRadius = defaultRadius(s.filter);
    slider(gui, "filter radius", s.filterRadius, 0.5, 4, "%.2f pixels",
           "how far a sample is from its pixel at most");
    bool adaptive = s.adaptive.has_value();
    if (checkbox(gui, "adaptive", adaptive, "more samples where the first ones differ"))
        s.adaptive = adaptive ? std::optional(AdaptiveSampling()) : std::nullopt;
    if (s.adaptive) {
        slider(gui, "at most", s.adaptive->maxSamples, 1, 4096, "samples of a pixel", true);
        slider(gui, "threshold", s.adaptive->threshold, 0.001, 1, "%.3f",
               "contrast below which a pixel is done", true);
    }
    const std::string conflict = samplingConflict(s);
    if (!conflict.empty()) wrapped(conflict, kRed);
    resetButton(gui, "sampling", s, m.fileSettings.sampling);
}

namespace {

bool drag(Gui& gui, const char* label, glm::dvec3& value, double speed, const char* help) {
    float numbers[3] = {static_cast<float>(value.x), static_cast<float>(value.y),
                        static_cast<float>(value.z)};
    const bool changed = ImGui::DragFloat3(label, numbers, static_cast<float>(speed), -1e9f, 1e9f, "%.3g",
                                           ImGuiSliderFlags_AlwaysClamp);
    tip(gui, label, help);
    for (int i = 0; changed && i < 3; ++i)
        if (numbers[i] != static_cast<float>(value[i])) value[i] = static_cast<double>(numbers[i]);
    return changed;
}

// A change that makes no valid light (a direction of length 0, a spot too narrow or too wide) is left out.
template <typename Kind>
void drawLight(Gui& gui, Kind& light, double reach) {
    colorEdit(gui, "intensity", light.intensity, "color and strength", true);
    if constexpr (requires { light.position; })
        drag(gui, "position", light.position, 0.01 * reach, "drag, or Ctrl+click and type");
    if constexpr (requires { light.direction; }) {
        glm::dvec3 direction = light.direction;
        drag(gui, "direction", direction, 0.01, "the way the light travels");
        if (glm::length(direction) >= kMinLength) light.direction = direction;
    }
    if constexpr (requires { light.angle; }) {
        double angle = light.angle, penumbra = light.penumbra;
        slider(gui, "angle", angle, 0, 90, "%.1f deg", "full light up to here from the axis");
        slider(gui, "penumbra", penumbra, 0, 90, "%.1f deg", "no light from so much farther on");
        if (angle + penumbra < kMinSpotAngle || angle + penumbra > 180) return;
        light.angle = angle;
        light.penumbra = penumbra;
    }
}

// In a small window all groups are closed at first, so that the image is seen.
bool opensWide() {
    return ImGui::GetIO().DisplaySize.y >= 50 * ImGui::GetFontSize();
}

}  // namespace

void drawLights(Gui& gui, Model& m) {
    std::vector<LightSetting>& lights = m.settings.lights;
    if (lights.empty() || !group(gui, "lights", opensWide(), "switch, dim, move; C copies them as JSON"))
        return;
    for (size_t i = 0; i < lights.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        ImGui::Checkbox("##on", &lights[i].on);
        ImGui::SameLine();
        constexpr const char* kNames[] = {"point", "sun", "spot"};
        char label[32];
        std::snprintf(label, sizeof(label), "%zu %s", i, kNames[lights[i].light.index()]);
        ImGui::SliderFloat("##dim", &lights[i].dim, 0, 4, "x %.2f", ImGuiSliderFlags_AlwaysClamp);
        tip(gui, label, "times the light's intensity");
        ImGui::SameLine();
        if (ImGui::TreeNode(label)) {
            std::visit([&](auto& light) { drawLight(gui, light, boundsOf(*m.scene).radius); },
                       lights[i].light);
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
    resetButton(gui, "lights", lights, m.fileSettings.lights);
}

void drawMaterials(Gui& gui, Model& m) {
    SceneEdits& edits = m.settings.edits;
    std::vector<Material>& all = edits.materials;
    if (all.empty() || !group(gui, "materials", opensWide(), "colors and glass; C copies changes as JSON"))
        return;
    m.material = std::min(m.material, all.size() - 1);
    if (ImGui::BeginCombo("material", all[m.material].name.c_str())) {
        for (size_t i = 0; i < all.size(); ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ImGui::Selectable(all[i].name.c_str(), i == m.material)) m.material = i;
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    tip(gui, "material", "the material to change; a pick chooses its own");
    Material& material = all[m.material];
    glm::dvec3 diffuse = material.diffuse;
    if (colorEdit(gui, "diffuse", diffuse, "scattered light; multiplied with a texture"))
        setDiffuse(material, diffuse);
    colorEdit(gui, "ambient", material.ambient, "of ambient light; follows diffuse while both are equal");
    colorEdit(gui, "specular", material.specular, "of the highlight");
    slider(gui, "shininess", material.shininess, 0, 10'000, "%.4g", "a greater one makes a smaller highlight",
           true);
    colorEdit(gui, "mirror", material.mirror, "what is reflected");
    colorEdit(gui, "transmission", material.transmission, "what passes through; black: opaque");
    for (Color* part : {&material.mirror, &material.transmission}) *part = glm::clamp(*part, 0.0, 1.0);
    if (material.transmission != Color(0))
        slider(gui, "ior", material.ior, 0.5, 4, "%.3f", "index of refraction: water 1.333, glass 1.5");
    choice(gui, "glass shadows", edits.transmissiveShadows, "colored by what the light passes, or full");
    resetButton(gui, "materials", edits, m.fileSettings.edits);
}

}  // namespace glint::view
