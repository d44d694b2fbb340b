#include "spirv_lint.h"

#include <map>

namespace glint::render::test {
namespace {

// SPIR-V specification 1.3, sections 2.3 (layout), 3.20 (decorations) and 3.32 (instructions); extended
// instructions: GLSL.std.450 specification, section 2.
constexpr uint32_t kExtInst = 12, kTypeFloat = 22, kTypeVector = 23, kDecorate = 71;
constexpr uint32_t kRelaxedPrecision = 0, kNoContraction = 42;

bool isArithmetic(uint32_t op) {
    return op == 129 || op == 131 || op == 133 || op == 136 || (op >= 140 && op <= 148);
}

// OpQuantizeToF16; OpFDiv; OpFRem, OpFMod; all of matrices and OpDot. Not OpVectorTimesScalar, 142, which is
// products.
bool isVaried(uint32_t op) {
    return op == 116 || op == 136 || op == 140 || op == 141 || (op >= 143 && op <= 148);
}

// RoundEven, Trunc, FAbs, SAbs, FSign, SSign, Floor, Ceil, Fract; minima, maxima, clamps of all types; bits.
bool isExact(uint32_t instruction) {
    return (instruction >= 2 && instruction <= 10) || (instruction >= 37 && instruction <= 45) ||
           (instruction >= 73 && instruction <= 75);
}

}  // namespace

std::set<std::string> variedByDrivers(std::span<const uint32_t> module) {
    std::map<uint32_t, bool> isDouble;  // by type
    std::set<uint32_t> marked;
    std::set<std::string> found;
    for (size_t at = 5; at < module.size();) {
        const uint32_t length = module[at] >> 16, op = module[at] & 0xffffu;
        if (length == 0 || at + length > module.size()) return {"malformed"};
        const auto word = [&](uint32_t i) { return module[at + i]; };
        if (op == kTypeFloat) isDouble[word(1)] = word(2) == 64;
        if (op == kTypeVector) isDouble[word(1)] = isDouble[word(2)];
        if (op == kDecorate && word(2) == kNoContraction) marked.insert(word(1));
        if (op == kDecorate && word(2) == kRelaxedPrecision) found.insert("relaxed");
        if (isArithmetic(op) && !marked.contains(word(2))) found.insert("unmarked");
        if (isVaried(op) && !isDouble[word(1)]) found.insert("op " + std::to_string(op));
        if (op == kExtInst && !isExact(word(4)) && !isDouble[word(1)])
            found.insert("GLSL.std.450 " + std::to_string(word(4)));
        at += length;
    }
    return found;
}

}  // namespace glint::render::test
