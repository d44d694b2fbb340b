// Would the suite notice? The same checks, on shaders with the defects that other ray tracers have.
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <set>
#include <string_view>

#include "../render/mutant_kernels.h"
#include "../render/support.h"
#include "checks.h"

namespace glint::stability::mutants_test {
using glm::dvec3;

class MutantsTest : public render::test::RenderTest {
  protected:
    Subject mutant(const std::string& name) const { return {&device(), name}; }
    Subject sound() const { return {&device(), {}}; }
    static void expectRed(const char* what, size_t green, size_t red) {
        std::cout << "[ measured ] " << what << ": " << red << " wrong, the sound shader " << green << '\n';
        EXPECT_EQ(green, 0u) << what;
        EXPECT_GT(red, 0u) << what;
    }
    size_t leaks(const Subject& subject, Aim aim) const {
        return countLeaks(subject, {Mesh::Bumpy, 1, 0}, aim, 30000, 801).leaks;
    }
};

// docs/lab/stability.md: 6.8 % of the rays at vertices, 10.5 % of those at edges; none at random.
TEST_F(MutantsTest, MollerTrumboreLeaks) {
    expectRed("rays at vertices", leaks(sound(), Aim::Vertices),
              leaks(mutant("moller_trumbore"), Aim::Vertices));
    expectRed("rays at edges", leaks(sound(), Aim::Edges), leaks(mutant("moller_trumbore"), Aim::Edges));
    EXPECT_EQ(leaks(mutant("moller_trumbore"), Aim::Anywhere), 0u) << "random rays would not have found it";
}

// docs/lab/stability.md: 0.9 % of the rays at edges, with all three edge functions contracted.
TEST_F(MutantsTest, ContractedProductsLeak) {
    expectRed("rays at edges", leaks(sound(), Aim::Edges), leaks(mutant("contracted"), Aim::Edges));
}

// Instructions that a driver might fuse or reorder, OpFAdd, OpFSub, OpFMul, OpFDiv and OpVectorTimesScalar,
// that do not carry the decoration NoContraction, in the functions that decide hits: those of intersect.glsl
// and the crossings of quadrics. Surfaces, textures (of holes) and bounds of errors may round as they like.
struct Contractible {
    size_t functions = 0;  // of those named above, found in the module
    size_t instructions = 0;
};

// As glslang writes it: "intersectBox(struct-Ray-vf3...".
bool decidesHits(const std::string& name) {
    for (const std::string_view start : {"intersect", "nearestRoot(", "crosses(", "shearedVertex(",
                                         "makeFrame(", "turnToZ(", "crossingsOf(", "firstSurface("}) {
        if (name.starts_with(start)) return true;
    }
    return false;
}

// A literal string ends with a zero byte; the first byte of a word is its lowest.
std::string textOf(std::span<const uint32_t> words) {
    return reinterpret_cast<const char*>(words.data());
}

// Khronos, SPIR-V Specification 1.3: section 2.3 (five header words; an instruction's first word holds its
// length and opcode), 3.20 (decoration 42 is NoContraction), 3.32 (opcodes).
Contractible withoutNoContraction(std::span<const uint32_t> module) {
    constexpr uint32_t kName = 5, kFunction = 54, kDecorate = 71, kNoContraction = 42;
    const std::set<uint32_t> arithmetic = {129, 131, 133, 136, 142};
    std::map<uint32_t, std::string> names;
    std::set<uint32_t> decorated, found;
    bool counted = false;
    Contractible result;
    for (size_t at = 5; at < module.size();) {
        const uint32_t length = module[at] >> 16, opcode = module[at] & 0xffffu;
        if (length == 0 || at + length > module.size()) break;
        if (opcode == kName) names[module[at + 1]] = textOf(module.subspan(at + 2, length - 2));
        if (opcode == kDecorate && length >= 3 && module[at + 2] == kNoContraction)
            decorated.insert(module[at + 1]);
        if (opcode == kFunction) {
            counted = decidesHits(names[module[at + 2]]);
            result.functions += counted;
        }
        if (counted && arithmetic.contains(opcode)) found.insert(module[at + 2]);
        at += length;
    }
    for (const uint32_t id : found) result.instructions += !decorated.contains(id);
    return result;
}

// No picture on lavapipe shows it, which contracts nothing: the decoration of the instructions does.
TEST_F(MutantsTest, DroppedPreciseIsSeenInTheCode) {
    const Contractible ours = withoutNoContraction(render::embeddedKernels().at(render::KernelId::Intersect));
    const Contractible broken =
        withoutNoContraction(render::test::mutantKernels("imprecise")[render::KernelId::Intersect]);
    EXPECT_GE(ours.functions, 10u) << "names are there, and have not changed";
    expectRed("instructions without NoContraction", ours.instructions, broken.instructions);
}

TEST_F(MutantsTest, NaiveDiscriminantMissesFarSpheres) {
    const auto wrong = [](const Subject& subject) {
        return judgeSpheres(subject, {1, 4100, 0, false}, 5000, 802).arithmetic.wrong();
    };
    expectRed("spheres from 4100 radii", wrong(sound()), wrong(mutant("naive_sphere")));
}

TEST_F(MutantsTest, NaiveQuadraticMissesFarQuadrics) {
    const QuadricFamily families[] = {{EllipsoidShape{dvec3(0), {1, 0.5, 0.2}}, dvec3(0), 1, 4100},
                                      {CylinderShape{{0, -2, 0}, {0, 2, 0}, 1}, dvec3(0), 1, 4100}};
    for (const QuadricFamily& family : families) {
        const auto wrong = [&](const Subject& subject) {
            const QuadricCount count = judgeQuadric(subject, family, 2000, 804);
            return count.wrong + count.beyond;
        };
        expectRed("quadrics from 4100 sizes", wrong(sound()), wrong(mutant("naive_quadric")));
    }
}

TEST_F(MutantsTest, UnpaddedBoxesAreMissed) {
    for (const double thickness : {0.01, 0.0}) {
        const auto missed = [&](const Subject& subject) {
            return judgeBoxes(subject, thickness, 0, false, 50000, 803).falseMisses;
        };
        expectRed("boxes", missed(sound()), missed(mutant("unpadded_boxes")));
    }
}

TEST_F(MutantsTest, FixedOffsetLeaksLight) {
    const auto lit = [](const Subject& subject) { return countLitUnderLid(subject, 1, 1e-5).wrong; };
    expectRed("gap of 1e-5", lit(sound()), lit(mutant("fixed_offset")));
}

// docs/lab/stability.md: half of all rays.
TEST_F(MutantsTest, RawHitPointsShadeThemselves) {
    for (const Kind kind : {Kind::Plane, Kind::Sphere, Kind::Mesh}) {
        const auto shaded = [&](const Subject& subject) {
            return countSelfShadowed(subject, kind, 0, 1, true).wrong;
        };
        expectRed("plane, sphere, mesh", shaded(sound()), shaded(mutant("raw_hit_point")));
    }
}

}  // namespace glint::stability::mutants_test
