// Measurements as tables for people and as JSON.
#pragma once

#include <string>
#include <vector>

#include "bench/measure.h"

namespace glint::bench {

// The program that measured.
struct Program {
    std::string version, commit;
};

// Rays cast and the time they took, in the order that they are shown.
struct Rate {
    const char* key;   // in JSON
    const char* name;  // in the table
    uint64_t rays = 0;
    Quartiles seconds;       // all 0: not measured apart
    double testsPerRay = 0;  // boxes and primitives
};
std::vector<Rate> ratesOf(const Result& result);

// Rays, stages and memory, and a line for each traversal that was measured.
std::string table(const Result& result, const Program& program);

// One document for all scenes (docs/lab/building.md).
std::string json(const std::vector<Result>& results, const Program& program);

}  // namespace glint::bench
