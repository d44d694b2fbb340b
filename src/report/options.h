// Options of a report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "report/plan.h"
#include "trace/backend.h"

namespace glint::report {

struct Options {
    std::filesystem::path folder;       // exists and is writable
    std::string version;                // of the program; a report of another version is not resumed
    int width = 256;                    // of the images, in pixels
    int repeats = 10;                   // runs of each setting
    int truthSamples = 0;               // per pixel of the converged image; 0: as time allows
    Backend truth = Backend::Cpu;       // renders the converged image
    std::vector<std::string> only;      // first words of families; empty: all
    std::vector<DeviceBeside> devices;  // to be compared; may be empty
    std::function<double()> secondsLeft = [] { return std::numeric_limits<double>::infinity(); };
    std::function<bool()> cancelled = [] { return false; };
    // Available bytes.
    std::function<uint64_t()> memory = [] { return std::numeric_limits<uint64_t>::max(); };
    std::function<void(double)> progress = [](double) {};  // share of the runs, 0..1
};

}  // namespace glint::report
