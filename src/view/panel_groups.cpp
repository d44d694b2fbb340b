// The panel's groups of controls.
#include <imgui.h>
// imgui.h first
#include <imgui_stdlib.h>

#include <algorithm>
#include <variant>

#include "core/format.h"
#include "scene/limits.h"
#include "view/panel.h"

namespace glint::view {

namespace {

// ---- settings of the image ----

void drawView(Model& m) {
    choice("layer", m.settings.layer, "what the colors stand for (L: next)");
    slider("exposure", m.display.exposure, -kMostExposure, kMostExposure, "%+.1f stops",
           "brighter or darker, in powers of two (- and +)");
    choice("tone map", m.display.toneMap, "from radiance to the screen (T: next)");
    const Camera& camera = m.control.camera();
    double fov = camera.fovY;
    if (!camera.window && camera.projection == Projection::Perspective &&
        slider("fov", fov, 1, 170, "%.1f deg", "vertical field of view"))
        m.control.zoom(fov / camera.fovY);
    checkbox("fly", m.flying, "W A S D, Q and E move through the scene (Tab)");
    ImGui::SameLine();
    checkbox("inspect", m.inspects, "the pixel under the mouse, in numbers (I)");
    ImGui::SameLine();
    checkbox("dock", m.docked, "the panel beside the image, or over it (Shift+H)");
    if (m.flying) slider("speed", m.flySpeed, 0.05, 20, "x %.2f", "of flying", true);
    if (!resetButton("view", !(m.display == Display{}) || m.flySpeed != 1)) return;
    m.display = {};
    m.flySpeed = 1;
}

constexpr double kFirstError = 0.01, kLeastError = 1e-4, kMostError = 0.1;

void drawTracing(Model& m) {
    if (!group("tracing", false, "depth, samples, shadows, reflections")) return;
    PictureSettings& s = m.settings;
    const PictureSettings& file = m.fileSettings;
    slider("depth", s.maxDepth, 0, std::max({16, file.maxDepth, s.maxDepth}), "%d",
           "reflections and refractions that are followed, one after the other");
    checkbox("shadows", s.shadows, "off: lights shine through everything");
    ImGui::SameLine();
    checkbox("reflections", s.reflections, "off: as with depth 0");
    bool byError = s.until.error > 0;
    if (byError)
        slider("error", s.until.error, kLeastError, kMostError, "%.2g",
               "bound of the root mean square error of the image, with 95 % confidence or that of "
               "--confidence; as glint render --error",
               true);
    else
        slider("samples", s.sampleLimit, 1, 1024, "%d", "of the image in the window, at rest", true);
    glm::dvec3 background(s.background);
    if (colorEdit("background", background,
                  "color of rays that hit nothing; the factor of an environment map", true))
        s.background = background;
    if (checkbox("until error", byError, "accumulate samples until the image's error is small enough"))
        s.until.error = byError ? kFirstError : 0;
    bool within = !s.until.depthCounts;
    if (byError && checkbox("within depth", within, "do not count light beyond the depth as an error"))
        s.until.depthCounts = !within;
    choice("triangles", s.methods.triangles,
           "the test of rays with triangles; watertight is right, the others show why");
    choice("spheres", s.methods.spheres,
           "the test of rays with spheres; robust is right, the others show why");
    double target = 1e3 * m.targetSeconds;
    if (slider("aim", target, 8, 200, "%.0f ms a frame", "while the camera moves: less is coarser"))
        m.targetSeconds = 1e-3 * target;
    resetButton<PathSettings>("tracing", s, file);
}

void drag(const char* label, glm::dvec3& value, double speed, const char* help) {
    constexpr double kLeast = -1e9, kMost = 1e9;
    ImGui::DragScalarN(label, ImGuiDataType_Double, &value.x, 3, static_cast<float>(speed), &kLeast, &kMost,
                       "%.3g", ImGuiSliderFlags_AlwaysClamp);
    tip(label, help);
}

// A change that makes no valid light (a direction of length 0, a spot too narrow or too wide) is left out.
template <typename Kind>
void drawLight(Kind& light, double reach) {
    colorEdit("intensity", light.intensity, "color and strength", true);
    if constexpr (requires { light.position; })
        drag("position", light.position, 0.01 * reach, "drag, or Ctrl+click and type");
    if constexpr (requires { light.direction; }) {
        glm::dvec3 direction = light.direction;
        drag("direction", direction, 0.01, "the way the light travels");
        if (glm::length(direction) >= kMinLength) light.direction = direction;
    }
    if constexpr (requires { light.angle; }) {
        double angle = light.angle, penumbra = light.penumbra;
        slider("angle", angle, 0, 90, "%.1f deg", "full light up to this angle from the axis");
        slider("penumbra", penumbra, 0, 90, "%.1f deg", "further degrees in which the light fades");
        if (angle + penumbra < kMinSpotAngle || angle + penumbra > 180) return;
        light.angle = angle;
        light.penumbra = penumbra;
    }
}

// In a small window all groups are closed at first, to leave room for the image.
bool opensWide() {
    return ImGui::GetIO().DisplaySize.y >= 50 * ImGui::GetFontSize();
}

void drawLights(Model& m) {
    std::vector<LightSetting>& lights = m.settings.lights;
    if (lights.empty() || !group("lights", opensWide(), "switch, dim, move; C copies them as JSON")) return;
    for (size_t i = 0; i < lights.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        ImGui::Checkbox("##on", &lights[i].on);
        ImGui::SameLine();
        constexpr const char* kNames[] = {"point", "sun", "spot"};
        static_assert(std::size(kNames) == std::variant_size_v<Light>);
        const std::string label = format("%zu %s", i, kNames[lights[i].light.index()]);
        ImGui::SliderFloat("##dim", &lights[i].dim, 0, 4, "x %.2f", ImGuiSliderFlags_AlwaysClamp);
        tip(label, "times the light's intensity");
        ImGui::SameLine();
        if (ImGui::TreeNode(label.c_str())) {
            std::visit([&](auto& light) { drawLight(light, boundsOf(*m.scene).radius); }, lights[i].light);
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
    resetButton("lights", lights, m.fileSettings.lights);
}

void drawMaterials(Model& m) {
    SceneEdits& edits = m.settings.edits;
    std::vector<Material>& all = edits.materials;
    if (all.empty() || !group("materials", opensWide(), "colors and glass; C copies changes as JSON")) return;
    m.material = std::min(m.material, all.size() - 1);
    if (ImGui::BeginCombo("material", all[m.material].name.c_str())) {
        for (size_t i = 0; i < all.size(); ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ImGui::Selectable(all[i].name.c_str(), i == m.material)) m.material = i;
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    tip("material", "the material to change; a pick chooses its own");
    Material& material = all[m.material];
    glm::dvec3 diffuse = material.diffuse;
    if (colorEdit("diffuse", diffuse, "scattered light; multiplied with a texture"))
        setDiffuse(material, diffuse);
    colorEdit("ambient", material.ambient, "of ambient light; follows diffuse while both are equal");
    colorEdit("specular", material.specular, "of the highlight");
    slider("shininess", material.shininess, 0, 10'000, "%.4g", "a greater one makes a smaller highlight",
           true);
    colorEdit("mirror", material.mirror, "reflected light");
    colorEdit("transmission", material.transmission, "light that passes through; black: opaque");
    for (Color* part : {&material.mirror, &material.transmission}) *part = glm::clamp(*part, 0.0, 1.0);
    if (material.transmission != Color(0))
        slider("ior", material.ior, 0.5, 4, "%.3f", "index of refraction: water 1.333, glass 1.5");
    choice("glass shadows", edits.transmissiveShadows, "colored by the glass, or full");
    resetButton("materials", edits, m.fileSettings.edits);
}

// ---- files, cameras, comparison ----

void openFile(Model& m, const std::filesystem::path& file) {
    m.openName = file.string();
    m.openVisible = false;
    m.wish = [](Model& model) { open(model, model.openName); };
}

// Lists names; the folder is in the tooltip.
void drawRecent(Model& m) {
    for (size_t i = 1; i < m.recent.list().size(); ++i) {  // the first one is shown
        const std::filesystem::path file = m.recent.list()[i];
        ImGui::PushID(static_cast<int>(i));
        const std::string name = file.filename().string();
        const bool pressed = ImGui::Selectable(name.c_str());
        tip("recent " + name, file.string());
        if (pressed) openFile(m, file);
        ImGui::PopID();
    }
}

void drawFiles(Model& m) {
    if (m.hasJsonFile() && m.edited() && button("save scene", "lights and materials, into a scene file"))
        m.saveSceneVisible = true;
    if (!group("save and open", false, "images to files, other scenes into the window")) return;
    commandButtons(m, {{"PNG", "S"}, {"EXR", "Shift+S"}, {"save as", "Ctrl+Shift+S"}});
    commandButtons(m, {{"render PNG", "Alt+S"}, {"render EXR", "Alt+Shift+S"}});
    commandButtons(m, {{"open", "Ctrl+O"}});
    drawRecent(m);
}

// The file's cameras, then the bookmarks, whose names can be changed.
void drawCameraList(Model& m) {
    const size_t inFile = m.file->cameras.size();
    const std::vector<const NamedCamera*> all = m.cameras();
    for (size_t i = 0; i < all.size(); ++i) {
        const std::string& name = all[i]->name;
        if (i == inFile) ImGui::Separator();
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(name.empty() ? "(no name)" : name.c_str(), i == m.camera)) m.goToCamera(i);
        Gui::noteControl(name);
        ImGui::PopID();
    }
    if (m.bookmarks.empty()) return;
    if (m.camera >= inFile && m.camera < all.size()) {
        ImGui::InputText("name", &m.bookmarks[m.camera - inFile].name);
        tip("name", "of this bookmark");
    }
    if (m.hasJsonFile() && button("write to file",
                                  "add the bookmarks to the \"cameras\" of the scene's file, for "
                                  "`glint render --camera NAME`; all else in the file stays as it is"))
        m.wish = writeCameras;
}

void drawCameras(Model& m) {
    if (!group("camera", false, "cameras of the file, bookmarks, undo, lens")) return;
    commandButtons(m, {{"undo", "Ctrl+Z"}, {"redo", "Ctrl+Y"}, {"scene's", "R"}});
    commandButtons(m, {{"bookmark", "M"}, {"copy JSON", "C"}});
    drawCameraList(m);
    const Camera& camera = m.control.camera();
    if (camera.projection != Projection::Perspective) return;
    ImGui::Separator();
    text("lens");
    double radius = camera.lensRadius, focus = camera.focusDistance;
    slider("radius", radius, 0, 0.2 * boundsOf(*m.scene).radius, "%.4g",
           "of the lens; 0 is a pinhole: all is sharp");
    slider("focus", focus, 0, 10 * boundsOf(*m.scene).radius, "%.5g",
           "distance that is sharp; 0: the camera's target. Ctrl+click on the image sets it", true);
    if (radius != camera.lensRadius || focus != camera.focusDistance) m.control.setLens(radius, focus);
    wrapped("Ctrl+click on the image focuses there.", kDim);
}

void drawCompare(Model& m) {
    if (!group("compare", false, "compare this image with another")) return;
    Comparison& c = m.comparison;
    commandButtons(m, {{"keep", "K"}});
    ImGui::SameLine();
    if (button("reference", "the same samples by the tracer in double precision, on the processor"))
        m.wish = traceReference;
    ImGui::SameLine();
    commandButtons(m, {{"verify", "V"}});
    if (!c.any()) return wrapped("Keep an image, trace the reference, or drop an image file here.", kDim);
    text("with: " + c.name);
    choice("mode", c.mode, "how the two are shown (B: next)");
    if (c.mode == CompareMode::Wipe)
        slider("wipe", c.wipe, 0, 1, "%.2f", "the other image is left of here; drag its line");
    if (c.mode == CompareMode::Difference)
        slider("gain", c.gain, 1, 4096, "x %.0f", "of the difference", true);
    if (c.mode == CompareMode::Off) return;
    if (!c.figures) return wrapped(c.fault.empty() ? "measured once the image is finished" : c.fault, kDim);
    ImGui::Text("RMSE %.4g, PSNR %.1f dB", c.figures->rmse, c.figures->psnr);
    ImGui::Text("greatest %.4g, bias %.2g", c.figures->max, c.figures->mean);
}

void drawSpeed(Model& m) {
    if (!group("speed", false, "the device, and the time of a frame")) return;
    const FrameFacts& facts = m.session->facts();
    wrapped(m.session->device().info().name, kDim);
    ImGui::Text("frame %.1f ms, %.3g Mrays/s", 1e3 * m.frameSeconds, 1e-6 * facts.raysPerSecond);
    ImGui::Text("draw %.1f, present %.1f ms", 1e3 * m.drawSeconds, 1e3 * m.presentSeconds);
}

}  // namespace

void drawGroups(Model& m) {
    for (const auto draw :
         {drawView, drawLights, drawMaterials, drawFiles, drawCompare, drawCameras, drawTracing, drawSpeed})
        draw(m);
}

// ---- dialogs ----

namespace {

// In the middle of the window. A text field may take the keyboard when the window appears: since ImGui 1.89
// NoNav prevents that.
void dialog(const char* title, bool& visible, Model& m, void (*content)(Model&)) {
    if (!visible) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.4f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings |
                                        ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize;
    if (ImGui::Begin(title, &visible, kFlags)) {
        if (ImGui::IsWindowAppearing()) m.replacesFile = false;
        ImGui::PushItemWidth(std::min(22 * line, size.x - 2 * line));
        content(m);
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

// Takes the keyboard when its dialog appears, and selects its text, so that typing replaces it. True on
// Enter.
bool nameField(const char* label, const char* hint, std::string& name) {
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    return ImGui::InputTextWithHint(label, hint, &name,
                                    ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
}

void drawSaveAs(Model& m) {
    const bool entered = nameField("##file", "name.png, .exr, .pfm or .hdr", m.saveName);
    tip("file", "the ending selects the format");
    if (ImGui::RadioButton("what is seen", m.savesSeen)) m.savesSeen = true;
    tip("what is seen", "the layer with its samples and exposure");
    if (ImGui::RadioButton("the scene's own sampling", !m.savesSeen)) m.savesSeen = false;
    tip("the scene's own sampling", "the image of `glint render` for this view");
    checkbox("replace the file", m.replacesFile, "if it exists");
    if (button("save", "") || entered) m.wish = saveNamed;
}

void drawSaveScene(Model& m) {
    if (ImGui::IsWindowAppearing()) m.sceneName = m.scene->path.stem().string() + "-edited.json";
    const bool entered = nameField("##scene", "name.json", m.sceneName);
    tip("scene file", "beside the scene's file, so that meshes and images are found");
    checkbox("replace the file", m.replacesFile, "if it exists; comments in it are lost");
    if (button("write", "the scene with the changed lights and materials") || entered) m.wish = writeScene;
}

void drawOpen(Model& m) {
    const float width = ImGui::CalcItemWidth(), line = ImGui::GetTextLineHeightWithSpacing();
    if (ImGui::IsWindowAppearing()) m.openFiles = listFiles(m.openFolder);
    wrapped(m.openFolder.string(), kDim);
    const bool entered = nameField("##open", "path", m.openName);
    tip("open path", "a scene to show, or an image to compare with");
    ImGui::SameLine();
    if ((ImGui::Button("open##path") || entered) && !m.openName.empty())
        openFile(m, m.openFolder / m.openName);
    if (const size_t known = m.recent.list().size(); known > 1) {
        text("looked at before");
        if (ImGui::BeginChild("recent",
                              ImVec2(width, static_cast<float>(std::min<size_t>(known - 1, 4)) * line)))
            drawRecent(m);
        ImGui::EndChild();
        ImGui::Separator();
    }
    std::string chosen;
    if (ImGui::BeginChild("files", ImVec2(width, std::min(16 * line, 0.5f * ImGui::GetIO().DisplaySize.y)))) {
        for (const std::string& name : m.openFiles) {
            if (ImGui::Selectable(name.c_str())) chosen = name;
            Gui::noteControl(name);
        }
    }
    ImGui::EndChild();
    if (chosen.ends_with('/')) {
        m.openFolder = (m.openFolder / chosen).lexically_normal();
        m.openFiles = listFiles(m.openFolder);
    } else if (!chosen.empty()) {
        openFile(m, m.openFolder / chosen);
    }
}

}  // namespace

void drawDialogs(Model& m) {
    dialog("save as", m.saveAsVisible, m, drawSaveAs);
    dialog("save scene", m.saveSceneVisible, m, drawSaveScene);
    dialog("open", m.openVisible, m, drawOpen);
}

// ---- animation ----

float drawTimeline(Model& m, float width) {
    Timeline& t = m.timeline;
    if (!t.any()) return 0;
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0, ImGui::GetIO().DisplaySize.y), ImGuiCond_Always, ImVec2(0, 1));
    ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(m.left > 0 ? 1.0f : 0.85f);
    ImGui::Begin("##timeline", nullptr, kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoTitleBar);
    ImGui::PushItemWidth(width - 5 * line);
    const char* label = t.playing() ? "pause" : "play";
    if (ImGui::Button(label, ImVec2(4 * line, 0))) t.toggle(m.clock.seconds());
    tip(label, "the animation (Space)");
    ImGui::SameLine();
    if (ImGui::ArrowButton("##back", ImGuiDir_Left)) t.step(-1);
    tip("frame back", "a frame back (,)");
    ImGui::SameLine();
    if (ImGui::ArrowButton("##on", ImGuiDir_Right)) t.step(1);
    tip("frame on", "a frame on (.)");
    ImGui::SameLine();
    checkbox("loop", t.loops, "from the end on to the beginning");
    int frame = t.frame();
    if (slider("frame", frame, t.first(), std::max(t.last(), t.first() + 1), "%d",
               "drag through the animation; Home and End go to its ends"))
        t.goTo(frame);
    wrapped(m.time ? format("%.5g s", *m.time) : "as the file says it", kDim);
    ImGui::PopItemWidth();
    const float height = ImGui::GetWindowHeight();
    ImGui::End();
    return height;
}

}  // namespace glint::view
