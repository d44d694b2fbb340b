// Measures scenes, keeps what is done, writes it out.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "report/plan.h"
#include "trace/backend.h"

namespace glint::report {

struct Options {
    std::filesystem::path folder;       // that exists and can be written to
    std::string version;                // of the program; a report of another one is not gone on with
    int width = 256;                    // of the pictures, in pixels
    int repeats = 10;                   // runs of each setting
    int truthSamples = 0;               // of each pixel of the converged picture; 0: as time allows
    Backend truth = Backend::Cpu;       // who draws it
    std::vector<std::string> only;      // how the names of families start; empty: all
    std::vector<DeviceBeside> devices;  // to be set side by side; may be empty
    // A batch of settings that would take longer is left out.
    std::function<double()> secondsLeft = [] { return std::numeric_limits<double>::infinity(); };
    std::function<bool()> cancelled = [] { return false; };  // the report is left incomplete
    // Bytes that there are, asked when the scenes are loaded.
    std::function<uint64_t()> memory = [] { return std::numeric_limits<uint64_t>::max(); };
    std::function<void(double)> progress = [](double) {};  // 0..1
};

struct Subject {
    std::filesystem::path path;
    std::string camera;  // that was chosen by its name; empty: the scene's own
    LoadedScene loaded;
};

// report.json in the folder, if it was made in the same way as the report that is asked for, so that this one
// goes on with it. Otherwise nothing, and `warning` says why if there was one. Throws Error(Failed) for a
// file that is no report.
std::optional<Report> earlierReport(const Options& options, const gpu::DeviceInfo& device,
                                    std::string& warning);

// Measures what `earlier` lacks, most important first, and writes report.json, report.csv, report.html and
// the diagrams after each part. Scenes of `earlier` that are not among the subjects stay in the report.
// Throws Error(Failed) if that takes more memory than there is, before the first picture.
Report run(const gpu::Device& device, std::vector<Subject> subjects, const std::optional<Report>& earlier,
           const Options& options);

}  // namespace glint::report
