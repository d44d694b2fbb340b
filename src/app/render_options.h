// `glint render`: what its command line says, and what that asks of a tracer.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/error_target.h"
#include "app/option_groups.h"
#include "core/progress.h"
#include "pack/loaded_scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::app {

struct RenderCommand {
    SceneOptions scene;
    std::filesystem::path output;    // empty: the scene's name with .png, in the current folder; "-"
    std::optional<double> exposure;  // stops
    Backend backend = Backend::Gpu;
    DeviceChoice device;
    std::vector<Aov> aovs = {Aov::Radiance};
    std::optional<Region> crop;
    std::optional<int> bandRows;  // of a picture that is written in bands; empty: if it must be
    ErrorTarget target;
    std::optional<PartChoice> part;
    std::filesystem::path checkpoint;  // empty: none
    std::optional<FrameRange> frames;
    std::optional<double> framesPerSecond;
    bool overwrite = false;  // frames that are there
    bool json = false;       // --stats
    ProgressMode progress = ProgressMode::Auto;
    bool quiet = false;
};

bool needsData(const RenderCommand& command);

// The image file to write; "-" for standard output.
std::filesystem::path outputOf(const RenderCommand& command);

// The same, but no file that the scene was read from: a texture often has its model's name. A default name
// becomes NAME.render.png; throws Error(Argument) for a given one.
std::filesystem::path outputOf(const RenderCommand& command, const Scene& scene);

// Factor of the colours in an 8-bit file, 2^exposure; 0 for files with floats. Throws Error(Argument) if
// `exposure` is given for these.
float scaleOf(const std::filesystem::path& output, std::optional<double> exposure);

// Multiplies the layer "color" by `scale`, unless it is 0.
void expose(std::vector<Layer>& layers, float scale);
std::vector<Layer> layersOf(const Picture& picture, const RenderCommand& command);

// Bytes for the image and a copy of each layer for the file. Further memory of the device or the encoder is
// bounded or smaller.
uint64_t bytesPerPixel(const std::vector<Aov>& aovs, bool data);

// All wishes of the command; `progress` is left empty. Throws Error(Argument) for a --crop beyond the image.
Request requestOf(const RenderCommand& command, const LoadedScene& loaded);

}  // namespace glint::app
