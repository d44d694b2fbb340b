// The renderer's kernels with their constants put in: valid, free of those constants, and smaller the less a
// scene needs. That they draw the same is what every other test of pictures sees.
#include "gpu/specialize.h"

#include <random>
#include <set>

#include "core/device_layout.h"
#include "once.spv.h"
#include "specialized.h"

namespace glint::gpu::specialize_test {
constexpr uint32_t kOpDecorate = 71, kSpecId = 1;

size_t specIdsIn(std::span<const uint32_t> words) {
    size_t found = 0;
    for (size_t at = 5; at < words.size(); at += words[at] >> 16)
        if ((words[at] & 0xffff) == kOpDecorate && words[at + 2] == kSpecId) ++found;
    return found;
}

void expectGood(const std::vector<uint32_t>& constants, const std::string& what) {
    const auto kernels = allKernels();
    for (size_t i = 0; i < kernels.size(); ++i) {
        const std::vector<uint32_t> made = specialize(kernels[i], constants);
        EXPECT_EQ(specIdsIn(made), 0u) << what << ", kernel " << i;
        EXPECT_LE(made.size(), kernels[i].size()) << what << ", kernel " << i;
        EXPECT_TRUE(isValid(made)) << what << ", kernel " << i;
        EXPECT_EQ(specialize(made, constants), made) << "done twice, " << what << ", kernel " << i;
    }
}

TEST(Specialize, AnyChoiceOfFeatures) {
    expectGood(constantsWhere([](uint32_t) { return true; }), "all");
    expectGood(constantsWhere([](uint32_t) { return false; }), "none");
    std::mt19937 dice(5);
    expectGood(constantsWhere([&](uint32_t) { return dice() % 2 == 0; }), "any choice");
}

TEST(Specialize, LeavesOutWhatIsNotNeeded) {
    const render::KernelCode& code = render::embeddedKernels();
    const auto all = specialize(code[render::KernelId::Light], constantsWhere([](uint32_t) { return true; }));
    const auto spheres = specialize(code[render::KernelId::Light],
                                    constantsWhere([](uint32_t id) { return id == 1 || id == 5; }));
    EXPECT_LT(spheres.size(), all.size() / 2) << "spheres and point lights against everything";
}

bool mayShuffle(std::span<const uint32_t> words) {
    constexpr uint32_t kOpCapability = 17, kShuffle = 65;
    for (size_t at = 5; at < words.size(); at += words[at] >> 16)
        if ((words[at] & 0xffff) == kOpCapability && words[at + 1] == kShuffle) return true;
    return false;
}

// A device whose subgroups do not shuffle takes no module that says it may.
TEST(Specialize, LeavesOutShufflesWithWhatTheyNeed) {
    constexpr uint32_t kConvergent = 83;
    const render::KernelCode& code = render::embeddedKernels();
    for (const auto& kernel : {code[render::KernelId::Intersect], code[render::KernelId::IntersectAny],
                               code[render::KernelId::Light], code[render::KernelId::Whole]}) {
        EXPECT_TRUE(mayShuffle(kernel));
        EXPECT_FALSE(mayShuffle(specialize(kernel, constantsWhere([](uint32_t) { return false; }))));
        EXPECT_TRUE(
            mayShuffle(specialize(kernel, constantsWhere([](uint32_t id) { return id == kConvergent; }))));
    }
    EXPECT_TRUE(mayShuffle(
        specialize(code[render::KernelId::PacketIntersect], constantsWhere([](uint32_t) { return false; }))));
}

// Pairs of set and binding are unique among the variables that a driver sees: one way to load is left.
TEST(Specialize, LeavesOneVariableForABinding) {
    constexpr uint32_t kBinding = 33;
    for (const bool together : {false, true}) {
        for (const auto& kernel : allKernels()) {
            const auto made = specialize(
                kernel, constantsWhere([&](uint32_t id) { return id != GLINT_ARRAYS_TOGETHER || together; }));
            std::set<uint32_t> bindings;
            for (size_t at = 5; at < made.size(); at += made[at] >> 16) {
                if ((made[at] & 0xffff) != kOpDecorate || made[at + 2] != kBinding) continue;
                EXPECT_TRUE(bindings.insert(made[at + 3]).second) << made[at + 3];
                if (together) {
                    EXPECT_LT(made[at + 3], uint32_t{GLINT_FEW_BINDINGS});
                }
            }
            EXPECT_GE(bindings.size(), 2u);
        }
    }
}

TEST(Specialize, KeepsConstantsThatItHasNoValueFor) {
    const render::KernelCode& code = render::embeddedKernels();
    const auto made = specialize(code[render::KernelId::Light], {});
    EXPECT_EQ(specIdsIn(made), specIdsIn(code[render::KernelId::Light]));
    EXPECT_TRUE(isValid(made));
}

// Without its way back a loop is none, and the module invalid.
TEST(Specialize, ALoopThatAConstantEndsKeepsItsForm) {
    for (const uint32_t goesOn : {0u, 1u}) {
        const std::vector<uint32_t> made = specialize(once_spv, std::vector<uint32_t>{goesOn});
        EXPECT_EQ(specIdsIn(made), 0u);
        EXPECT_TRUE(isValid(made)) << goesOn;
    }
}

TEST(Specialize, RefusesWhatIsNoModule) {
    EXPECT_THROW(specialize({}, {}), std::invalid_argument);
    const std::vector<uint32_t> text(8, 0x20202020), cut{0x07230203, 0x10300, 0, 1, 0, 0x00050047, 1};
    EXPECT_THROW(specialize(text, {}), std::invalid_argument);
    EXPECT_THROW(specialize(cut, {}), std::invalid_argument);
}

}  // namespace glint::gpu::specialize_test
