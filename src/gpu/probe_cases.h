// Private to src/gpu and its tests: what a device is asked by the probe of its arithmetic, and the verdict.
#pragma once

#include <span>
#include <vector>

#include "gpu/probe.h"

namespace glint::gpu {

// Three rows of shaders/probe.comp.
struct ProbeCase {
    struct Given {
        float a = 0, b = 0, c = 0, unused = 0;
    };
    struct Found {
        float sum = 0, product = 0, both = 0, unused0 = 0, quotient = 0, root = 0, unused1 = 0, unused2 = 0;
    };
    Given given;
    Found found;
};
static_assert(sizeof(ProbeCase) == 48);

// 2^16, the same on every machine.
std::vector<ProbeCase> probeCases();
Arithmetic judged(std::span<const ProbeCase> cases);

}  // namespace glint::gpu
