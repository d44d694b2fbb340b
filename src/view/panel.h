// What stands over the picture: the panel, the list of keys, the pick, the inspector, messages.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "gpu/swapchain.h"
#include "view/compare.h"
#include "view/edits.h"
#include "view/file_list.h"
#include "view/gui.h"
#include "view/hints.h"
#include "view/picker.h"
#include "view/ray_lines.h"
#include "view/session.h"
#include "view/timeline.h"
#include "view/toasts.h"

namespace glint::view {

// The pixel under the mouse.
struct PixelFacts {
    int x = 0, y = 0;
    bool hasColor = false, hasData = false;
    glm::vec3 linear{0};
    PixelData data;
    std::string object, material;
};

// What a control of the panel asks the viewer to do, once.
enum class Wish {
    None,
    SavePng,
    SaveExr,
    RenderPng,
    RenderExr,
    SaveAs,  // to PanelModel::saveName
    Open,    // PanelModel::openName
    Verify,
    Keep,
    TraceReference,
    Undo,
    Redo,
    Bookmark,
    GoToCamera,    // PanelModel::camera
    WriteCameras,  // the bookmarks, into the scene's file
    ResetCamera,
    FocusPicked,
    PrintCamera,
    PlayPause,
    FrameBack,
    FrameOn
};

// Everything the panel shows, and what it changes.
struct PanelModel {
    // shown
    const gpu::DeviceInfo* device = nullptr;
    const Scene* scene = nullptr;
    const Canvas* picture = nullptr;  // without what stands over it
    int left = 0;                     // of the picture in the window: the docked panel's width
    FrameFacts facts;
    bool moving = false;
    int samples = 0;
    double progress = 0;  // of the sample at hand
    bool finished = false;
    const GoalFacts* goal = nullptr;  // of an error that is asked for; null: none is, or nothing known yet
    double frameSeconds = 0, drawSeconds = 0, presentSeconds = 0;
    const std::vector<float>* frameTimes = nullptr;  // milliseconds, oldest first
    std::vector<gpu::PresentMode> modes;             // that the screen offers
    // Of what runs beside; negative: nothing does.
    double saveProgress = -1, verifyProgress = -1, referenceProgress = -1;
    bool loading = false, closing = false;
    const std::optional<Pick>* pick = nullptr;
    bool pickIsOld = false;          // kept from an earlier view
    std::vector<Segment> pickLines;  // in step with Pick::rays; those that cannot be seen are points
    std::optional<PixelFacts> pixel;
    LayerRange range;
    const std::deque<Toast>* toasts = nullptr;
    std::string sceneError;  // of the file on disk; the old scene stays
    std::string verdict;     // of the last verify; empty: none to show
    bool verdictPassed = false;
    bool differenceShown = false;
    const std::vector<NamedCamera>* fileCameras = nullptr;
    bool holdsCameras = false;                                   // the scene's file can
    const std::vector<std::filesystem::path>* recent = nullptr;  // the first is the one that is shown
    Hints* hints = nullptr;                                      // to be shown; null: none
    PictureSettings fileSettings;                                // what "reset" goes back to
    SceneEdits fileEdits;
    bool perspective = true;
    double reach = 1;                 // radius of the scene
    std::optional<double> shownTime;  // of the animation, seconds; empty: as the file says it
    double seconds = 0;               // of the clock that `timeline` goes by

    // changed
    PictureSettings settings;
    SceneEdits edits;
    size_t material = 0;  // that is shown
    Display display;
    double targetSeconds = 0;
    double fovY = 40;
    bool hasFov = true;
    double lensRadius = 0, focusDistance = 0;
    bool flying = false;
    double flySpeed = 1;
    gpu::PresentMode mode = gpu::PresentMode::Fifo;
    render::Traversal traversal = render::Traversal::Auto;
    bool panelVisible = true;
    bool docked = false;  // beside the picture, not over it
    bool helpVisible = false;
    bool inspects = false;
    int zoom = 9;  // pixels across the inspector's magnifier
    bool pinsPick = false, drawsRays = true;
    Comparison* comparison = nullptr;
    Timeline* timeline = nullptr;
    bool saveAsVisible = false, openVisible = false;
    std::filesystem::path openFolder;
    std::vector<FileEntry> openFiles;  // there
    std::array<char, 4096> saveName{}, openName{};
    bool savesSeen = true;                          // SaveAs: what is seen, or at the scene's own sampling
    std::vector<NamedCamera>* bookmarks = nullptr;  // their names
    static constexpr size_t kNoCamera = ~size_t{0};
    size_t camera = kNoCamera;  // that was gone to, of the file's and then the bookmarks
    Wish wish = Wish::None;
    double helpScroll = 0;     // pixels
    float timelineHeight = 0;  // pixels, of the last frame; 0: there is none
};

// What a docked panel takes of a window that is so wide, pixels; never more than half.
int dockWidth(const Gui& gui, int window);

void drawPanel(Gui& gui, PanelModel& model);

}  // namespace glint::view
