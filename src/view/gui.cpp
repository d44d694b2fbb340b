#include "view/gui.h"

#include <backends/imgui_impl_glfw.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <utility>

namespace glint::view {

namespace {

constexpr float kFontPixels = 14;  // height of a line at scale 1

struct Font {
    const unsigned char* texels;
    int width, height;

    // Glyphs are drawn texel for pixel, so the nearest is exact.
    uint32_t coverage(float u, float v) const {
        const int x = std::clamp(static_cast<int>(u * static_cast<float>(width)), 0, width - 1);
        const int y = std::clamp(static_cast<int>(v * static_cast<float>(height)), 0, height - 1);
        return texels[y * width + x];
    }
};

struct Clip {
    int x0, y0, x1, y1;
};

// The color's own alpha times coverage, over what is there (Porter & Duff 1984).
uint32_t blend(uint32_t under, uint32_t color, uint32_t coverage) {
    const uint32_t alpha = ((color >> 24) * coverage + 127) / 255;
    const auto channel = [&](int shift) {
        const uint32_t a = color >> shift & 255u, b = under >> shift & 255u;
        return ((a * alpha + b * (255 - alpha) + 127) / 255) << shift;
    };
    return 0xff000000u | channel(0) | channel(8) | channel(16);
}

// First pixel whose centre is not left of x.
int firstCentre(float x) {
    return static_cast<int>(std::ceil(x - 0.5f));
}

// The x of the edge from a, above, to b in the row at y. Both triangles of an edge get the same x, so that
// their spans meet without gap or overlap.
float crossing(const ImDrawVert& a, const ImDrawVert& b, float y) {
    return a.pos.x + (b.pos.x - a.pos.x) * ((y - a.pos.y) / (b.pos.y - a.pos.y));
}

glm::vec4 channelsOf(uint32_t color) {
    return {color & 255u, color >> 8 & 255u, color >> 16 & 255u, color >> 24};
}

uint32_t packed(const glm::vec4& channels) {
    const glm::uvec4 bytes(glm::clamp(channels, 0.0f, 255.0f) + 0.5f);
    return bytes.x | bytes.y << 8 | bytes.z << 16 | bytes.w << 24;
}

// Row by row from edge to edge; color and place in the font are linear between the corners.
void drawTriangle(Canvas& target, const Clip& clip, const Font& font, std::array<ImDrawVert, 3> v) {
    std::sort(v.begin(), v.end(), [](const auto& a, const auto& b) { return a.pos.y < b.pos.y; });
    const glm::vec2 b(v[1].pos.x - v[0].pos.x, v[1].pos.y - v[0].pos.y);
    const glm::vec2 c(v[2].pos.x - v[0].pos.x, v[2].pos.y - v[0].pos.y);
    const float area = b.x * c.y - b.y * c.x;  // twice
    if (area == 0) return;
    const glm::vec2 bScaled = b / area, cScaled = c / area;
    const bool oneColor = v[0].col == v[1].col && v[0].col == v[2].col;
    const auto samePlace = [](const ImVec2& p, const ImVec2& q) { return p.x == q.x && p.y == q.y; };
    const bool oneTexel = samePlace(v[0].uv, v[1].uv) && samePlace(v[0].uv, v[2].uv);
    const uint32_t coverage = font.coverage(v[0].uv.x, v[0].uv.y);
    const glm::vec4 colors[] = {channelsOf(v[0].col), channelsOf(v[1].col), channelsOf(v[2].col)};
    const int end = std::min(firstCentre(v[2].pos.y), clip.y1);
    for (int row = std::max(firstCentre(v[0].pos.y), clip.y0); row < end; ++row) {
        const float y = static_cast<float>(row) + 0.5f;
        const auto [left, right] = std::minmax(
            {crossing(v[0], v[2], y), y < v[1].pos.y ? crossing(v[0], v[1], y) : crossing(v[1], v[2], y)});
        const int x1 = std::min(firstCentre(right), clip.x1);
        uint32_t* const out = target.row(row);
        for (int x = std::max(firstCentre(left), clip.x0); x < x1; ++x) {
            if (oneColor && oneTexel) {  // nearly all of a panel's area
                out[x] = blend(out[x], v[0].col, coverage);
                continue;
            }
            const glm::vec2 place(static_cast<float>(x) + 0.5f - v[0].pos.x, y - v[0].pos.y);
            const float wb = place.x * cScaled.y - place.y * cScaled.x;
            const float wc = place.y * bScaled.x - place.x * bScaled.y;
            const auto mixed = [&](const auto& v0, const auto& v1, const auto& v2) {
                return v0 + wb * (v1 - v0) + wc * (v2 - v0);
            };
            const float s = mixed(v[0].uv.x, v[1].uv.x, v[2].uv.x);
            const float t = mixed(v[0].uv.y, v[1].uv.y, v[2].uv.y);
            const uint32_t color = oneColor ? v[0].col : packed(mixed(colors[0], colors[1], colors[2]));
            out[x] = blend(out[x], color, font.coverage(s, t));
        }
    }
}

void drawCommand(Canvas& target, const ImDrawCmd& command, const ImDrawList& list, const Font& font) {
    const Clip clip = {std::max(static_cast<int>(command.ClipRect.x), 0),
                       std::max(static_cast<int>(command.ClipRect.y), 0),
                       std::min(static_cast<int>(command.ClipRect.z), target.width),
                       std::min(static_cast<int>(command.ClipRect.w), target.height)};
    const ImDrawIdx* index = list.IdxBuffer.Data + command.IdxOffset;
    const auto vertex = [&](unsigned i) -> const ImDrawVert& {
        return list.VtxBuffer[static_cast<int>(index[i] + command.VtxOffset)];
    };
    for (unsigned i = 0; i + 2 < command.ElemCount; i += 3)
        drawTriangle(target, clip, font, {vertex(i), vertex(i + 1), vertex(i + 2)});
}

// The first font that is there, where Debian has it; null: Dear ImGui's own font, which is made of pixels.
const char* findFont() {
    for (const char* file : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                             "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                             "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
                             "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                             "/usr/share/fonts/truetype/freefont/FreeSans.ttf"}) {
        std::error_code error;
        if (std::filesystem::is_regular_file(file, error)) return file;
    }
    return nullptr;
}

}  // namespace

Gui::Gui(float scale, const Window& window) : window_(window.handle()) {
    ImGui::CreateContext();
    // The window uses only keys and clipboard of ImGui's backend: events come from the window's own queue.
    ImGui_ImplGlfw_InitForOther(window_, false);
    ImGuiIO& io = ImGui::GetIO();
    io.UserData = this;
    io.IniFilename = nullptr;  // no file appears where the program runs
    ImFontConfig font;
    font.OversampleH = font.OversampleV = 1;  // glyphs are drawn texel for pixel
    font.PixelSnapH = true;
    font.SizePixels = std::round(kFontPixels * scale);
    const char* const file = findFont();
    if (file == nullptr || io.Fonts->AddFontFromFileTTF(file, font.SizePixels, &font) == nullptr) {
        font.SizePixels = 13 * std::round(scale);  // the built-in font is made of pixels
        io.Fonts->AddFontDefault(&font);
    }
    fontPixels_ = font.SizePixels;
    io.Fonts->Build();
    ImGuiStyle& style = ImGui::GetStyle();
    ImGui::StyleColorsDark();
    style.Colors[ImGuiCol_PlotHistogram] = ImVec4(0.16f, 0.38f, 0.62f, 1);  // white letters stand on it
    style.WindowPadding = ImVec2(6, 6);
    style.ItemSpacing = ImVec2(6, 3);
    style.FramePadding = ImVec2(4, 2);
    style.ScaleAllSizes(scale);
    // An empty box must stand out against a dark image, and a number from a slider's grip.
    style.FrameBorderSize = 1;
    style.Colors[ImGuiCol_Border] = ImVec4(0.45f, 0.5f, 0.6f, 0.6f);
    style.Colors[ImGuiCol_SliderGrab].w = 0.6f;
    style.ColorButtonPosition = ImGuiDir_Left;
    style.WindowRounding = style.FrameRounding = style.GrabRounding = 0;
    style.AntiAliasedLinesUseTex = false;
}

Gui::~Gui() {
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Gui::feed(const Event& event) {
    ImGuiIO& io = ImGui::GetIO();
    switch (event.type) {
        case Event::Type::Cursor:
            io.MousePos = ImVec2(static_cast<float>(event.x), static_cast<float>(event.y));
            break;
        case Event::Type::Button:
            io.MouseDown[event.code] = event.down;
            break;
        case Event::Type::Wheel:
            io.MouseWheel += static_cast<float>(event.y);
            break;
        case Event::Type::Text:
            io.AddInputCharacter(static_cast<unsigned>(event.code));
            break;
        case Event::Type::Key:
            ImGui_ImplGlfw_KeyCallback(window_, event.code, 0, event.down ? GLFW_PRESS : GLFW_RELEASE,
                                       event.mods);
            break;
        default:
            break;
    }
}

bool Gui::covers(double x, double y, bool inert) const {
    const ImVec2 at(static_cast<float>(x), static_cast<float>(y));
    const ImGuiWindowFlags skipped = ImGuiWindowFlags_ChildWindow | ImGuiWindowFlags_Tooltip |
                                     (inert ? 0 : ImGuiWindowFlags_NoMouseInputs);
    const auto& windows = ImGui::GetCurrentContext()->Windows;
    return anyPopup_ || std::any_of(windows.begin(), windows.end(), [&](const ImGuiWindow* window) {
               return window->Active && (window->Flags & skipped) == 0 && window->Rect().Contains(at);
           });
}

// An item is active from the frame of the click on, one frame before ImGui's WantTextInput.
bool Gui::wantsKeys() const {
    return ImGui::GetIO().WantTextInput || ImGui::IsAnyItemActive();
}

std::optional<glm::dvec2> Gui::controlAt(const std::string& label) const {
    const auto found = controls_.find(label);
    return found == controls_.end() ? std::nullopt : std::optional(found->second);
}

void Gui::begin(int width, int height, double seconds) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
    io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 1.0));
    ImGui::NewFrame();
    if (std::exchange(closesPopups_, false)) ImGui::ClosePopupToLevel(0, true);
}

bool Gui::closePopups() {
    closesPopups_ = anyPopup_;
    return anyPopup_;
}

Gui& Gui::current() {
    return *static_cast<Gui*>(ImGui::GetIO().UserData);
}

void Gui::noteControl(const std::string& label, float part) {
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    current().nextControls_[label] = {lo.x + part * (hi.x - lo.x), 0.5f * (lo.y + hi.y)};
}

void Gui::end(Canvas& target) {
    ImGui::Render();
    const ImGuiID before = std::exchange(held_, ImGui::GetActiveID());
    leftControl_ = before != 0 && before != held_;
    controls_ = std::exchange(nextControls_, {});
    tip_ = std::exchange(nextTip_, {});
    // Open lists and menus reach beyond their windows.
    anyPopup_ = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    const ImDrawData* data = ImGui::GetDrawData();
    const ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    const Font font = {atlas.TexPixelsAlpha8, atlas.TexWidth, atlas.TexHeight};
    for (int i = 0; i < data->CmdListsCount; ++i) {
        const ImDrawList& list = *data->CmdLists[i];
        for (const ImDrawCmd& command : list.CmdBuffer) {
            if (command.UserCallback == nullptr) drawCommand(target, command, list, font);
        }
    }
}

}  // namespace glint::view
