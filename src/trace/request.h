// What is asked of a tracer. A request is a plain value: made once, from the command line, the window, a
// script or a call, and handed to either tracer with a packed scene, which no request changes. What only
// concerns how the device works (traversal, access, slices ...) is in render::Options.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "trace/packed_samples.h"
#include "trace/picture.h"

namespace glint {

struct Request {
    // ---- which pixels ----
    int width = 0, height = 0;  // of the whole picture
    Region region;              // the part wanted, cut off at the picture's edges; all zero: everything
    // What each pixel takes; the default is its middle. A thin lens needs scattered samples, or stays a
    // pinhole.
    PackedSamples samples = PackedSamples::fixed({{0.5, 0.5}});

    // ---- what is drawn ----
    bool shadows = true;               // false: lights shine through everything. The device only.
    std::optional<uint32_t> maxDepth;  // reflections and refractions in a row, instead of the scene's. The
                                       // device only; 0 if the scene was packed without mirrors.

    // ---- what is wanted ----
    bool data = false;    // Picture::data
    bool cost = false;    // PixelData::cost, which the reference always counts; implies data
    bool exact = false;   // Picture::exact, of the reference alone
    bool ledger = false;  // Picture::losses, which the reference always fills; the device needs it to obey
                          // Environment::minContribution
    bool tally = false;   // the device's count of rays by class (Renderer::rays), which takes time there

    // ---- on the way ----
    // Called with the fraction done, 0..1, which never falls; from any thread, one call at a time.
    std::function<void(double)> progress;
    // Asked now and then, by the reference from all threads; true ends the picture early.
    std::function<bool()> cancelled;

    bool wantsData() const { return data || cost; }
};

// The pixels that are asked for; empty if the region lies outside of the picture.
Region regionOf(const Request& request);

// A picture of the region with nothing done yet: what is asked for has its size.
Picture blankPicture(const Request& request);

}  // namespace glint
