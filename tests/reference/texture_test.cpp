// Textures in the reference: values worked out by hand from docs/reference/shading.md.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/material.h"
#include "support/packed_scene_maker.h"

namespace glint::reference::test::texture_test {
using namespace glint::test;

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

// A texture of `values` as red, rows from the top, and their 16th as alpha.
PackedScene textureScene(uint32_t width, std::initializer_list<float> values, uint32_t flags) {
    PackedScene scene;
    for (const float value : values) {
        shared::Texel texel;
        texel.color = glm::vec3(value, 0, 0);
        texel.alpha = value / 16;
        scene.texels.push_back(texel);
    }
    shared::Texture texture;
    texture.flags = flags;
    texture.width = width;
    texture.height = static_cast<uint32_t>(values.size()) / width;
    texture.scaleU = texture.scaleV = 1;
    scene.textures.push_back(texture);
    return scene;
}

PackedScene quadScene(uint32_t flags) {
    return textureScene(2, {1, 2, 3, 4}, flags);
}

dvec4 colorAt(const PackedScene& scene, const dvec2& uv) {
    const Model model = widened(scene);
    Surface surface;
    surface.uv = uv;
    return textureAt(model, model.textures[0], surface);
}

double redAt(const PackedScene& scene, double u, double v) {
    return colorAt(scene, {u, v}).x;
}

uint32_t wraps(uint32_t wrap) {
    return wrap | wrap << shared::kTextureWrapVShift;
}

// Texel centres are at 1/4 and 3/4; v is upwards, row 0 at the top.
TEST(Texture, BilinearOfTwoByTwo) {
    const PackedScene scene = quadScene(wraps(shared::kTextureWrapClamp));
    EXPECT_EQ(redAt(scene, 0.25, 0.75), 1);
    EXPECT_EQ(redAt(scene, 0.75, 0.75), 2);
    EXPECT_EQ(redAt(scene, 0.25, 0.25), 3);
    EXPECT_EQ(redAt(scene, 0.75, 0.25), 4);
    EXPECT_EQ(redAt(scene, 0.5, 0.5), 2.5);
    EXPECT_EQ(redAt(scene, 0.375, 0.75), 1.25);
    EXPECT_EQ(redAt(scene, 0.25, 0.375), 2.5);  // 3/4 of the way from 1 down to 3
    EXPECT_EQ(colorAt(scene, {0.5, 0.5}).w, 2.5 / 16);
}

TEST(Texture, NearestTakesTheTexelThatHoldsThePoint) {
    const PackedScene scene = quadScene(wraps(shared::kTextureWrapRepeat) | shared::kTextureNearest);
    EXPECT_EQ(redAt(scene, 0.49, 0.51), 1);
    EXPECT_EQ(redAt(scene, 0.51, 0.51), 2);
    EXPECT_EQ(redAt(scene, 0.49, 0.49), 3);
    EXPECT_EQ(redAt(scene, 0.5, 0.5), 2);  // a border belongs to what is right of it and above
    EXPECT_EQ(redAt(scene, 0, 0), 3);
    EXPECT_EQ(redAt(scene, 1, 1), 3);  // which is (0, 0)
    const PackedScene mirrored = quadScene(wraps(shared::kTextureWrapMirror) | shared::kTextureNearest);
    EXPECT_EQ(redAt(mirrored, 0.5, 0.5), 2);
    EXPECT_EQ(redAt(mirrored, 1.5, 1.5), 2);
    EXPECT_EQ(redAt(mirrored, -0.5, 0.5), 2);
    EXPECT_EQ(redAt(mirrored, 1, 1), 2);
    EXPECT_EQ(redAt(mirrored, 2, 2), 3);
}

TEST(Texture, WildCoordinatesAreHarmless) {
    const PackedScene scene = quadScene(wraps(shared::kTextureWrapRepeat));
    EXPECT_EQ(redAt(scene, 1e6 + 0.25, -1e6 + 0.75), 1);
    const double corner = redAt(scene, 0, 0);
    EXPECT_EQ(corner, 2.5);
    for (const double wild :
         {std::numeric_limits<double>::quiet_NaN(), 1e30, -1e30, std::numeric_limits<double>::infinity()})
        EXPECT_EQ(redAt(scene, wild, wild), corner) << wild;
}

// A map of 4 x 2 texels numbered by rows from the top; centres of columns at u = 1/8, 3/8, 5/8, 7/8.
TEST(Texture, EnvironmentDirections) {
    PackedScene scene =
        textureScene(4, {0, 1, 2, 3, 4, 5, 6, 7},
                     shared::kTextureWrapRepeat | shared::kTextureWrapClamp << shared::kTextureWrapVShift);
    scene.environment.map = 1;
    scene.environment.background = glm::vec3(2);
    const auto seen = [&](const dvec3& d) {
        const Model model = widened(scene);
        return surroundings(model, model.environment, d, dvec2(0)).x / 2;
    };
    // On the horizon the rows count half each: column c gives c + 2.
    EXPECT_NEAR(seen({0, 0, -1}), 1.5 + 2, 1e-12);  // u = 1/2: between columns 1 and 2
    EXPECT_NEAR(seen({1, 0, 0}), 2.5 + 2, 1e-12);   // u = 3/4
    EXPECT_NEAR(seen({-1, 0, 0}), 0.5 + 2, 1e-12);  // u = 1/4
    EXPECT_NEAR(seen({0, 0, 1}), 1.5 + 2, 1e-12);   // u = 0 or 1: between columns 3 and 0
    EXPECT_NEAR(seen({1, 0, -1}), 2 + 2, 1e-12);    // u = 5/8: column 2
    EXPECT_NEAR(seen({1e-9, 1, 1e-9}), 3, 1e-6);    // u = 7/8, straight up: column 3 of row 0
    EXPECT_NEAR(seen({1e-9, -1, -1e-9}), 2 + 4, 1e-6);
    scene.textures[0].place.x = 0.25f;  // a quarter turn counter-clockwise: what was along -z is along -x
    EXPECT_NEAR(seen({-1, 0, 0}), 1.5 + 2, 1e-12);
}

// Magnitudes that the coordinates sum, with half the way of 5 from the height of 5; on the axis, where the
// angle is any, half a turn in units of 2^-24.
TEST(Texture, CoordinatesAreAsUncertainAsTheirSums) {
    SceneMaker maker;
    maker.plane({0, 0, 0}, {0, 1, 0});
    PackedScene scene = maker.finish();
    shared::ObjectFrame frame;
    frame.toU = {5, 0, 0};
    frame.toV = {0, 4, 0};
    frame.toW = {0, 0, 5};
    frame.offsetU = -50;
    frame.offsetV = 0.5f;
    frame.offsetW = -35;
    scene.objectFrames.push_back(frame);
    const auto scaleAt = [&](uint32_t kind, const dvec3& place) {
        scene.objectFrames[0].uvKind = kind;
        const Tracer tracer(scene);
        const Ray ray = makeRay(place + dvec3(0, 5, 0), {0, -1, 0});
        return tracer.surfaceAt(ray, tracer.closest(ray).value()).uvScale;
    };
    EXPECT_EQ(scaleAt(shared::kUvFlat, {10, 0, 7}), dvec2(175, 20.5));
    EXPECT_EQ(scaleAt(shared::kUvAxial, {10, 0, 7}), dvec2(0x1p23, 20.5));
    EXPECT_NEAR(scaleAt(shared::kUvAxial, {11, 0, 7}).x, (187.5 + 122.5) / (2 * std::numbers::pi * 5), 1e-9);
    EXPECT_TRUE(std::isfinite(scaleAt(shared::kUvRound, {10, 0, 7}).y));
}

TEST(Texture, TriangleInterpolatesCoordinatesAndColors) {
    SceneMaker maker;
    maker.triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
    PackedScene scene = maker.finish();
    scene.vertexAttributes.resize(5);
    scene.vertexAttributes[0].value = {0.5f, 8.5f, 0.5f};  // u
    scene.vertexAttributes[1].value = {-1, -1, 15};        // v
    scene.vertexAttributes[2].value = {1, 0, 0};           // colours
    scene.vertexAttributes[3].value = {0, 1, 0};
    scene.vertexAttributes[4].value = {0, 0, 1};
    const Ray ray = makeRay({1, 2, 5}, {0, 0, -1});  // u = 1/4, v = 1/2
    const auto hit = Tracer(scene).closest(ray);
    ASSERT_TRUE(hit.has_value());
    const auto surface = [&] { return Tracer(scene).surfaceAt(ray, *hit); };
    EXPECT_EQ(surface().uv, dvec2(0.25, 0.5));
    EXPECT_EQ(surface().color, dvec3(1));
    scene.triangleSurfaces[0].attributes = shared::kAttributeUvs | shared::kAttributeColors;
    EXPECT_EQ(surface().uv, dvec2(2.5, 7));
    EXPECT_EQ(surface().uvScale, dvec2(2.5, 7)) << "by which verify moves them";
    EXPECT_EQ(surface().color, dvec3(0.25, 0.25, 0.5));
    scene.triangleSurfaces[0].attributes = shared::kAttributeColors | 2;
    EXPECT_EQ(surface().uv, dvec2(0.25, 0.5));
    EXPECT_EQ(surface().color, dvec3(0.25, 0.25, 0.5));
}

TEST(Texture, MaterialIsMultipliedWithTexturesAndVertexColors) {
    PackedScene scene = quadScene(wraps(shared::kTextureWrapClamp));
    shared::Material material;
    material.ambient = material.diffuse = material.specular = material.mirror = glm::vec3(0.5f);
    material.diffuseTexture = 1;
    material.mirrorTexture = 1;
    scene.materials.push_back(material);
    Surface surface;
    surface.uv = {0.25, 0.25};
    surface.color = {0.5, 1, 1};
    const rows::Material result = materialAt(widened(scene), surface);
    EXPECT_EQ(result.ambient, dvec3(0.25, 0.5, 0.5));
    EXPECT_EQ(result.diffuse, dvec3(0.75, 0, 0));
    EXPECT_EQ(result.specular, dvec3(0.5));
    EXPECT_EQ(result.mirror, dvec3(1.5, 0, 0));
    scene.materials[0].alphaCutoff = 0.18f;  // alpha there is 3/16 = 0.1875
    EXPECT_FALSE(holeAt(widened(scene), surface, {}));
    scene.materials[0].alphaCutoff = 0.19f;
    EXPECT_TRUE(holeAt(widened(scene), surface, {}));
}

// In the middle the alpha is 2.5/16. The coordinates err by 4.5 units, each of which moves 2 texels, of
// slopes 1/16 and 2/16. Without filtering the alpha, 3/16, is exact.
TEST(Texture, NoiseOpensMasksWithinTheirRounding) {
    PackedScene scene = quadScene(wraps(shared::kTextureWrapClamp));
    scene.materials.emplace_back().diffuseTexture = 1;
    const auto holesOf100 = [&](const dvec2& uv, double cutoff) {
        scene.materials[0].alphaCutoff = static_cast<float>(cutoff);
        const Model model = widened(scene);
        Surface surface;
        surface.uv = uv;
        int holes = 0;
        for (uint64_t seed = 1; seed <= 100; ++seed) holes += holeAt(model, surface, {seed, 0x1p-24});
        return holes;
    };
    constexpr double kError = (7 * 2.5 / 16 + 1 + 2 * 4.5 * 3 / 16) * 0x1p-24;
    EXPECT_EQ(holesOf100(dvec2(0.5), 2.5 / 16 - kError), 0);
    EXPECT_NEAR(holesOf100(dvec2(0.5), 2.5 / 16), 50, 30);
    EXPECT_EQ(holesOf100(dvec2(0.5), 2.5 / 16 + kError), 100);
    scene.textures[0].flags |= shared::kTextureNearest;
    EXPECT_EQ(holesOf100(dvec2(0.25), 3.0 / 16), 0);
}

// The checker's corner is 640 from the place 0 along the object's x axis, of which a local unit has 2.
TEST(Texture, SolidCheckersReachToTheirCorners) {
    Model model;
    model.materials.resize(2);
    model.materials[1].mirrorTexture = 1;
    model.textures.resize(1);
    model.textures[0].flags = shared::kTextureChecker | shared::kTextureSolid;
    model.textures[0].place = {-600, 3, 5};
    rows::ObjectFrame frame;
    frame.toObjectX = {0, 2, 0};
    frame.toObjectY = {0, 0, 4};
    frame.toObjectZ = {1, 0, 0};
    frame.offsetX = 40;
    model.objectFrames.push_back(frame);
    Surface surface;
    surface.scale = 7;
    EXPECT_EQ(solidReach(model, surface), 7);
    surface.material = 1;
    EXPECT_EQ(solidReach(model, surface), 320);
    model.textures[0].flags = shared::kTextureChecker;
    EXPECT_EQ(solidReach(model, surface), 7);
}

}  // namespace glint::reference::test::texture_test
