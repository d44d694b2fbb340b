// Steps that several commands take.
#pragma once

#include <iosfwd>
#include <string>

#include "app/cli.h"
#include "gpu/device.h"
#include "pack/pack_samples.h"
#include "pack/packed_scene.h"
#include "render/renderer.h"
#include "scene/scene.h"

namespace glint::app {

struct LoadedScene {
    Scene scene;
    PackedScene packed;
    double loadSeconds = 0, packSeconds = 0;
};

// Loads, applies the command line's overrides, packs; warnings go to `err`, one line each, unless quiet.
LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet = false);

// The camera of the scene's picture.
shared::Camera cameraOf(const LoadedScene& loaded);

// The samples of the scene's picture.
PackedSamples samplesOf(const LoadedScene& loaded);

// Prints what the validation layer said; throws Error(Device) if it said anything, or was asked for and is
// not there.
void reportValidation(const gpu::Device& device, const DeviceChoice& choice, std::ostream& err);

// True if standard error is a terminal and `err` is it.
bool isTerminal(const std::ostream& err);

std::string formatSeconds(double seconds);

// "1 light", "2 lights"
std::string counted(uint64_t count, const std::string& noun);

}  // namespace glint::app
