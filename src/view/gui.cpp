#include "view/gui.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
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

bool isRectangle(const ImDrawVert& a, const ImDrawVert& b, const ImDrawVert& c, const ImDrawVert& d) {
    return a.pos.y == b.pos.y && b.pos.x == c.pos.x && c.pos.y == d.pos.y && d.pos.x == a.pos.x &&
           a.pos.x <= c.pos.x && a.pos.y <= c.pos.y && a.col == b.col && a.col == c.col && a.col == d.col;
}

// Axis-parallel, of one colour: boxes and glyphs, nearly all that a panel consists of.
void drawRectangle(Canvas& target, const Clip& clip, const Font& font, const ImDrawVert& a,
                   const ImDrawVert& c) {
    const int x0 = std::max(firstCentre(a.pos.x), clip.x0), x1 = std::min(firstCentre(c.pos.x), clip.x1);
    const int y0 = std::max(firstCentre(a.pos.y), clip.y0), y1 = std::min(firstCentre(c.pos.y), clip.y1);
    const float width = std::max(c.pos.x - a.pos.x, 1e-6f), height = std::max(c.pos.y - a.pos.y, 1e-6f);
    const bool plain = a.uv.x == c.uv.x && a.uv.y == c.uv.y;
    const uint32_t constant = font.coverage(a.uv.x, a.uv.y);
    for (int y = y0; y < y1; ++y) {
        uint32_t* row = target.row(y);
        const float v = a.uv.y + (c.uv.y - a.uv.y) * ((static_cast<float>(y) + 0.5f - a.pos.y) / height);
        for (int x = x0; x < x1; ++x) {
            const float u = a.uv.x + (c.uv.x - a.uv.x) * ((static_cast<float>(x) + 0.5f - a.pos.x) / width);
            row[x] = blend(row[x], a.col, plain ? constant : font.coverage(u, v));
        }
    }
}

float edge(const ImVec2& a, const ImVec2& b, const ImVec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Exactly one of two triangles owns the pixels on a common edge; otherwise they would be blended twice.
bool ownsEdge(const ImVec2& a, const ImVec2& b) {
    return a.y > b.y || (a.y == b.y && a.x < b.x);
}

uint32_t mixColors(const std::array<uint32_t, 3>& colors, const std::array<float, 3>& weights) {
    uint32_t result = 0;
    for (int shift = 0; shift < 32; shift += 8) {
        float sum = 0.5f;
        for (size_t i = 0; i < 3; ++i) sum += weights[i] * static_cast<float>(colors[i] >> shift & 255u);
        result |= static_cast<uint32_t>(std::clamp(sum, 0.0f, 255.0f)) << shift;
    }
    return result;
}

void drawTriangle(Canvas& target, const Clip& clip, const Font& font, const ImDrawVert& a, ImDrawVert b,
                  ImDrawVert c) {
    float area = edge(a.pos, b.pos, c.pos);
    if (area == 0) return;
    if (area < 0) {
        std::swap(b, c);
        area = -area;
    }
    const auto [left, right] = std::minmax({a.pos.x, b.pos.x, c.pos.x});
    const auto [top, bottom] = std::minmax({a.pos.y, b.pos.y, c.pos.y});
    const int x0 = std::max(firstCentre(left), clip.x0), x1 = std::min(firstCentre(right) + 1, clip.x1);
    const int y0 = std::max(firstCentre(top), clip.y0), y1 = std::min(firstCentre(bottom) + 1, clip.y1);
    const std::array<bool, 3> owns = {ownsEdge(b.pos, c.pos), ownsEdge(c.pos, a.pos), ownsEdge(a.pos, b.pos)};
    for (int y = y0; y < y1; ++y) {
        uint32_t* row = target.row(y);
        for (int x = x0; x < x1; ++x) {
            const ImVec2 p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
            std::array<float, 3> w = {edge(b.pos, c.pos, p), edge(c.pos, a.pos, p), edge(a.pos, b.pos, p)};
            bool inside = true;
            for (size_t i = 0; i < 3; ++i) inside = inside && (w[i] > 0 || (w[i] == 0 && owns[i]));
            if (!inside) continue;
            for (float& weight : w) weight /= area;
            const float u = w[0] * a.uv.x + w[1] * b.uv.x + w[2] * c.uv.x;
            const float v = w[0] * a.uv.y + w[1] * b.uv.y + w[2] * c.uv.y;
            row[x] = blend(row[x], mixColors({a.col, b.col, c.col}, w), font.coverage(u, v));
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
    for (unsigned i = 0; i + 2 < command.ElemCount; i += 3) {
        const bool pair =
            i + 5 < command.ElemCount && index[i] == index[i + 3] && index[i + 2] == index[i + 4];
        if (pair && isRectangle(vertex(i), vertex(i + 1), vertex(i + 2), vertex(i + 5))) {
            drawRectangle(target, clip, font, vertex(i), vertex(i + 2));
            i += 3;
        } else {
            drawTriangle(target, clip, font, vertex(i), vertex(i + 1), vertex(i + 2));
        }
    }
}

#if IMGUI_VERSION_NUM >= 18700
constexpr ImGuiKey kKeypadEnterKey = ImGuiKey_KeypadEnter;
#else
constexpr ImGuiKey_ kKeypadEnterKey = ImGuiKey_KeyPadEnter;
#endif

void mapKeys(ImGuiIO& io) {
    io.KeyMap[ImGuiKey_Tab] = GLFW_KEY_TAB;
    io.KeyMap[ImGuiKey_LeftArrow] = GLFW_KEY_LEFT;
    io.KeyMap[ImGuiKey_RightArrow] = GLFW_KEY_RIGHT;
    io.KeyMap[ImGuiKey_UpArrow] = GLFW_KEY_UP;
    io.KeyMap[ImGuiKey_DownArrow] = GLFW_KEY_DOWN;
    io.KeyMap[ImGuiKey_Home] = GLFW_KEY_HOME;
    io.KeyMap[ImGuiKey_End] = GLFW_KEY_END;
    io.KeyMap[ImGuiKey_Delete] = GLFW_KEY_DELETE;
    io.KeyMap[ImGuiKey_Backspace] = GLFW_KEY_BACKSPACE;
    io.KeyMap[ImGuiKey_Enter] = GLFW_KEY_ENTER;
    io.KeyMap[kKeypadEnterKey] = GLFW_KEY_KP_ENTER;
    io.KeyMap[ImGuiKey_Escape] = GLFW_KEY_ESCAPE;
    io.KeyMap[ImGuiKey_A] = 'A';
    io.KeyMap[ImGuiKey_C] = 'C';
    io.KeyMap[ImGuiKey_V] = 'V';
    io.KeyMap[ImGuiKey_X] = 'X';
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

Gui::Gui(float scale, Window& window) : window_(window) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // no file appears where the program runs
    io.BackendPlatformName = "glint";
    mapKeys(io);
    io.ClipboardUserData = this;
    io.GetClipboardTextFn = [](void* self) {
        auto* gui = static_cast<Gui*>(self);
        gui->pasted_ = gui->window_.clipboard();
        return gui->pasted_.c_str();
    };
    io.SetClipboardTextFn = [](void* self, const char* text) {
        static_cast<Gui*>(self)->window_.setClipboard(text);
    };
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
    // An empty box must be seen on a dark picture, and a number under a slider's grip.
    style.FrameBorderSize = 1;
    style.Colors[ImGuiCol_Border] = ImVec4(0.45f, 0.5f, 0.6f, 0.6f);
    style.Colors[ImGuiCol_SliderGrab].w = 0.6f;
    style.WindowRounding = style.FrameRounding = style.GrabRounding = 0;
    style.AntiAliasedLinesUseTex = false;
}

Gui::~Gui() {
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
        case Event::Type::Key: {
            if (event.code <= GLFW_KEY_LAST) io.KeysDown[event.code] = event.down;
            // Under X11 the event of a modifier's own press does not have it among its modifiers yet.
            const auto held = [&](int left, int right) { return io.KeysDown[left] || io.KeysDown[right]; };
            io.KeyCtrl = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
            io.KeyShift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
            io.KeyAlt = held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
            break;
        }
        default:
            break;
    }
}

std::vector<Gui::Rectangle> Gui::windows(bool inert) const {
    const ImGuiWindowFlags skipped = ImGuiWindowFlags_ChildWindow | ImGuiWindowFlags_Tooltip |
                                     (inert ? 0 : ImGuiWindowFlags_NoMouseInputs);
    std::vector<Rectangle> result;
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
        const ImRect r = window->Rect();
        if (window->Active && (window->Flags & skipped) == 0)
            result.push_back({r.Min.x, r.Min.y, r.Max.x, r.Max.y});
    }
    return result;
}

bool Gui::covers(double x, double y) const {
    const auto at = ImVec2(static_cast<float>(x), static_cast<float>(y));
    const std::vector<Rectangle> all = windows(false);
    return anyPopup_ || std::any_of(all.begin(), all.end(), [&](const Rectangle& r) {
               return at.x >= r.x0 && at.x < r.x1 && at.y >= r.y0 && at.y < r.y1;
           });
}

// An item is active from the frame on that has seen the click, one before ImGui says that it wants text.
bool Gui::wantsKeys() const {
    return ImGui::GetIO().WantTextInput || ImGui::IsAnyItemActive();
}

std::optional<Gui::Place> Gui::controlAt(const std::string& label) const {
    const auto found = controls_.find(label);
    if (found == controls_.end()) return std::nullopt;
    return found->second;
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

void Gui::noteControl(const char* label) {
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    // A slider's rectangle has its label behind it; its left part is always the control.
    nextControls_[label] = {static_cast<double>(lo.x + 0.25f * (hi.x - lo.x)),
                            static_cast<double>(0.5f * (lo.y + hi.y))};
}

void Gui::end(Canvas& target) {
    ImGui::Render();
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
