// Measurements as tables for people and as JSON.
#pragma once

#include <string>
#include <vector>

#include "bench/result.h"

namespace glint::bench {

// The program that measured.
struct Program {
    std::string version, commit;
};

// Rays, stages, memory; and a table of the walks, if they were measured.
std::string table(const Result& result, const Program& program);
std::string walkTable(const std::vector<Result>& walks);

// One document for all scenes (docs/lab/building.md).
std::string json(const std::vector<Result>& results, const Program& program);

}  // namespace glint::bench
