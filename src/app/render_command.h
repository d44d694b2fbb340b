// `glint render`: its command line, the request that it makes, and its ways to render an image.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "app/cli.h"
#include "app/options.h"
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
    std::optional<int> bandRows;  // of an image that is written in bands; empty: if it must be
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

// The image file to write; "-" for standard output.
std::filesystem::path outputOf(const RenderCommand& command);

// The same, but no file that the scene was read from: a texture often has its model's name. A default name
// becomes NAME.render.png; throws Error(Argument) for a given one.
std::filesystem::path outputOf(const RenderCommand& command, const Scene& scene);

// Bytes for the image and a copy of each layer for the file. Further memory of the device or the encoder is
// bounded or smaller.
uint64_t bytesPerPixel(const RenderCommand& command);
// Bytes for a unit, which has no PixelData.
uint64_t bytesPerPixel(const std::vector<Aov>& aovs);

// All wishes of the command; `progress` is left empty. Throws Error(Argument) for a --crop beyond the image.
Request requestOf(const RenderCommand& command, const LoadedScene& loaded);

// --part, --checkpoint and MPI render an image unit by unit (farm/unit.h). Throws Error(Argument) for options
// that exclude MPI.
bool isInUnits(const RenderCommand& command);
// Throws without CMake's GLINT_FARM.
ExitCode renderInUnits(const RenderCommand& command, std::ostream& out, std::ostream& err);

}  // namespace glint::app
