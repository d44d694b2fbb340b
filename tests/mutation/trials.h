// The cases that mutation_judge draws, read from a file.
#pragma once

#include <map>
#include <string>

#include "../render/support.h"
#include "render/renderer.h"
#include "verify/verify.h"

namespace glint::mutation {

struct Trial {
    render::test::Case scene;
    verify::Options options;
    render::Options device;  // without kernels
};

// By name. CASES of judge.cpp; throws std::runtime_error for what is none.
std::map<std::string, Trial> readTrials(const std::string& path);

}  // namespace glint::mutation
