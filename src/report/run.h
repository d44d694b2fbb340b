// Measures scenes and writes the report.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "report/plan.h"

namespace glint::report {

struct Subject {
    std::filesystem::path path;
    std::string camera;  // chosen by its name; empty: the scene's own
    LoadedScene loaded;
};

// The stem of each file, STEM-2 for the second of the same stem: names of files about them.
std::vector<std::string> uniqueStems(const std::vector<std::filesystem::path>& files);

// report.json in the folder, if it was made with the same options, device and version; otherwise empty, with
// the reason in `warning`. Throws Error(Failed) for a file that is not a report.
std::optional<Report> earlierReport(const Options& options, const gpu::DeviceInfo& device,
                                    std::string& warning);

// Measures in turns: in each turn every setting of every scene gets one more run, most important first, as
// far as the time allows. Runs of `earlier` count. Writes report.json, report.csv, report.html and the
// diagrams on the way and at the end. Scenes of `earlier` that are not among the subjects stay in the report.
// Throws Error(Failed) if the images need more memory than is available, or if nothing was measured.
Report run(const gpu::Device& device, std::vector<Subject> subjects, const std::optional<Report>& earlier,
           const Options& options);

}  // namespace glint::report
