// The renderer's kernels with values for their constants: valid, without those constants, calls and
// variables, and smaller the less a scene needs. Every test of images shows that they compute the same.
#include "gpu/specialize.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>

#include "core/device_layout.h"
#include "once.spv.h"
#include "render/kernels.h"
#include "support/support.h"
#include "twists_flat.spv.h"

namespace glint::gpu::specialize_test {
using namespace spirv;
using render::KernelId;

constexpr uint32_t kIds = 85;

std::vector<uint32_t> constantsWhere(auto isOn) {
    std::vector<uint32_t> constants(kIds, 0);
    // 70, 71, 77 and 78 choose among methods.
    for (uint32_t id = 0; id < kIds; ++id)
        if (id < 70 || (id > 71 && id != 77 && id != 78)) constants[id] = isOn(id) ? 1 : 0;
    return constants;
}

bool isSphereOrPointLight(uint32_t id) {
    return id == 1 || id == 5;
}

bool isValid(const std::vector<uint32_t>& words) {
    const glint::test::TemporaryFolder folder;
    const auto path =
        folder.write("kernel.spv", {reinterpret_cast<const char*>(words.data()), 4 * words.size()});
    return std::system((GLINT_SPIRV_VAL " --target-env vulkan1.1 " + path.string()).c_str()) == 0;
}

Words kernel(KernelId id) {
    return render::embeddedKernels().at(id);
}

struct Counts {
    size_t constants = 0, calls = 0, variables = 0, instructions = 0, unmarkedSums = 0;
    std::multiset<uint32_t> bindings;
    bool shuffles = false;  // as a capability
};

Counts countsIn(Words words) {
    constexpr uint32_t kBinding = 33, kFAdd = 129;
    Counts counts;
    std::set<uint32_t> marked;
    const Code code = Code::read(words);
    for (const Instruction& i : code.globals) {
        if (opOf(i) == OpCapability) counts.shuffles |= i[1] == kCapabilityGroupNonUniformShuffle;
        if (opOf(i) != OpDecorate) continue;
        counts.constants += i[2] == kDecorationSpecId;
        if (i[2] == kDecorationNoContraction) marked.insert(i[1]);
        if (i[2] == kBinding) counts.bindings.insert(i[3]);
    }
    eachInstruction(code.functions, [&](const Instruction& i) {
        ++counts.instructions;
        counts.calls += opOf(i) == OpFunctionCall;
        counts.variables += opOf(i) == OpVariable;
        counts.unmarkedSums += opOf(i) == kFAdd && !marked.contains(i[2]);
    });
    return counts;
}

void expectGood(const std::vector<uint32_t>& constants) {
    for (const KernelId id : render::kKernels) {
        const std::vector<uint32_t> made = specialize(kernel(id), constants);
        EXPECT_EQ(countsIn(made).constants, 0u) << infoOf(id).name;
        EXPECT_EQ(countsIn(made).unmarkedSums, 0u) << infoOf(id).name;
        EXPECT_TRUE(isValid(made)) << infoOf(id).name;
    }
}

TEST(Specialize, NoFeature) {
    expectGood(constantsWhere([](uint32_t) { return false; }));
}

TEST(Specialize, AnyChoiceOfFeatures) {
    std::mt19937 dice(5);
    expectGood(constantsWhere([&](uint32_t) { return dice() % 2 == 0; }));
}

TEST(SpecializeSweep, AllFeatures) {
    expectGood(constantsWhere([](uint32_t) { return true; }));
}

// One function with early returns remains, of a few lines, and its arguments.
TEST(Specialize, LeavesOutWhatIsNotNeeded) {
    for (const KernelId id : render::kKernels) {
        const Counts before = countsIn(kernel(id));
        const Counts after = countsIn(specialize(kernel(id), constantsWhere(isSphereOrPointLight)));
        EXPECT_LT(after.instructions, before.instructions) << infoOf(id).name;
        EXPECT_LE(after.calls, before.calls / 10) << infoOf(id).name;
        EXPECT_LE(after.variables, before.variables / 5) << infoOf(id).name;
    }
}

TEST(Specialize, MarksArithmeticThatGlslLeavesToTheDriver) {
    EXPECT_GT(countsIn(kernel(KernelId::Light)).unmarkedSums, 0u);
}

// A device whose subgroups do not shuffle rejects a module with that capability.
TEST(Specialize, LeavesOutShufflesWithWhatTheyNeed) {
    constexpr uint32_t kConvergent = 83;
    const auto shuffles = [](KernelId id, auto isOn) {
        return countsIn(specialize(kernel(id), constantsWhere(isOn))).shuffles;
    };
    const auto none = [](uint32_t) { return false; };
    for (const KernelId id :
         {KernelId::Intersect, KernelId::IntersectAny, KernelId::Light, KernelId::Whole}) {
        EXPECT_FALSE(shuffles(id, none));
        EXPECT_TRUE(shuffles(id, [](uint32_t constant) { return constant == kConvergent; }));
    }
    EXPECT_TRUE(shuffles(KernelId::PacketIntersect, none));
}

// Pairs of set and binding are unique among the variables that the driver gets: one way to load is left.
TEST(Specialize, LeavesOneVariableForABinding) {
    for (const bool together : {false, true}) {
        for (const KernelId id : render::kKernels) {
            std::mt19937 dice(7);
            const auto isOn = [&](uint32_t constant) {
                return constant == GLINT_ARRAYS_TOGETHER ? together : dice() % 2 == 0;
            };
            const auto bindings = countsIn(specialize(kernel(id), constantsWhere(isOn))).bindings;
            EXPECT_EQ(std::set<uint32_t>(bindings.begin(), bindings.end()).size(), bindings.size());
            EXPECT_GE(bindings.size(), 2u);
            if (together) {
                EXPECT_LT(*bindings.rbegin(), uint32_t{GLINT_FEW_BINDINGS});
            }
        }
    }
}

TEST(Specialize, KeepsConstantsThatItHasNoValueFor) {
    const std::vector<uint32_t> made = specialize(once_spv, {});
    EXPECT_EQ(countsIn(made).constants, 1u);
    EXPECT_TRUE(isValid(made));
}

// Without its way back a loop is none, and the module invalid.
TEST(Specialize, ALoopThatAConstantEndsKeepsItsForm) {
    for (const uint32_t goesOn : {0u, 1u}) {
        const std::vector<uint32_t> made = specialize(once_spv, std::vector<uint32_t>{goesOn});
        EXPECT_EQ(countsIn(made).constants, 0u);
        EXPECT_TRUE(isValid(made)) << goesOn;
    }
}

TEST(Specialize, FunctionsThatReturnEarlyStay) {
    const std::vector<uint32_t> made = specialize(twists_flat_spv, {});
    EXPECT_TRUE(isValid(made));
    EXPECT_EQ(countsIn(made).calls, 1u);
    // The arguments of the remaining call, its local variables, and the table.
    EXPECT_LE(countsIn(made).variables, 5u);
}

TEST(Specialize, RefusesWhatIsNoModule) {
    EXPECT_THROW(specialize({}, {}), std::invalid_argument);
    const std::vector<uint32_t> text(8, 0x20202020), cut{0x07230203, 0x10300, 0, 1, 0, 0x00050047, 1};
    EXPECT_THROW(specialize(text, {}), std::invalid_argument);
    EXPECT_THROW(specialize(cut, {}), std::invalid_argument);
}

}  // namespace glint::gpu::specialize_test
