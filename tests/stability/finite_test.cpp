// No picture holds NaN or infinity, whatever the scene holds; what does overflow is counted and named.
#include <gtest/gtest.h>

#include <cmath>

#include "../render/support.h"

namespace glint::stability::finite_test {
using render::test::Case;
using render::test::draw;
using render::test::textCase;

class FiniteTest : public render::test::RenderTest {};

std::string sceneOf(const std::string& rest) {
    return R"({"camera": {"eye": [0, 0.5, 3], "target": [0, 0.5, 0]}, "ambient": 0.1, )" + rest + "}";
}
const char* const kBall =
    R"("objects": [{"type": "sphere", "center": [0, 0.5, 0], "radius": 0.5, "material": "m"},
    {"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "m"}])";

// T92, T94, T83 and the ends of the ranges of src/scene/limits.h.
TEST_F(FiniteTest, TheEndsOfTheRanges) {
    const std::string ball = kBall;
    const std::string texts[] = {
        // As bright as may be, alone and beside the faintest.
        R"("materials": {"m": {"specular": 1, "shininess": 50}}, "lights": [{"type": "point", "position": [2, 3, 4], "intensity": 1e18},
            {"type": "directional", "direction": [0, -1, 0], "intensity": 1e-18}], )" +
            ball,
        // Light 1e8, ambient 1e-3 (T94).
        R"("materials": {"m": {"ambient": 1e-3, "specular": 1e3, "shininess": 2}}, "lights": [{"type": "point", "position": [2, 3, 4],
            "intensity": 1e8}], )" +
            ball,
        // Exponents 0 and 1e18 (T92).
        R"("materials": {"m": {"specular": 1, "shininess": 0}}, "lights": [{"type": "point", "position": [2, 3, 4]}], )" +
            ball,
        R"("materials": {"m": {"specular": 1, "shininess": 1e18}}, "lights": [{"type": "point", "position": [0, 0.5, 3]}], )" +
            ball,
        // A light in the eye, on a surface, in the middle of the ball; behind the ball the half vector is 0.
        R"("materials": {"m": {"specular": 1, "shininess": 9}}, "lights": [{"type": "point", "position": [0, 0.5, 3]},
            {"type": "point", "position": [0, 0.5, 0.5], "falloff": "inverseSquare"}, {"type": "point", "position": [0, 0.5, 0]},
            {"type": "point", "position": [0, 0, 2], "falloff": "inverseSquare"}, {"type": "directional", "direction": [0, 0, 1]}], )" +
            ball,
        // A ball that rests on the ground: its contact point (T83).
        R"("camera": {"eye": [0, 0.0001, 0.01], "target": [0, 0, 0]}, "materials": {"m": {"mirror": 0.5}}, "lights": [{"type": "point",
            "position": [1, 3, 2]}], )" +
            ball,
    };
    for (const std::string& text : texts) {
        const bool ownCamera = text.find("\"camera\"") != std::string::npos;
        const Case c = textCase(ownCamera ? "{\"ambient\": 0.1, " + text + "}" : sceneOf(text), 64, 48);
        const Picture picture = draw(device(), c);
        EXPECT_EQ(picture.notFinite, 0u) << text;
        EXPECT_EQ(picture.firstNotFinite, glm::ivec2(-1));
        EXPECT_GT(std::count_if(picture.data.begin(), picture.data.end(),
                                [](const PixelData& d) { return d.object != PixelData::kNoIndex; }),
                  64 * 48 / 4);
    }
}

// Vertex normals of no length, or that cancel: the geometric one takes their place.
TEST_F(FiniteTest, VertexNormalsOfNoLength) {
    for (const glm::dvec3& second : {glm::dvec3(0), glm::dvec3(0, 0, -1)}) {
        Scene scene = render::test::emptyScene();
        auto mesh = std::make_shared<glint::Mesh>();
        mesh->positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
        mesh->normals = {second == glm::dvec3(0) ? second : glm::dvec3(0, 0, 1), second, glm::dvec3(0)};
        mesh->corners = {{0, 1, 2}};
        mesh->normalCorners = {{0, 1, 2}};
        scene.objects.push_back({"mesh", MeshShape{mesh}, 0});
        scene.camera.eye = {0, 0, 3};
        scene.lights.push_back(PointLight{{1, 1, 3}, Color(1)});
        const Picture picture = draw(device(), render::test::makeCase(scene, 33, 33));
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
