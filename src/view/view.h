// `glint view`: a window to look around a scene in, drawn by the tracer that `glint render` uses
// (docs/guide/window.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "bvh/bvh.h"
#include "core/available_memory.h"
#include "import/scene_files.h"
#include "view/settings.h"

namespace glint::view {

// How scenes are loaded, the first one and all later.
struct Loading : LoadOptions {  // its memory is the available one
    BuildQuality quality = BuildQuality::Default;
};

struct Options {
    std::filesystem::path scene;
    Loading loading;
    Wishes wishes;
    converge::Target until{.error = 0};  // see PictureSettings
    std::optional<double> time;          // of the animation, seconds; empty: the file's values
    int width = 0, height = 0;           // of the window's image; 0: the scene's
    double scale = 0;                    // of text and controls; 0: the screen's
    std::string device;                  // selector, see gpu::chooseDevice
    bool validation = false;
    uint64_t frames = 0;  // close after so many; 0: when the user does
    std::function<uint64_t()> memory = [] { return availableMemory(); };  // bytes that may be taken
};

// Opens the window and returns once the user or an interrupt (core/interrupt.h) closes it. Throws Error:
// Scene for an invalid scene, Device without a display or a device.
void view(const Options& options, std::ostream& out, std::ostream& err);

}  // namespace glint::view
