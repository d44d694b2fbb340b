// The panel's groups that do something: files, cameras, comparison; and what the device does.
#include <imgui.h>
// imgui.h first
#include <imgui_stdlib.h>

#include <algorithm>
#include <cstdio>

#include "view/commands.h"
#include "view/panel.h"

namespace glint::view {

namespace {

void wish(Model& m, bool pressed, Command what) {
    if (pressed) m.wish = what;
}

void openFile(Model& m, const std::filesystem::path& file) {
    m.openName = file.string();
    m.openVisible = false;
    m.wish = [](Model& model, Commands& c) { c.open(model.openName); };
}

// Lists names; the folder is in the tooltip.
void drawRecent(Gui& gui, Model& m) {
    for (size_t i = 1; i < m.recent.list().size(); ++i) {
        const std::filesystem::path& file = m.recent.list()[i];
        ImGui::PushID(static_cast<int>(i));
        const std::string name = file.filename().string();
        const bool pressed = ImGui::Selectable(name.c_str());
        tip(gui, ("recent " + name).c_str(), file.c_str());
        if (pressed) openFile(m, file);
        ImGui::PopID();
    }
}

}  // namespace

void drawFiles(Gui& gui, Model& m) {
    if (!group(gui, "save and open", false, "images to files, other scenes into the window")) return;
    wish(m, button(gui, "PNG", "save what is seen (S)"), call<&Commands::savePng>);
    ImGui::SameLine();
    wish(m, button(gui, "EXR", "save what is seen, with every layer (Shift+S)"), call<&Commands::saveExr>);
    ImGui::SameLine();
    if (button(gui, "save as", "under a name of your choice (Ctrl+Shift+S)")) m.saveAsVisible = true;
    wish(m, button(gui, "render PNG", "with the scene's own sampling, as `glint render` does (Alt+S)"),
         call<&Commands::renderPng>);
    ImGui::SameLine();
    wish(m, button(gui, "render EXR", "the same, with every layer (Alt+Shift+S)"),
         call<&Commands::renderExr>);
    if (button(gui, "open", "another scene, or an image to compare with (Ctrl+O); or drop it here"))
        m.openVisible = true;
    drawRecent(gui, m);
}

void drawOpen(Gui& gui, Model& m) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(std::min(30 * line, size.x), std::min(26 * line, size.y)),
                             ImGuiCond_Appearing);
    if (ImGui::Begin("open", &m.openVisible, kDialog)) {
        if (ImGui::IsWindowAppearing()) m.openFiles = listFiles(m.openFolder);
        wrapped(m.openFolder.string(), kDim);
        ImGui::SetNextItemWidth(-4 * line);
        const bool entered =
            ImGui::InputTextWithHint("##open", "path", &m.openName, ImGuiInputTextFlags_EnterReturnsTrue);
        tip(gui, "open path", "a scene to show, or an image to compare with");
        ImGui::SameLine();
        if ((ImGui::Button("open##path") || entered) && !m.openName.empty()) openFile(m, m.openName);
        std::string chosen;
        if (const size_t known = m.recent.list().size(); known > 1) {  // the first one is shown
            text("looked at before");
            const float lines = static_cast<float>(std::min<size_t>(known - 1, 4));
            if (ImGui::BeginChild("recent", ImVec2(0, lines * ImGui::GetTextLineHeightWithSpacing())))
                drawRecent(gui, m);
            ImGui::EndChild();
            ImGui::Separator();
        }
        if (ImGui::BeginChild("files")) {
            for (const std::string& name : m.openFiles) {
                if (ImGui::Selectable(name.c_str())) chosen = name;
                gui.noteControl(name.c_str());
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
    ImGui::End();
}

namespace {

// In the middle of the window. `content` begins with a text field.
void dialog(const char* title, bool& visible, const std::function<void()>& content) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.4f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    if (ImGui::Begin(title, &visible, kDialog | ImGuiWindowFlags_AlwaysAutoResize)) {
        ImGui::PushItemWidth(std::min(22 * line, size.x - 2 * line));
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        content();
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

}  // namespace

void drawSaveAs(Gui& gui, Model& m) {
    dialog("save as", m.saveAsVisible, [&] {
        const bool entered = ImGui::InputTextWithHint("##file", "name.png, .exr, .pfm or .hdr", &m.saveName,
                                                      ImGuiInputTextFlags_EnterReturnsTrue);
        tip(gui, "file", "the ending selects the format");
        int which = m.savesSeen ? 0 : 1;
        ImGui::RadioButton("what is seen", &which, 0);
        tip(gui, "what is seen", "the layer with its samples and exposure");
        ImGui::RadioButton("the scene's own sampling", &which, 1);
        tip(gui, "the scene's own sampling", "as `glint render` would draw this view");
        m.savesSeen = which == 0;
        wish(m, button(gui, "save", "") || entered, call<&Commands::saveNamed>);
    });
}

void drawSaveScene(Gui& gui, Model& m) {
    dialog("save scene", m.saveSceneVisible, [&] {
        if (ImGui::IsWindowAppearing()) m.sceneName = m.scene->path.stem().string() + "-edited.json";
        const bool entered = ImGui::InputText("##scene", &m.sceneName, ImGuiInputTextFlags_EnterReturnsTrue);
        tip(gui, "scene file", "beside the scene's file, so that meshes and images are found");
        checkbox(gui, "replace the file", m.replacesFile, "if it exists; comments in it are lost");
        wish(m, button(gui, "write", "the scene with the changed lights and materials") || entered,
             call<&Commands::writeScene>);
    });
}

namespace {

// The file's cameras, then those that are kept here, whose names can be changed.
void drawCameraList(Gui& gui, Model& m) {
    const size_t inFile = m.file->cameras.size();
    const std::vector<const NamedCamera*> all = m.cameras();
    for (size_t i = 0; i < all.size(); ++i) {
        const std::string& name = all[i]->name;
        if (i == inFile) ImGui::Separator();
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(name.empty() ? "(no name)" : name.c_str(), i == m.camera)) m.goToCamera(i);
        gui.noteControl(name.c_str());
        ImGui::PopID();
    }
    if (m.bookmarks.empty()) return;
    if (m.camera >= inFile && m.camera < all.size()) {
        ImGui::InputText("name", &m.bookmarks[m.camera - inFile].name);
        tip(gui, "name", "of this bookmark");
    }
    if (!m.hasJsonFile()) return;
    wish(m,
         button(
             gui, "write to file",
             "adds the bookmarks to the \"cameras\" of the scene's file, where `glint render --camera NAME` "
             "finds them; all else in the file stays as it is"),
         call<&Commands::writeCameras>);
}

}  // namespace

void drawCameras(Gui& gui, Model& m) {
    if (!group(gui, "camera", false, "cameras of the file, bookmarks, undo, lens")) return;
    wish(m, button(gui, "undo", "the camera before the last movement (Ctrl+Z)"), call<&Commands::undo>);
    ImGui::SameLine();
    wish(m, button(gui, "redo", "(Ctrl+Y)"), call<&Commands::redo>);
    ImGui::SameLine();
    if (button(gui, "scene's", "the camera of the scene's file (R)")) m.control.reset();
    if (button(gui, "bookmark", "keep this camera (M)")) m.keepCamera();
    ImGui::SameLine();
    wish(m, button(gui, "copy JSON", "print and copy the camera as scene JSON (C)"),
         call<&Commands::copyJson>);
    drawCameraList(gui, m);
    drawLens(gui, m);
}

void drawCompare(Gui& gui, Model& m) {
    if (!group(gui, "compare", false, "compare this image with another")) return;
    Comparison& c = m.comparison;
    wish(m, button(gui, "keep", "this image, to compare others with (K)"), call<&Commands::keepPicture>);
    ImGui::SameLine();
    wish(m, button(gui, "reference", "the same samples by the tracer in double precision, on the processor"),
         call<&Commands::traceReference>);
    ImGui::SameLine();
    wish(m, button(gui, "verify", "compare every pixel with the reference (V)"), call<&Commands::verify>);
    if (!c.any()) {
        wrapped("Keep an image, trace the reference, or drop an image file here.", kDim);
        return;
    }
    text("with: " + c.name);
    choice(gui, "mode", c.mode, "how the two are shown (B: next)");
    if (c.mode == CompareMode::Wipe)
        slider(gui, "wipe", c.wipe, 0, 1, "%.2f", "left of here is the other image; drag its line");
    if (c.mode == CompareMode::Difference)
        slider(gui, "gain", c.gain, 1, 4096, "x %.0f", "of the difference", true);
    if (c.mode == CompareMode::Off) return;
    if (c.figures) {
        ImGui::Text("RMSE %.4g, PSNR %.1f dB", c.figures->rmse, c.figures->psnr);
        ImGui::Text("greatest %.4g, bias %.2g", c.figures->max, c.figures->mean);
    } else {
        wrapped(c.fault.empty() ? "measured once the image is finished" : c.fault, kDim);
    }
}

void drawSpeed(Gui& gui, Model& m) {
    if (!group(gui, "speed", false, "the device, and the time of each part of a frame")) return;
    const FrameFacts& facts = m.session->facts();
    wrapped(m.session->device().info().name, kDim);
    ImGui::Text("frame %.1f ms, %.3g Mrays/s", 1e3 * m.frameSeconds, 1e-6 * facts.raysPerSecond);
    if (m.frameTimes.size() > 1) {
        const float most = *std::max_element(m.frameTimes.begin(), m.frameTimes.end());
        char label[48];
        std::snprintf(label, sizeof(label), "0 to %.0f ms", static_cast<double>(most));
        ImGui::PlotLines("##times", m.frameTimes.data(), static_cast<int>(m.frameTimes.size()), 0, label, 0,
                         most, ImVec2(17 * ImGui::GetFontSize(), 3.2f * ImGui::GetFontSize()));
    }
    ImGui::Text("trace %.1f, read back %.1f ms", 1e3 * facts.traceSeconds, 1e3 * facts.readbackSeconds);
    ImGui::Text("draw %.1f, present %.1f ms", 1e3 * m.drawSeconds, 1e3 * m.presentSeconds);
}

namespace {

void drawButtons(Gui& gui, Model& m) {
    Timeline& t = m.timeline;
    const float line = ImGui::GetFontSize();
    const char* label = t.playing() ? "pause" : "play";
    if (ImGui::Button(label, ImVec2(4 * line, 0))) t.toggle(m.clock.seconds());
    tip(gui, label, "the animation (Space)");
    ImGui::SameLine();
    if (ImGui::ArrowButton("##back", ImGuiDir_Left)) t.step(-1);
    tip(gui, "frame back", "a frame back (,)");
    ImGui::SameLine();
    if (ImGui::ArrowButton("##on", ImGuiDir_Right)) t.step(1);
    tip(gui, "frame on", "a frame on (.)");
    ImGui::SameLine();
    bool loops = t.loops();
    if (checkbox(gui, "loop", loops, "from the end on to the beginning")) t.setLoops(loops);
}

}  // namespace

float drawTimeline(Gui& gui, Model& m, float width) {
    Timeline& t = m.timeline;
    if (!t.any()) return 0;
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0, ImGui::GetIO().DisplaySize.y), ImGuiCond_Always, ImVec2(0, 1));
    ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(m.left > 0 ? 1.0f : 0.85f);
    float height = 0;
    if (ImGui::Begin("##timeline", nullptr,
                     kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoTitleBar)) {
        ImGui::PushItemWidth(width - 5 * line);
        drawButtons(gui, m);
        int frame = t.frame();
        if (slider(gui, "frame", frame, t.first(), std::max(t.last(), t.first() + 1),
                   "drag through the animation; Home and End go to its ends"))
            t.goTo(frame);
        double rate = t.rate();
        if (slider(gui, "fps", rate, 1, 120, "%.4g", "frames a second: how finely it is played and stepped",
                   true))
            t.setRate(rate);
        char moment[48] = "as the file says it";
        if (m.time) std::snprintf(moment, sizeof(moment), "%.5g s", *m.time);
        wrapped(moment, kDim);
        height = ImGui::GetWindowHeight();
        ImGui::PopItemWidth();
    }
    ImGui::End();
    return height;
}

}  // namespace glint::view
