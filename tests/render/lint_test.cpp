// No kernel leaves arithmetic to the driver that could change a picture's bits
// (docs/design/reproducibility.md).
#include <map>
#include <set>

#include "core/device_layout.h"
#include "gpu/specialize.h"
#include "render/kernels.h"
#include "spirv_lint.h"
#include "support.h"

namespace glint::render::test::lint_test {
using Words = std::span<const uint32_t>;
using Found = std::set<std::string>;

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
        constexpr uint32_t kDecorate = 71, kSpecId = 1, kOutOfReach = 1000;
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
