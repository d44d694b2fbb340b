// The panel's groups that change the picture.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/sampling.h"
#include "view/panel_parts.h"

namespace glint::view {

void drawView(Gui& gui, PanelModel& m) {
    choice(gui, "layer", m.settings.layer, "what the colours stand for (L: next)");
    slider(gui, "exposure", m.display.exposure, -kMostExposure, kMostExposure, "%+.1f stops",
           "brighter or darker, in powers of two (- and +)");
    choice(gui, "tone map", m.display.toneMap, "from radiance to the screen (T: next)");
    if (m.hasFov)
        slider(gui, "fov", m.fovY, 1, 170, "%.1f deg", "field of view, from the picture's bottom to its top");
    checkbox(gui, "fly", m.flying, "W A S D, Q and E move through the scene (Tab)");
    ImGui::SameLine();
    checkbox(gui, "inspect", m.inspects, "what is under the mouse, in numbers (I)");
    ImGui::SameLine();
    checkbox(gui, "dock", m.docked, "the panel beside the picture, or over it (Shift+H)");
    if (m.flying) slider(gui, "speed", m.flySpeed, 0.05, 20, "x %.2f", "of flying", true);
    if (!resetButton(gui, "view", !(m.display == Display{}) || m.flySpeed != 1)) return;
    m.display = {};
    m.flySpeed = 1;
}

void drawLens(Gui& gui, PanelModel& m) {
    if (!m.perspective) return;
    ImGui::Separator();
    text("lens");
    slider(gui, "radius", m.lensRadius, 0, 0.2 * m.reach, "%.4g",
           "of the lens; 0 is a pinhole: all is sharp");
    slider(gui, "focus", m.focusDistance, 0, 10 * m.reach, "%.5g",
           "distance that is sharp; 0: the camera's target. Ctrl+click on the picture sets it", true);
    wrapped("Ctrl+click on the picture focuses there.", kDim);
}

namespace {

constexpr double kFirstError = 0.01, kLeastError = 1e-4, kMostError = 0.1;

// How long the picture at rest gathers samples: so many, or until its error is small enough.
void drawLimit(Gui& gui, PanelModel& m) {
    ErrorSetting& until = m.settings.until;
    if (until.error > 0)
        slider(gui, "error", until.error, kLeastError, kMostError, "%.2g",
               "root mean square over the picture of what it may be off, with 95 % confidence or what "
               "--confidence says; as glint render --error",
               true);
    else
        slider(gui, "samples", m.settings.sampleLimit, 1, 1024, "of the picture in the window, at rest",
               true);
}

void drawUntil(Gui& gui, PanelModel& m) {
    ErrorSetting& until = m.settings.until;
    bool byError = until.error > 0;
    if (checkbox(gui, "until error", byError,
                 "samples are taken until the picture's error is small enough, not so many"))
        until.error = byError ? kFirstError : 0;
    if (byError)
        checkbox(gui, "within depth", until.withinDepth,
                 "reflections beyond the depth are not missed; else what they may bring counts");
}

}  // namespace

void drawTracing(Gui& gui, PanelModel& m) {
    PictureSettings& s = m.settings;
    const PictureSettings& file = m.fileSettings;
    slider(gui, "depth", s.maxDepth, 0, std::max({16, file.maxDepth, s.maxDepth}),
           "reflections and refractions that are followed, one after the other");
    checkbox(gui, "shadows", s.shadows, "off: lights shine through everything");
    ImGui::SameLine();
    checkbox(gui, "reflections", s.reflections, "off: as with depth 0");
    drawLimit(gui, m);
    ImGui::ColorEdit3("background", &s.background.x,
                      ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_NoInputs);
    tip(gui, "background", "what rays see that hit nothing; the factor of an environment map");
    ImGui::SameLine();
    drawUntil(gui, m);
    choice(gui, "triangles", s.methods.triangles,
           "how rays are tried against triangles; watertight is right, the others show why");
    choice(gui, "spheres", s.methods.spheres,
           "how rays are tried against spheres; robust is right, the others show why");
    choice(gui, "traversal", m.traversal, "how rays walk the tree; the pictures are the same, bit for bit");
    double target = 1e3 * m.targetSeconds;
    if (slider(gui, "aim", target, 8, 200, "%.0f ms a frame", "while the camera moves: less is coarser"))
        m.targetSeconds = 1e-3 * target;
    if (m.modes.size() > 1 &&
        ImGui::BeginCombo("present", nameOf(m.mode).data())) {  // literals: they end in 0
        for (const gpu::PresentMode mode : m.modes)
            if (ImGui::Selectable(nameOf(mode).data(), mode == m.mode)) m.mode = mode;
        ImGui::EndCombo();
    }
    const bool differs = s.maxDepth != file.maxDepth || s.shadows != file.shadows ||
                         s.reflections != file.reflections || s.background != file.background ||
                         s.methods != file.methods;
    if (!resetButton(gui, "tracing", differs)) return;
    s.maxDepth = file.maxDepth;
    s.shadows = file.shadows;
    s.reflections = file.reflections;
    s.background = file.background;
    s.methods = file.methods;
}

void drawSampling(Gui& gui, PanelModel& m) {
    if (!group(gui, "sampling", false, "of rendered pictures (Alt+S); filter and seed of the window's too"))
        return;
    SamplingSettings& s = m.settings.sampling;
    slider(gui, "per pixel", s.samplesPerPixel, 1, 1024, "samples of a rendered picture", true);
    choice(gui, "sampler", s.sampler, "where the samples of a pixel lie");
    if (choice(gui, "filter", s.filter, "how samples are weighted into pixels"))
        s.filterRadius = defaultRadius(s.filter);
    slider(gui, "filter radius", s.filterRadius, 0.5, 4, "%.2f pixels",
           "how far a sample is from its pixel at most");
    checkbox(gui, "adaptive", s.adaptive, "more samples where the first ones differ");
    if (s.adaptive) {
        slider(gui, "at most", s.maxSamples, 1, 4096, "samples of a pixel", true);
        slider(gui, "threshold", s.threshold, 0.001, 1, "%.3f", "contrast below which a pixel is done", true);
    }
    const std::string conflict = samplingConflict(s.image(1, 1));
    if (!conflict.empty()) wrapped(conflict, kRed);
    if (resetButton(gui, "sampling", !(s == m.fileSettings.sampling))) s = m.fileSettings.sampling;
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

bool colorOf(Gui& gui, const char* label, glm::dvec3& value, const char* help) {
    float numbers[3] = {static_cast<float>(value.x), static_cast<float>(value.y),
                        static_cast<float>(value.z)};
    const bool changed = ImGui::ColorEdit3(
        label, numbers, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_NoInputs);
    tip(gui, label, help);
    for (int i = 0; changed && i < 3; ++i) value[i] = std::max(0.0, static_cast<double>(numbers[i]));
    return changed;
}

void drawLight(Gui& gui, const Light& kind, LightSetting& light, double reach) {
    colorOf(gui, "intensity", light.intensity, "colour and strength");
    const double step = 0.01 * reach;
    if (!std::holds_alternative<DirectionalLight>(kind))
        drag(gui, "position", light.position, step, "drag, or Ctrl+click and type");
    if (!std::holds_alternative<PointLight>(kind))
        drag(gui, "direction", light.direction, 0.01, "the way the light travels");
    if (std::holds_alternative<SpotLight>(kind)) {
        slider(gui, "angle", light.angle, 0, 90, "%.1f deg", "full light up to here from the axis");
        slider(gui, "penumbra", light.penumbra, 0, 90, "%.1f deg", "no light from so much farther on");
    }
}

}  // namespace

void drawLights(Gui& gui, PanelModel& m) {
    std::vector<LightSetting>& lights = m.settings.lights;
    if (lights.empty() || !group(gui, "lights", false, "switch, dim, move; C copies them as JSON")) return;
    for (size_t i = 0; i < lights.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        ImGui::Checkbox("##on", &lights[i].on);
        ImGui::SameLine();
        const Light& kind = m.scene->lights[i];
        const char* name = std::holds_alternative<PointLight>(kind)  ? "point"
                           : std::holds_alternative<SpotLight>(kind) ? "spot"
                                                                     : "sun";
        char label[32];
        std::snprintf(label, sizeof(label), "%zu %s", i, name);
        ImGui::SliderFloat("##dim", &lights[i].dim, 0, 4, "x %.2f", ImGuiSliderFlags_AlwaysClamp);
        tip(gui, label, "times the light's intensity");
        ImGui::SameLine();
        if (ImGui::TreeNode(label)) {
            drawLight(gui, kind, lights[i], m.reach);
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
    if (resetButton(gui, "lights", lights != m.fileSettings.lights)) lights = m.fileSettings.lights;
}

void drawMaterials(Gui& gui, PanelModel& m) {
    std::vector<Material>& all = m.edits.materials;
    if (all.empty() ||
        !group(gui, "materials", false, "colours and glass; C copies what has changed as JSON"))
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
    tip(gui, "material", "the one to change; a pick chooses its own");
    Material& material = all[m.material];
    colorOf(gui, "diffuse", material.diffuse, "what is scattered; multiplied with a texture");
    colorOf(gui, "ambient", material.ambient, "of ambient light");
    colorOf(gui, "specular", material.specular, "of the highlight");
    slider(gui, "shininess", material.shininess, 0, 10'000, "%.4g", "a greater one makes a smaller highlight",
           true);
    colorOf(gui, "mirror", material.mirror, "what is reflected");
    colorOf(gui, "transmission", material.transmission, "what passes through; black: opaque");
    for (Color* part : {&material.mirror, &material.transmission}) *part = glm::clamp(*part, 0.0, 1.0);
    if (material.transmission != Color(0))
        slider(gui, "ior", material.ior, 0.5, 4, "%.3f", "index of refraction: water 1.333, glass 1.5");
    choice(gui, "glass shadows", m.edits.transmissiveShadows, "coloured by what the light passes, or full");
    if (resetButton(gui, "materials", !same(m.edits, m.fileEdits))) m.edits = m.fileEdits;
}

}  // namespace glint::view
