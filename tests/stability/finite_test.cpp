// No image holds NaN or infinity, for any scene; overflow is counted and reported.
#include <gtest/gtest.h>

#include <cmath>

#include "../render/support.h"

namespace glint::stability::finite_test {
using namespace render::test;

class FiniteTest : public RenderTest {};

// T92, T94, T83 and the ends of the ranges of src/scene/limits.h: a ball that rests on the ground.
TEST_F(FiniteTest, TheEndsOfTheRanges) {
    const struct {
        const char *material, *lights, *camera = R"("eye": [0, 0.5, 3], "target": [0, 0.5, 0])";
    } rows[] = {
        // As bright as may be, alone and beside the faintest.
        {R"("specular": 1, "shininess": 50)", R"({"type": "point", "position": [2, 3, 4], "intensity": 1e18},
            {"type": "directional", "direction": [0, -1, 0], "intensity": 1e-18})"},
        // Light 1e8, ambient 1e-3 (T94).
        {R"("ambient": 1e-3, "specular": 1e3, "shininess": 2)",
         R"({"type": "point", "position": [2, 3, 4], "intensity": 1e8})"},
        // Exponents 0 and 1e18 (T92).
        {R"("specular": 1, "shininess": 0)", R"({"type": "point", "position": [2, 3, 4]})"},
        {R"("specular": 1, "shininess": 1e18)", R"({"type": "point", "position": [0, 0.5, 3]})"},
        // A light in the eye, on a surface, in the middle of the ball; behind the ball the half vector is 0.
        {R"("specular": 1, "shininess": 9)", R"({"type": "point", "position": [0, 0.5, 3]},
            {"type": "point", "position": [0, 0.5, 0.5], "falloff": "inverseSquare"}, {"type": "point", "position": [0, 0.5, 0]},
            {"type": "point", "position": [0, 0, 2], "falloff": "inverseSquare"}, {"type": "directional", "direction": [0, 0, 1]})"},
        // The ball's contact point (T83).
        {R"("mirror": 0.5)", R"({"type": "point", "position": [1, 3, 2]})",
         R"("eye": [0, 0.0001, 0.01], "target": [0, 0, 0])"},
    };
    for (const auto& row : rows) {
        const std::string text = std::string(R"({"ambient": 0.1, "camera": {)") + row.camera +
                                 R"(}, "materials": {"m": {)" + row.material + R"(}}, "lights": [)" +
                                 row.lights + R"(],
            "objects": [{"type": "sphere", "center": [0, 0.5, 0], "radius": 0.5, "material": "m"},
                        {"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "m"}]})";
        const Case c = textCase(text, 64, 48);
        const Picture picture = draw(device(), c);
        EXPECT_EQ(picture.notFinite, 0u) << text;
        EXPECT_EQ(picture.firstNotFinite, glm::ivec2(-1));
        EXPECT_GT(pixelsWithObject(picture), 64u * 48u / 4);
    }
}

// Vertex normals of no length, or that cancel: the geometric one takes their place.
TEST_F(FiniteTest, VertexNormalsOfNoLength) {
    for (const glm::dvec3& second : {glm::dvec3(0), glm::dvec3(0, 0, -1)}) {
        Scene scene = emptyScene();
        auto mesh = std::make_shared<glint::Mesh>();
        mesh->positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
        mesh->normals = {second == glm::dvec3(0) ? second : glm::dvec3(0, 0, 1), second, glm::dvec3(0)};
        mesh->corners = {{0, 1, 2}};
        mesh->normalCorners = {{0, 1, 2}};
        scene.objects.push_back({"mesh", MeshShape{mesh}, 0});
        scene.camera.eye = {0, 0, 3};
        scene.lights.push_back(PointLight{{1, 1, 3}, Color(1)});
        const Picture picture = draw(device(), makeCase(scene, 33, 33));
        EXPECT_EQ(picture.notFinite, 0u);
        for (const PixelData& data : picture.data) {
            if (data.object == 0) {
                EXPECT_NEAR(glm::length(data.normal), 1, 1e-6);
            }
        }
    }
}

// 1e18 / (1e-11)^2 is more than fp32 holds, and times the green of a red floor it is no number. The count and
// the place are those of the pixels of the picture, which slices must not change.
TEST_F(FiniteTest, TooMuchIsCountedAndNamed) {
    const Case c = textCase(R"({"ambient": 0.25, "materials": {"red": {"ambient": 1, "diffuse": [0.5, 0, 0]}},
        "camera": {"eye": [0, 0, 1e-10], "target": [0, 0, 0], "up": [0, 1, 0], "fovY": 60},
        "lights": [{"type": "point", "position": [0, 0, 1e-11], "intensity": 1e18, "falloff": "inverseSquare"}],
        "objects": [{"type": "disc", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1, "material": "red"}]})",
                            40, 30);
    Picture picture = draw(device(), c);
    uint64_t count = 0;
    glm::ivec2 first(-1);
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
            const float* p = &picture.color.pixels[static_cast<size_t>(4) * (y * 40 + x)];
            if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) continue;
            if (count++ == 0) first = {x, y};
        }
    }
    EXPECT_GT(count, 10u);
    EXPECT_LT(count, 40u * 30);
    EXPECT_EQ(picture.notFinite, count);
    EXPECT_EQ(picture.firstNotFinite, first);
    blackenNotFinite(picture);
    for (const float x : picture.color.pixels) EXPECT_TRUE(std::isfinite(x));
    EXPECT_EQ(picture.notFinite, count);
}

}  // namespace glint::stability::finite_test
