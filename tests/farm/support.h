// Small pictures of the reference, whole and in parts.
#pragma once

#include <filesystem>
#include <vector>

#include "farm/unit_file.h"
#include "pack/loaded_scene.h"
#include "support/support.h"

namespace glint::farm::test {

// A mirror before a row of spheres and a mesh-like fan of triangles, all in the lower left of the picture:
// the rest is cheap background.
const LoadedScene& uneven();

// Its picture in that size.
Request requestFor(int width, int height);

Picture draw(const Request& request);

// The parts of that picture, cut by the estimate or evenly.
std::vector<UnitResult> partsOf(const Request& request, int parts, const std::vector<Aov>& aovs,
                                bool even = false);

struct UnitFile {
    UnitHeader header;
    std::vector<UnitResult> results;
    uint64_t wholeBytes = 0;
};
UnitFile readUnits(const std::filesystem::path& path);

UnitHeader headerOf(const Request& request, int parts, const std::vector<Aov>& aovs);

}  // namespace glint::farm::test
