// No kernel leaves arithmetic to the driver that could change a picture's bits
// (docs/design/reproducibility.md).
#include <map>
#include <set>

#include "core/device_layout.h"
#include "gpu/specialize.h"
#include "render/kernels.h"
#include "support.h"

namespace glint::render::test::lint_test {
using Words = std::span<const uint32_t>;
using Found = std::set<std::string>;

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

// The kinds of instruction in a module that leave bits of an image to the driver:
//   "unmarked"         arithmetic of floats without NoContraction: it may be fused or reordered
//   "relaxed"          a result that may be computed in 16 bits
//   "op 136" ...       by number, an instruction that need not be correctly rounded: OpFDiv, OpFRem, OpFMod,
//                      products of matrices, OpDot, OpOuterProduct, OpQuantizeToF16
//   "GLSL.std.450 26"  an extended instruction (here Pow) of that kind
// Doubles do not count: the kernels for `glint report` have them.
Found variedByDrivers(Words module) {
    std::map<uint32_t, bool> isDouble;  // by type
    std::set<uint32_t> marked;
    Found found;
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

std::vector<std::pair<std::string, Words>> allKernels() {
    std::vector<std::pair<std::string, Words>> all;
    for (const KernelId id : kKernels) all.emplace_back(infoOf(id).name, embeddedKernels().at(id));
    return all;
}

// As a driver is given it, but for every scene at once: the constants of the arithmetic alone are set, so
// that no feature, mode or choice leaves anything out.
std::vector<uint32_t> forDriver(Words kernel, bool own) {
    const std::map<uint32_t, uint32_t> places = {
#define GLINT_PLACE(ID, NAME, field) {ID, ID - 80},
        GLINT_ARITHMETIC(GLINT_PLACE)
#undef GLINT_PLACE
    };
    std::vector<uint32_t> words(kernel.begin(), kernel.end());
    size_t found = 0;
    for (size_t at = 5; at < words.size(); at += words[at] >> 16) {
        constexpr uint32_t kSpecId = 1, kOutOfReach = 1000;
        if ((words[at] & 0xffffu) != kDecorate || words[at + 2] != kSpecId) continue;
        const auto place = places.find(words[at + 3]);
        found += place != places.end();
        words[at + 3] = place != places.end() ? place->second : words[at + 3] + kOutOfReach;
    }
    EXPECT_GE(found, 1u);  // a kernel without roots has lost their constant
    const std::vector<uint32_t> constants(places.size(), own ? 1u : 0u);
    return gpu::specialize(words, constants);
}

TEST(Lint, NoKernelLeavesBitsToTheDriver) {
    size_t checked = 0;
    for (const auto& [name, words] : allKernels()) {
        EXPECT_EQ(variedByDrivers(forDriver(words, true)), Found{}) << name;
        ++checked;
    }
    EXPECT_EQ(checked, kKernels.size());
}

// Where the device's own quotients and roots are used they are all that varies: OpFDiv, Sqrt.
TEST(Lint, QuotientsAndRootsAreAllThatADeviceMayDo) {
    for (const auto& [name, words] : allKernels()) {
        for (const std::string& one : variedByDrivers(forDriver(words, false)))
            EXPECT_TRUE(one == "op 136" || one == "GLSL.std.450 31") << name << ": " << one;
    }
}

// specialize() adds the marks: before it, every kernel has sums without a mark.
TEST(Lint, ThereIsArithmeticToMark) {
    for (const auto& [name, words] : allKernels())
        EXPECT_TRUE(variedByDrivers(words).contains("unmarked")) << name;
}

}  // namespace glint::render::test::lint_test
