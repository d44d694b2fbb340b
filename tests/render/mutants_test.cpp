// Does verify find a defect in a shader? Each mutant of mutants.cmake has one; the shaders have none.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "import/load.h"
#include "mutant_kernels.h"
#include "pack/pack_samples.h"
#include "support.h"
#include "support/support.h"
#include "verify/verify.h"

namespace glint::render::test::mutants_test {
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

// A thousandth of the usual light: differences must not be measured against a full scale of 1.
const char* const kDimScene = R"({
  "camera": {"eye": [0, 1, 5], "target": [0, 0.5, 0], "fovY": 50}, "background": 0.0005,
  "ambient": 0.0001,
  "lights": [{"type": "directional", "direction": [-0.5, -1, -0.4], "intensity": 0.0009}],
  "objects": [{"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0]},
              {"type": "sphere", "center": [0, 0, 0], "radius": 1}]
})";

// A highlight so broad that a power's own error is most of what a pixel may err by.
const char* const kBroadScene = R"({
  "camera": {"eye": [0, 0, 6], "target": [0, 0, 0], "fovY": 45},
  "lights": [{"type": "directional", "direction": [-0.98, 0, -0.2]}],
  "materials": {"m": {"diffuse": 0, "specular": 1, "shininess": 1}},
  "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"}]
})";

struct Defect {
    const char* mutant;
    const char* scene;  // a name, or text
};

class MutantTest : public RenderTest, public testing::WithParamInterface<Defect> {
  protected:
    verify::Report run(const KernelCode& code) {
        const bool packets = std::string(GetParam().mutant).starts_with("packet_");
        verify::Options options;
        options.plainToo = false;  // the defect is not in its kernels
        return verified(case_, optionsWith(code, packets ? Traversal::Packet : Traversal::Lane), options);
    }
    const Case case_ = sceneCase(GetParam().scene, 48, 36);
};

// A quantity that the report of a mutant names.
const std::map<std::string, std::string_view> kWrongQuantities = {{"edge_sign", "path"},
                                                                  {"sphere_normal", "geometricNormal"},
                                                                  {"shadow_bits", "hiddenLights"},
                                                                  {"quadric_disc", "position"},
                                                                  {"instance_normal", "u"},
                                                                  {"narrow_box", "clearance"},
                                                                  {"late_checker", "color"},
                                                                  {"mirrored_alpha", "alpha"},
                                                                  {"blank_miss", "layers of a miss"}};

TEST_P(MutantTest, IsFound) {
    const verify::Report sound = run(embeddedKernels());
    EXPECT_TRUE(sound.passed()) << sound.unexplained << " unexplained";
    const verify::Report broken = run(mutantKernels(GetParam().mutant));
    EXPECT_FALSE(broken.passed());
    ASSERT_FALSE(broken.worst.empty());
    EXPECT_GT(broken.unexplained, 0u);
    EXPECT_EQ(broken.worst.front().reason, verify::Reason::Unexplained);
    const auto& names = broken.worst.front().quantities;
    EXPECT_FALSE(names.empty());
    const auto wrong = kWrongQuantities.find(GetParam().mutant);
    EXPECT_TRUE(wrong == kWrongQuantities.end() ||
                std::find(names.begin(), names.end(), wrong->second) != names.end());
}

INSTANTIATE_TEST_SUITE_P(
    All, MutantTest,
    testing::Values(
        Defect{"edge_sign", "triangles"}, Defect{"wrong_weight", "knot"}, Defect{"tie_rule", kDecalScene},
        Defect{"small_boxes", "knot"}, Defect{"sphere_normal", "spheres"}, Defect{"far_offset", "spheres"},
        Defect{"narrow_box", "spheres"}, Defect{"wide_box", "knot"}, Defect{"shadow_bits", kLampScene},
        Defect{"short_shadows", kLampScene}, Defect{"long_shadows", kLampScene}, Defect{"disc_rim", "discs"},
        Defect{"polygon_side", "polygons"}, Defect{"flipped_film", "orthographic"},
        Defect{"straight_penumbra", "spots"}, Defect{"wide_cone", "spots"},
        Defect{"diffuse_little", "spheres"}, Defect{"shininess_little", "spheres"},
        Defect{"no_light", kDimScene}, Defect{"power_little", kBroadScene},
        Defect{"rare_near_hit", "spheres"}, Defect{"mirror_sign", kMirrorScene},
        Defect{"wrong_fresnel", "glass"}, Defect{"no_nesting", "glass"}, Defect{"inner_first", "glass"},
        Defect{"one_way_beer", "glass"}, Defect{"texel_corner", "textures"},
        Defect{"upside_down", "textures"}, Defect{"late_checker", "checker"},
        Defect{"turned_sky", "environment"}, Defect{"deep_cut", "textures"}, Defect{"packet_bounds", "knot"},
        Defect{"packet_pair", "knot"}, Defect{"instance_normal", "instances"},
        Defect{"instance_ray", "instances"}, Defect{"quadric_disc", "quadrics"},
        Defect{"not_finite", "spheres"}, Defect{"mirrored_alpha", "spheres"},
        Defect{"blank_miss", "spheres"}),
    [](const auto& p) { return std::string(p.param.mutant); });

class VerdictTest : public RenderTest {
  protected:
    // `scene` has %s for the fovY: narrow views, in which single places show.
    static void expectExplained(const char* scene) {
        for (const char* fov : {"0.2", "0.00002"}) {
            char text[2000];
            std::snprintf(text, sizeof(text), scene, fov);
            const Case c = textCase(text, 64, 48);
            EXPECT_EQ(verified(c).unexplained, 0u) << fov;
        }
    }
};

// A wrong near hit must not widen its own excuse: none of those that a picture shows is explained.
TEST_F(VerdictTest, NoneOfTheWrongNearHitsIsExplained) {
    const Case c = fileCase("spheres", 320, 240);
    const verify::Report report = verified(c, optionsWith(mutantKernels("rare_near_hit")));
    EXPECT_GT(report.unexplained, 100u);
    EXPECT_EQ(report.explained(), 0u);
}

// Pictures without data may be drawn by a kernel of their own (whole.comp): one that is sound but for that
// must not pass, were it off by a last bit.
TEST_F(VerdictTest, WhatRenderDrawsIsVerified) {
    const Case c = fileCase("corridor", 64, 48);
    const KernelCode broken = mutantKernels("diffuse_whole");
    Options options = optionsWith(broken);
    options.wholePaths = WholePaths::On;
    const verify::Report report = verified(c, options);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_GT(report.plainDiffers, 100u);
    EXPECT_FALSE(report.passed());
}

// Samples may be right one by one, and their picture be wrong.
TEST_F(VerdictTest, TheSumOfSamplesIsVerified) {
    const struct {
        const char* mutant;
        bool adaptive;
    } defects[] = {{"first_sample_lost", false}, {"film_forgets", true}};
    for (const auto& [mutant, adaptive] : defects) {
        Scene scene = loadScene(glint::test::sourcePath("scenes/sampling.json"));
        scene.image.samplesPerPixel = 4;
        if (adaptive) scene.image.adaptive = AdaptiveSampling{32, 0.05};
        const Request samples = requestOf(scene.image, Camera{});
        const Case c = makeCase(scene, 64, 48);
        const KernelCode code = mutantKernels(mutant);
        for (const bool broken : {false, true}) {
            verify::Options options;
            options.samples = samples.samples;
            const verify::Report report =
                verified(c, optionsWith(broken ? code : embeddedKernels()), options);
            EXPECT_EQ(report.unexplained, 0u) << mutant;
            EXPECT_EQ(report.plainDiffers, 0u) << mutant;
            EXPECT_EQ(report.filmDiffers > 0, broken) << mutant << ' ' << report.filmDiffers;
            EXPECT_EQ(report.passed(), !broken) << mutant;
        }
    }
}

// Branches that are not followed leave no trace in a picture, but for the account that is given of them.
TEST_F(VerdictTest, TheAccountOfLostBranchesIsVerified) {
    const Case c = fileCase("glass", 48, 36);
    const KernelCode code = mutantKernels("lost_reason");
    for (const bool broken : {false, true}) {
        const verify::Report report = verified(c, optionsWith(broken ? code : embeddedKernels()));
        EXPECT_EQ(report.unexplained, 0u);
        EXPECT_EQ(report.lossesDiffer, broken);
        EXPECT_EQ(report.passed(), !broken);
    }
}

// At depth 0 a device has no code for mirrors, which the reference counts all the same.
TEST_F(VerdictTest, MirrorsWithoutDepthAreNoDifference) {
    const Case c = textCase(R"({
  "camera": {"eye": [0, 1, 5], "target": [0, 0, 0]}, "maxDepth": 0, "background": 0.3,
  "materials": {"mirror": {"diffuse": 0.5, "mirror": 0.5}}, "lights": [{"type": "directional", "direction": [-1, -1, -1]}],
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "mirror"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0]}]
})",
                            32, 24);
    EXPECT_TRUE(verified(c).passed());
}

// The verdict alone is the same and examines fewer pixels.
TEST_F(VerdictTest, TheVerdictAloneIsTheSame) {
    const Case c = fileCase("spheres", 64, 48);
    const KernelCode broken = mutantKernels("sphere_normal");
    for (const bool sound : {true, false}) {
        Renderer renderer(device(), c.packed, optionsWith(sound ? embeddedKernels() : broken));
        verify::Options options;
        options.verdictAlone = true;
        const verify::Report whole = verified(renderer, c), alone = verified(renderer, c, options);
        EXPECT_EQ(whole.passed(), sound);
        EXPECT_EQ(alone.passed(), sound);
        if (sound)
            EXPECT_EQ(whole.rmse, alone.rmse);
        else
            EXPECT_LT(alone.unexplained, whole.unexplained);
    }
}

// Of a ray through dark glass the device's throughput is 0, and the reference's 1e-112.
TEST_F(VerdictTest, LightTooWeakForFp32IsNoDefect) {
    const Case c = fileCase("../tests/mutation/scenes/glass_corner", 97, 73);
    const verify::Report report = verified(c);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_GT(report.edges, 26u);
}

// The verdict and its counts do not depend on the brightness of an image.
TEST_F(VerdictTest, ADarkerPictureGetsTheSameVerdict) {
    verify::Report reports[2];
    for (int dark = 0; dark < 2; ++dark) {
        Case c = fileCase("showcase", 96, 72);
        const float gain = dark == 1 ? 0x1p-10f : 1;
        for (shared::Light& light : c.packed.lights) light.intensity *= gain;
        c.packed.environment.ambient *= gain;
        c.packed.environment.background *= gain;
        reports[dark] = verified(c);
        EXPECT_TRUE(reports[dark].passed());
    }
    EXPECT_EQ(reports[0].explained(), reports[1].explained());
    EXPECT_EQ(reports[0].allowedExplained(), reports[1].allowedExplained());
    EXPECT_NEAR(reports[1].sensitivity.kappa / reports[0].sensitivity.kappa, 0x1p-10, 1e-6);
}

// What a textbook's test of spheres loses on a planet is explained pixel by pixel, but by far more of them
// than the reference predicts.
TEST_F(VerdictTest, ATextbooksSphereFailsWhereItLosesDigits) {
    const Case c = fileCase("stiff/bead_on_planet", 32, 24);
    verify::Options options;
    options.methods.spheres = SphereMethod::Algebraic;
    const verify::Report report = verified(c, {}, options);
    EXPECT_FALSE(report.passed());
    EXPECT_GT(report.edges + report.roundings, report.allowedExplained());
}

// Close-ups of limbs: of a sphere, an anchored one, a cylinder and a disc, a thousandth of a radian of each,
// straight, by a lens, and in a mirror.
TEST_F(VerdictTest, LimbsAreExplained) {
    const char* const kLimbs = R"({
  "camera": {"eye": [0, 0.3, 9], "target": [%s], "fovY": %s, "up": [0, 0, 1]%s}, "ambient": 0.2,
  "background": 0.3, "materials": {"mirror": {"diffuse": 0.1, "mirror": 0.8}},
  "lights": [{"type": "directional", "direction": [-0.5, -1, -0.4]}],
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1},
              {"type": "sphere", "center": [0, -1000001, 0], "radius": 1000000},
              {"type": "cylinder", "base": [2, -1, 0], "top": [2, 1, 0], "radius": 0.5},
              {"type": "disc", "center": [-3, 0, 0], "normal": [0.2, 0.1, 1], "radius": 0.7},
              {"type": "plane", "point": [0, 0, -8], "normal": [0, 0, 1], "material": "mirror"}]
})";
    const char* const targets[] = {"0.99383, 0, 0.111", "0, -1, -1500",  "1.5, 0, 0",
                                   "-2.3, 0, 0",        "0, 0.99, 0.12", "2.49, 0.2, 0.1"};
    uint64_t pixels = 0, explained = 0;
    for (const char* target : targets) {
        for (const char* fov : {"0.2", "0.00002"}) {
            for (const char* lens : {"", ", \"lensRadius\": 0.0001, \"focusDistance\": 9"}) {
                char text[2000];
                std::snprintf(text, sizeof(text), kLimbs, target, fov, lens);
                const Case c = textCase(text, 64, 48);
                const verify::Report report = verified(c);
                EXPECT_EQ(report.unexplained, 0u) << target << ' ' << fov << lens;
                pixels += report.pixels;
                explained += report.explained();
            }
        }
    }
    std::cout << "[ measured ] " << pixels << " rays at limbs, " << explained << " explained\n";
}

// Close-ups of the limbs of mirroring open pipes and balls, tilted at random. A line that touches within
// rounding had any t, its normal pointed inside, and the mirrored ray hit the limb again.
TEST_F(VerdictTest, LimbsOfTiltedMirrorsAreExplained) {
    Random random(17);
    const glm::dvec3 eye(0, 0.3, 9);
    uint64_t explained = 0;
    for (int i = 0; i < 10; ++i) {
        Scene scene = emptyScene();
        const uint32_t mirror = addMaterial(scene, Color(0.1), Color(0.8));
        const glm::dvec3 base = random.box(1.3), top = random.box(1.3);
        const double radius = random.uniform(0.1, 0.8);
        // In the plane across the axis the limb's point is at right angles to the way from the eye to it.
        glm::dvec3 axis = glm::normalize(top - base), middle = glm::mix(base, top, random.uniform(0.2, 0.8));
        if (i % 3 == 2) {
            axis = random.direction();
            middle = base;
            addSphere(scene, base, radius, mirror);
        } else {
            scene.objects.push_back({"", CylinderShape{base, top, radius, false}, mirror});
        }
        const glm::dvec3 away = eye - middle - glm::dot(eye - middle, axis) * axis;
        const double distance = glm::length(i % 3 == 2 ? eye - middle : away), share = radius / distance;
        const glm::dvec3 along = glm::normalize(i % 3 == 2 ? eye - middle : away);
        const glm::dvec3 aside = glm::normalize(glm::cross(axis, along));
        scene.camera.target = middle + radius * (share * along + std::sqrt(1 - share * share) * aside);
        scene.camera.eye = eye;
        addPlane(scene, {0, -2, 0}, {0, 1, 0});
        scene.background = Color(0.3);
        scene.lights = {DirectionalLight{{-0.5, -1, -0.4}, Color(1)}};
        for (const double fov : {0.01, 0.0001}) {
            scene.camera.fovY = fov;
            const Case c = makeCase(scene, 64, 48);
            const verify::Report report = verified(c);
            EXPECT_EQ(report.unexplained, 0u) << i << ' ' << fov;
            explained += report.explained();
        }
    }
    EXPECT_GT(explained, 0u) << "no limb was in sight";
}

TEST_F(VerdictTest, LinesThatTouchMirrorsAreExplained) {
    // A hyperboloid along its axis, at the rim of its neck: a line that touches is inside and leaves, though
    // its cosine there is 0, or what rounding makes of that.
    expectExplained(R"({
  "camera": {"eye": [5.70112813, 7.57115272, 2.66239029], "target": [6.53170993, 0.229669302, -0.405631071],
             "up": [0.650992, -0.228818, 0.723777], "fovY": %s}, "ambient": 0.2,
  "background": 0.3, "materials": {"mirror": {"diffuse": [0.6, 0.3, 0.2], "mirror": 0.5}}, "maxDepth": 3,
  "lights": [{"type": "directional", "direction": [-0.5, -1, -0.4], "intensity": 0.8}],
  "objects": [{"type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0]},
              {"type": "quadric", "bounds": [[4.5, -1.5, -1.5], [7.5, 1.5, 1.5]], "material": "mirror",
               "coefficients": [1.10881242, -0.415941881, 0.907129464, 0.234565467, -1.29594604, 0.418078848,
                                -13.305749, -1.4073928, -2.50847309, 39.417247]}]
})");
    // A pipe about (1, 1, 1), by lines along (1, 1, -1) that touch it: the cosine at the limb is smaller than
    // the last bits of the normal, which alone said which side shows.
    expectExplained(R"({
  "camera": {"eye": [-2.156314876, -1.307786739, 1.732050808], "target": [-0.4242640687, 0.4242640687, 0],
             "up": [0.3, 0.8, 0.1], "fovY": %s},
  "ambient": 0.2, "background": 0.3, "materials": {"mirror": {"diffuse": [0.6, 0.3, 0.2], "mirror": 0.5}},
  "maxDepth": 3, "lights": [{"type": "directional", "direction": [-0.5, -1, -0.4], "intensity": 0.8}],
  "objects": [{"type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0]},
              {"type": "cylinder", "base": [-0.5773502692, -0.5773502692, -0.5773502692],
               "top": [0.5773502692, 0.5773502692, 0.5773502692], "radius": 0.6, "material": "mirror"}]
})");
}

}  // namespace glint::render::test::mutants_test
