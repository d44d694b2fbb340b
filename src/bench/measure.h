// Measures how many rays a second are traced, and what every stage takes.
#pragma once

#include <functional>
#include <string>

#include "bench/result.h"
#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "render/renderer.h"
#include "trace/request.h"

namespace glint::bench {

struct Options {
    Request request;           // without adaptivity, see measure()
    render::Options renderer;  // `profile` is on in any case but WholePaths::On
    int repeats = 7;           // pictures that are timed
    bool everyWalk = false;    // each way to find hits in turn besides: Result::walks
    std::function<void(double)> progress = [](double) {};  // 0..1
    std::function<bool()> cancelled = [] { return false; };
};

// Draws the scene's picture, on `device` or, if that is null, by the reference. Every pixel takes the same
// samples, though the scene may ask for adaptive ones: rays a second of pixels that stop say nothing about
// the kernels. `scene` is the name that the result bears; its `open` is left at 0. Throws Error(Interrupted)
// once cancelled.
Result measure(const std::string& scene, const LoadedScene& loaded, const gpu::Device* device,
               const Options& options);

}  // namespace glint::bench
