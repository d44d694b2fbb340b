// Tests a device's arithmetic for what Vulkan requires, and for further guarantees.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace glint::gpu {

// Properties that a device showed in 2^16 cases. Most cases lie where the next bit decides: quotients and
// roots next to the middle between two floats, results at and below the least normal float 2^-126, sums that
// leave a tie.
struct Arithmetic {
    // Promised by Vulkan: sums and products of normal floats are correctly rounded, to even, and not fused
    // where SPIR-V forbids it.
    bool sound = false;
    bool denormals = false;  // sums and products below 2^-126 keep their bits
    bool quotients = false;  // correctly rounded; denormal ones too, unless `denormals` is false
    bool roots = false;      // the same of square roots

    // Pictures have the same bits as on any other device of which this is true. Quotients and roots need not
    // be the device's own (shaders/arithmetic.glsl).
    bool sharesBits() const { return sound && denormals; }
    // One phrase about that, for people.
    std::string text() const;
};

// ---- private to src/gpu and its tests ----

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
