// Steps that several commands take.
#pragma once

#include <iosfwd>
#include <string>

#include "app/cli.h"
#include "bvh/packed_scene.h"
#include "core/progress.h"
#include "gpu/device.h"
#include "reference/render.h"
#include "scene/scene.h"

namespace glint::app {

struct LoadedScene {
    Scene scene;
    PackedScene packed;
    double loadSeconds = 0, packSeconds = 0;
};

// Loads, applies the command line's overrides, packs; warnings go to `err`, one line each, unless quiet.
LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet = false);

// Prints what the validation layer said; true if it said anything, or was asked for and is not there.
bool reportValidation(const gpu::Device& device, const DeviceChoice& choice, std::ostream& err);

// True if standard error is a terminal and `err` is it.
bool isTerminal(const std::ostream& err);

// The reference's picture in the form that the renderer gives.
Picture toPicture(const reference::RenderResult& result);

std::string formatSeconds(double seconds);

}  // namespace glint::app
