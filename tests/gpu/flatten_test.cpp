// The renderer's kernels without calls and variables: valid, and nothing is left that need not be. That they
// draw the same is what every other test of pictures sees.
#include "gpu/flatten.h"

#include <set>

#include "gpu/specialize.h"
#include "gpu/spirv_code.h"
#include "specialized.h"
#include "twists_flat.spv.h"

namespace glint::gpu::flatten_test {
using namespace spirv;

struct Left {
    size_t calls = 0, variables = 0, instructions = 0, marks = 0;
};

Left leftIn(Words words) {
    Left left;
    const Code code = Code::read(words);
    for (const Instruction& i : code.globals)
        left.marks += opOf(i) == OpDecorate && i[2] == kDecorationNoContraction;
    for (const Function& function : code.functions) {
        for (const Block& block : function.blocks) {
            for (const Instruction& i : block.body) {
                ++left.instructions;
                left.calls += opOf(i) == OpFunctionCall;
                left.variables += opOf(i) == OpVariable;
            }
        }
    }
    return left;
}

bool isAsked(uint32_t id) {
    return id == 1 || id == 5;  // spheres and point lights
}

void expectValid(const std::vector<uint32_t>& constants) {
    const auto kernels = allKernels();
    for (size_t i = 0; i < kernels.size(); ++i)
        EXPECT_TRUE(isValid(flatten(specialize(kernels[i], constants)))) << "kernel " << i;
}

TEST(Flatten, KernelsStayValid) {
    expectValid(constantsWhere(isAsked));
}

TEST(FlattenSweep, KernelsWithAllFeaturesStayValid) {
    expectValid(constantsWhere([](uint32_t) { return true; }));
}

// One function with early returns is left, of a few lines, and its arguments.
TEST(Flatten, LeavesHardlyACallOrAVariable) {
    const auto kernels = allKernels();
    for (size_t i = 0; i < kernels.size(); ++i) {
        const std::vector<uint32_t> made = specialize(kernels[i], constantsWhere(isAsked));
        const Left before = leftIn(made), after = leftIn(flatten(made));
        EXPECT_LE(after.calls, before.calls / 10) << i;
        EXPECT_LE(after.variables, before.variables / 5) << i;
    }
}

TEST(Flatten, DoneTwiceChangesNothing) {
    const render::KernelCode& code = render::embeddedKernels();
    const std::vector<uint32_t> once =
        flatten(specialize(code[render::KernelId::Light], constantsWhere(isAsked)));
    const Left first = leftIn(once), second = leftIn(flatten(once));
    EXPECT_EQ(first.instructions, second.instructions);
    EXPECT_EQ(first.marks, second.marks);
}

size_t unmarkedSumsIn(Words words) {
    const Code code = Code::read(words);
    std::set<uint32_t> marked;
    for (const Instruction& i : code.globals)
        if (opOf(i) == OpDecorate && i[2] == kDecorationNoContraction) marked.insert(i[1]);
    constexpr uint32_t kFAdd = 129;
    size_t sums = 0;
    for (const Function& function : code.functions)
        for (const Block& block : function.blocks)
            for (const Instruction& i : block.body) sums += opOf(i) == kFAdd && !marked.contains(i[2]);
    return sums;
}

// Also in copies of functions.
TEST(Flatten, MarksAllFloatArithmetic) {
    const std::vector<uint32_t> made =
        specialize(render::embeddedKernels()[render::KernelId::Light], constantsWhere(isAsked));
    EXPECT_GT(unmarkedSumsIn(made), 0u);
    EXPECT_EQ(unmarkedSumsIn(flatten(made)), 0u);
}

TEST(Flatten, FunctionsThatReturnEarlyStay) {
    const std::vector<uint32_t> made = flatten(twists_flat_spv);
    EXPECT_TRUE(isValid(made));
    const Left left = leftIn(made);
    EXPECT_EQ(left.calls, 1u);
    // What that one is given, its own trips that ends with it, and the table.
    EXPECT_LE(left.variables, 5u);
}

TEST(Flatten, RefusesWhatIsNoModule) {
    EXPECT_THROW(flatten({}), std::invalid_argument);
}

}  // namespace glint::gpu::flatten_test
