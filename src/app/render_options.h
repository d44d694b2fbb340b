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
    std::filesystem::path output;  // empty: the scene's stem with .png, in the current folder
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

// The picture to write.
std::filesystem::path outputOf(const RenderCommand& command);

// Throws Error(Argument) if the picture would take the place of a file that the scene was read from: a
// texture often has its model's name.
void checkNotRead(const RenderCommand& command, const Scene& scene);

// Bytes for the image and a copy of each layer for the file. Further memory of the device or the encoder is
// bounded or smaller.
uint64_t bytesPerPixel(const std::vector<Aov>& aovs, bool data);

// All wishes of the command; `progress` is left empty. Throws Error(Argument) for a --crop beyond the image.
Request requestOf(const RenderCommand& command, const LoadedScene& loaded);

}  // namespace glint::app
