// What stands over the picture: the panel, the list of keys, the pick, the verdict, messages.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "gpu/swapchain.h"
#include "view/gui.h"
#include "view/picker.h"
#include "view/session.h"

namespace glint::view {

// Everything the panel shows, and what it changes.
struct PanelModel {
    // shown
    const gpu::DeviceInfo* device = nullptr;
    const Scene* scene = nullptr;
    FrameFacts facts;
    bool moving = false;
    int samples = 0;
    double progress = 0;  // of the sample at hand
    bool finished = false;
    double frameSeconds = 0, drawSeconds = 0, presentSeconds = 0;
    const std::vector<float>* frameTimes = nullptr;  // milliseconds, oldest first
    std::vector<gpu::PresentMode> modes;             // that the screen offers
    double saveProgress = -1, verifyProgress = -1;   // negative: nothing runs
    bool loading = false;
    const std::optional<Pick>* pick = nullptr;
    std::string sceneError;  // of the file on disk; the old scene stays
    std::string message;
    std::string verdict;  // of the last verify; empty: none to show
    bool verdictPassed = false;

    // changed
    PictureSettings settings;
    double exposure = 0;
    double targetSeconds = 0;
    double fovY = 40;
    bool hasFov = true;
    bool flying = false;
    gpu::PresentMode mode = gpu::PresentMode::Fifo;
    bool panelVisible = true;
    bool helpVisible = false;
};

void drawPanel(Gui& gui, PanelModel& model);

}  // namespace glint::view
