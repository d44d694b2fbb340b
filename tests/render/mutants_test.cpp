// Does verify find a defect in a shader? Each mutant of mutants.cmake has one; the shaders themselves have
// none.
#include <filesystem>
#include <regex>

#include "mutant_kernels.h"
#include "support.h"
#include "support/support.h"
#include "verify/verify.h"

namespace glint::render::test::mutants_test {
namespace {

// The sphere nearer to the light than to the floor casts the one shadow, the sphere above the light none.
const char* const kLampScene = R"({
  "camera": {"eye": [0, 3, 7], "target": [0, 1, 0], "fovY": 50},
  "ambient": 0.1,
  "lights": [{"type": "point", "position": [0, 3, 0]}],
  "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]},
              {"type": "sphere", "center": [0.3, 2.5, 0.2], "radius": 0.25},
              {"type": "sphere", "center": [-0.6, 4.5, 0.4], "radius": 0.6}]
})";

// A triangle twice, in two colours: the first one shows.
const char* const kDecalScene = R"({
  "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]},
  "ambient": 1, "materials": {"red": {"diffuse": [0.8, 0.1, 0.1]}, "blue": {"diffuse": [0.1, 0.1, 0.8]}},
  "objects": [{"type": "triangle", "vertices": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], "material": "red"},
              {"type": "triangle", "vertices": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], "material": "blue"}]
})";

// A smooth mirror: the curved reflection differs from that of its facets.
const char* const kMirrorScene = R"({
  "camera": {"eye": [0, 0.5, 9], "target": [0, 0, 0], "fovY": 42}, "background": [0.2, 0.4, 0.9],
  "ambient": 1, "materials": {"m": {"diffuse": 0, "mirror": 0.9}},
  "meshes": {"knot": {"file": "meshes/knot.obj"}},
  "objects": [{"type": "mesh", "mesh": "knot", "material": "m"},
              {"type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0]}]
})";

// Not one pixel of it is unexplained: under jitter the reference, too, takes either of two coincident
// surfaces for the first. What convicts the shader is the share of pixels that hang on rounding.
constexpr const char* kTieRule = "tie_rule";

struct Defect {
    const char* mutant;
    const char* scene;  // a name, or text
};

Case caseOf(const Defect& defect) {
    constexpr int kWidth = 48, kHeight = 36;
    return *defect.scene == '{' ? textCase(defect.scene, kWidth, kHeight)
                                : fileCase(defect.scene, kWidth, kHeight);
}

class MutantTest : public RenderTest, public testing::WithParamInterface<Defect> {
  protected:
    verify::Report run(const KernelCode& code) {
        Options options;
        options.access = gpu::Access::TexelBuffer;
        options.kernels = &code;
        options.traversal = Traversal::Lane;
        const std::string mutant = GetParam().mutant;
        if (mutant.starts_with("packet_")) options.traversal = Traversal::Packet;
        Renderer renderer(device(), case_.packed, options);
        verifyOptions_.width = case_.width;
        verifyOptions_.height = case_.height;
        return verify::verify(renderer, case_.packed, case_.camera, verifyOptions_);
    }
    const Case case_ = caseOf(GetParam());
    verify::Options verifyOptions_;
};

TEST_P(MutantTest, IsFound) {
    const verify::Report sound = run(embeddedKernels(gpu::Access::TexelBuffer));
    EXPECT_TRUE(sound.passed(verifyOptions_)) << sound.unexplained << " unexplained";
    const verify::Report broken = run(mutantKernels(GetParam().mutant));
    EXPECT_FALSE(broken.passed(verifyOptions_));
    ASSERT_FALSE(broken.worst.empty());
    if (GetParam().mutant == kTieRule) {
        EXPECT_GT(static_cast<double>(broken.ties),
                  verifyOptions_.maxExplainedShare * static_cast<double>(broken.pixels));
        EXPECT_EQ(broken.worst.front().reason, verify::Reason::Tie);
    } else {
        EXPECT_GT(broken.unexplained, 0u);
        EXPECT_EQ(broken.worst.front().reason, verify::Reason::Unexplained);
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, MutantTest,
    testing::Values(
        Defect{"edge_sign", "triangles"}, Defect{"wrong_weight", "knot"}, Defect{kTieRule, kDecalScene},
        Defect{"small_boxes", "knot"}, Defect{"sphere_normal", "spheres"}, Defect{"far_offset", "spheres"},
        Defect{"short_shadows", kLampScene}, Defect{"long_shadows", kLampScene}, Defect{"disc_rim", "discs"},
        Defect{"polygon_side", "polygons"}, Defect{"flipped_film", "orthographic"},
        Defect{"straight_penumbra", "spots"}, Defect{"wide_cone", "spots"}, Defect{"diffuse_gain", "spheres"},
        Defect{"mirror_sign", kMirrorScene}, Defect{"wrong_fresnel", "glass"}, Defect{"no_nesting", "glass"},
        Defect{"inner_first", "glass"}, Defect{"one_way_beer", "glass"}, Defect{"texel_corner", "textures"},
        Defect{"upside_down", "textures"}, Defect{"late_checker", "checker"},
        Defect{"turned_sky", "environment"}, Defect{"deep_cut", "textures"}, Defect{"packet_bounds", "knot"},
        Defect{"packet_pair", "knot"}, Defect{"instance_normal", "instances"},
        Defect{"instance_ray", "instances"}, Defect{"quadric_disc", "quadrics"},
        Defect{"not_finite", "spheres"}),
    [](const auto& p) { return std::string(p.param.mutant); });

// Each mutant costs a compilation; one that no test runs convicts nobody.
TEST(Mutants, EveryOneIsRunByATest) {
    std::string sources;
    for (const std::string folder : {"tests/render", "tests/stability"})
        for (const auto& entry : std::filesystem::directory_iterator(glint::test::sourcePath(folder)))
            if (entry.path().extension() == ".cpp") sources += glint::test::readText(entry.path());
    size_t mutants = 0;
    for (const std::string list : {"tests/render/mutants.cmake", "tests/stability/mutants.cmake"}) {
        const std::string text = glint::test::readText(glint::test::sourcePath(list));
        const std::regex definition(R"((^|\n)mutant\((\w+)[ \n])");
        for (std::sregex_iterator at(text.begin(), text.end(), definition), end; at != end; ++at, ++mutants)
            EXPECT_NE(sources.find("\"" + (*at)[2].str() + "\""), std::string::npos)
                << (*at)[2] << " of " << list << " is run by no test";
    }
    EXPECT_GT(mutants, 40u);
}

}  // namespace
}  // namespace glint::render::test::mutants_test
