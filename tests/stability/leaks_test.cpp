// No ray leaves a closed mesh: a million rays from inside at vertices and edges, on the device (T12 to T18,
// T82). On the device and in the reference, rays that start on a surface neither hit it again (T81) nor miss
// its neighbour (T82).
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "../render/support.h"
#include "checks.h"
#include "closed_meshes.h"
#include "reference/render.h"

namespace glint::stability::leaks_test {

using glm::dvec3;
using namespace render::test;

class LeakTest : public RenderTest {
  protected:
    Subject subject() const { return {&device(), {}}; }
    std::vector<std::pair<const char*, Subject>> subjects() const {
        return {{"device", subject()}, {"reference", {}}};
    }
    void expectDark(const Scene& scene, const std::string& where) const {
        const Image image = draw(device(), makeCase(scene, 64, 64)).color;
        size_t lit = 0;
        for (int i = 0; i < 64 * 64; ++i) lit += image.at(i % 64, i / 64, 0) != 0.0f;
        EXPECT_EQ(lit, 0u) << where;
    }
};

TEST_F(LeakTest, AMillionAimedRays) {
    expectNoLeaks(subject(), 1000000);
}

// T81. A convex object is lit everywhere that it faces the light.
TEST_F(LeakTest, ConvexObjectsDoNotShadeThemselves) {
    for (const Kind kind : {Kind::Plane, Kind::Sphere, Kind::Mesh}) {
        for (const double offset : {0.0, 1e3, 1e6}) {
            for (const double size : {1e-3, 1.0, 1e3}) {
                for (const bool moved : {true, false}) {
                    // Unmoved, fp32 must still separate the object's points.
                    if (!moved && (offset == 0 || size < 4e-6 * offset)) continue;
                    const std::string where = "kind " + std::to_string(static_cast<int>(kind)) + " offset " +
                                              std::to_string(offset) + " size " + std::to_string(size) +
                                              (moved ? " moved" : "");
                    for (const auto& [name, subject] : subjects()) {
                        const PixelCount count = countSelfShadowed(subject, kind, offset, size, moved);
                        EXPECT_GT(count.seen, 320u) << name << ' ' << where;
                        EXPECT_EQ(count.wrong, 0u) << name << ' ' << where;
                    }
                }
            }
        }
    }
}

// T66, T81 for the other kinds: no point that the light reaches is dark.
TEST_F(LeakTest, BodiesOfEveryKindAreLitWhereTheLightSeesThem) {
    const struct {
        double offset, size;
        bool moved;
    } rows[] = {{0, 1e-3, true}, {0, 1e3, true}, {1e6, 1, true}, {1e3, 1, false}, {1e6, 1e3, false}};
    for (const auto& row : rows) {
        for (const auto& [name, subject] : subjects()) {
            const auto counts = countDarkAlongTheLight(subject, row.offset, row.size, row.moved);
            for (size_t i = 0; i < counts.size(); ++i) {
                const std::string where = name + std::string(", body ") + std::to_string(i) + " offset " +
                                          std::to_string(row.offset) + " size " + std::to_string(row.size);
                EXPECT_GT(counts[i].seen, 50u) << where;
                EXPECT_EQ(counts[i].wrong, 0u) << where;
            }
        }
    }
}

// Closed round bodies and a light outside all of them.
constexpr dvec3 kLight(6, 7, -3);
constexpr char kRoundBodies[] = R"({
    "camera": {"eye": [0, 0, 9], "target": [0, 0, 0], "fovY": 0.003}, "ambient": 0,
    "lights": [{"type": "point", "position": [6, 7, -3], "intensity": 1000}],
    "objects": [
        {"type": "sphere", "center": [3.5, 2.5, 0.6], "radius": 0.5},
        {"type": "ellipsoid", "center": [-3.2, 0.5, 0.8], "radii": [0.75, 0.5, 0.4]},
        {"type": "cylinder", "base": [-2.1, 0.4, 1.1], "top": [-0.9, 0.4, 0.5], "radius": 0.4, "capped": true},
        {"type": "cone", "base": [0, 0, 0.6], "apex": [0, 1.2, 0.6], "radius": 0.5, "capped": true},
        {"type": "hyperboloid", "base": [2.3, 0, 2.4], "top": [2.3, 0.9, 2.4], "radius": 0.4, "waist": 0.2, "capped": true},
        {"type": "paraboloid", "vertex": [3.2, 0.8, 2.2], "top": [3.2, 0, 2.2], "radius": 0.4, "capped": true}
    ]})";
constexpr dvec3 kInside[] = {{3.5, 2.5, 0.6}, {-3.2, 0.5, 0.8}, {-1.5, 0.4, 0.8},
                             {0, 0.3, 0.6},   {2.3, 0.45, 2.4}, {3.2, 0.2, 2.2}};

// The direction from `eye`, between those `towards` the light and away from it through `side`, in which light
// lies in the tangent plane of the wall. None if a rim lies there instead.
std::optional<dvec3> terminatorOf(const reference::Tracer& tracer, const dvec3& eye, const dvec3& light,
                                  const dvec3& towards, const dvec3& side) {
    double dark = 0, lit = glm::pi<double>(), cosine = 0;
    const auto at = [&](double angle) { return std::cos(angle) * towards + std::sin(angle) * side; };
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = (dark + lit) / 2;
        reference::Ray ray;
        ray.origin = eye;
        ray.direction = at(middle);
        const auto surface = tracer.surfaceAt(ray, tracer.closest(ray).value());
        cosine = -glm::dot(surface.geometricNormal, glm::normalize(light - surface.position));
        (cosine > 0 ? lit : dark) = middle;
    }
    return std::abs(cosine) < 1e-6 ? std::optional(at(lit)) : std::nullopt;
}

// However close a point inside lies to the terminator, the body hides the light: there the shadow ray hits
// the body again after a chord as short as rounding.
TEST_F(LeakTest, RoundBodiesAreDarkInside) {
    Case c = textCase(kRoundBodies, 32, 32);
    const reference::Tracer tracer(c.packed);
    render::Renderer renderer(device(), c.packed, {});
    Camera& camera = c.camera;
    for (const dvec3& inside : kInside) {
        const dvec3 towards = glm::normalize(kLight - inside);
        const dvec3 across = glm::normalize(glm::cross(towards, dvec3(0.3, 1, 0.2)));
        int terminators = 0;
        for (int turn = 0; turn < 24; ++turn) {
            const double angle = glm::two_pi<double>() * turn / 24;
            const dvec3 side = std::cos(angle) * across + std::sin(angle) * glm::cross(towards, across);
            const auto direction =
                terminatorOf(tracer, inside - c.packed.origin, kLight - c.packed.origin, towards, side);
            if (!direction) continue;
            ++terminators;
            camera.eye = inside;
            camera.target = inside + *direction;
            camera.up = towards;
            const Image image = draw(renderer, c).color;
            for (int i = 0; i < c.width * c.height; ++i)
                ASSERT_EQ(image.at(i % c.width, i / c.width, 0), 0.0f)
                    << "body around (" << inside.x << ", " << inside.y << ", " << inside.z << "), turn "
                    << turn << ", pixel " << i;
        }
        EXPECT_GT(terminators, 5) << inside.x;
    }
}

// A light in the plane of a face of a thin box does not shine in, although rounding decides on which side of
// the face it lies.
constexpr char kThinBox[] = R"({
    "camera": {"eye": [0, 0, 0], "target": [1, 0, 0], "fovY": 100}, "ambient": 0,
    "lights": [{"type": "point", "position": [6, 7, -3]}],
    "materials": {"glossy": {"specular": 1, "shininess": 2}},
    "objects": [{"type": "group", "objects": [
        {"type": "polygon", "vertices": [[-1, -0.001, -1], [-1, -0.001, 1], [-1, 0.001, 1], [-1, 0.001, -1]], "material": "glossy"},
        {"type": "polygon", "vertices": [[1, -0.001, -1], [1, 0.001, -1], [1, 0.001, 1], [1, -0.001, 1]], "material": "glossy"},
        {"type": "polygon", "vertices": [[-1, -0.001, -1], [1, -0.001, -1], [1, -0.001, 1], [-1, -0.001, 1]], "material": "glossy"},
        {"type": "polygon", "vertices": [[-1, 0.001, -1], [-1, 0.001, 1], [1, 0.001, 1], [1, 0.001, -1]], "material": "glossy"},
        {"type": "polygon", "vertices": [[-1, -0.001, -1], [-1, 0.001, -1], [1, 0.001, -1], [1, -0.001, -1]], "material": "glossy"},
        {"type": "polygon", "vertices": [[-1, -0.001, 1], [1, -0.001, 1], [1, 0.001, 1], [-1, 0.001, 1]], "material": "glossy"}
    ], "transform": [{"rotate": [1, 2, 3, )";

// Like {"rotate": [1, 2, 3, degrees]}.
glm::dmat3 turnBy(double degrees) {
    return glm::dmat3(glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::normalize(dvec3(1, 2, 3))));
}

TEST_F(LeakTest, LightsInThePlaneOfAFaceStayOutside) {
    for (int degrees = 40; degrees < 180; degrees += 7) {
        const glm::dmat3 turn = turnBy(degrees);
        Scene scene = textCase(kThinBox + std::to_string(degrees) + "]}]}]}", 64, 64).scene;
        std::get<PointLight>(scene.lights[0]).position = turn * dvec3(3, 0.001 + 1e-10, 1);
        scene.camera.eye = turn * dvec3(0.1, 0, 0.05);
        scene.camera.target = turn * dvec3(0.9, 0.2, 0.3);
        expectDark(scene, std::to_string(degrees) + " degrees");
    }
}

// Rays that leave the rim of a thin body start at the edge of an error box, which reaches beyond the far
// side.
TEST_F(LeakTest, ThinMirrorsKeepLightOut) {
    const glm::dmat3 turn = turnBy(40);
    for (
        const std::string body :
        {R"("type": "ellipsoid", "center": [0, 0, 0], "radii": [1, 1, 0.7])",
         R"("type": "cylinder", "base": [0, 0, -0.8], "top": [0, 0, 0.8], "radius": 1, "capped": true)",
         R"("type": "hyperboloid", "base": [0, 0, -0.8], "top": [0, 0, 0.8], "radius": 1, "waist": 0.6, "capped": true)"}) {
        for (const double thickness : {1e-2, 1e-3, 1e-4}) {
            const std::string thin = std::to_string(thickness);
            Scene scene = textCase(R"({"camera": {"fovY": 120}, "background": 1, "maxDepth": 60,
                "materials": {"mirror": {"mirror": 1}},
                "objects": [{"type": "group", "objects": [{"material": "mirror", )" +
                                       body + R"(}], "transform": [{"scale": [1, )" + thin +
                                       R"(, 1]}, {"rotate": [1, 2, 3, 40]}]}]})",
                                   64, 64)
                              .scene;
            scene.camera.eye = turn * dvec3(0.05, 0.02 * thickness, -0.03);
            for (const dvec3& target :
                 {dvec3(0.6, 0.5 * thickness, -0.5), dvec3(-0.5, -0.7 * thickness, -0.3)}) {
                scene.camera.target = turn * target;
                expectDark(scene, body + ", thickness " + thin);
            }
        }
    }
}

// Far away the origins of rays that leave a cap may lie beside it, outside the body. Three balls keep the
// origin of coordinates where it is.
TEST_F(LeakTest, RimsKeepLightOut) {
    Scene scene = textCase(R"({"camera": {"fovY": 120}, "background": 1, "maxDepth": 60,
        "materials": {"mirror": {"mirror": 1}, "black": {"diffuse": 0}},
        "objects": [{"type": "group", "objects": [{"type": "cylinder", "base": [0, -0.1, 0], "top": [0, 0.1, 0],
        "radius": 0.7, "capped": true, "material": "mirror"}],
        "transform": [{"rotate": [1, 2, 3, 40]}, {"translate": [800, -500, 330]}]},
        {"type": "sphere", "center": [0, 0, 0], "radius": 1e-9, "material": "black"},
        {"type": "sphere", "center": [0.01, 0, 0], "radius": 1e-9, "material": "black"},
        {"type": "sphere", "center": [0.02, 0, 0], "radius": 1e-9, "material": "black"}]})",
                           64, 64)
                      .scene;
    const dvec3 place(800, -500, 330);
    scene.camera.eye = place + turnBy(40) * dvec3(0.1, 0.02, -0.1);
    for (const dvec3& target : {dvec3(0.6, 0.05, -0.5), dvec3(-0.5, -0.07, -0.3)}) {
        scene.camera.target = place + turnBy(40) * target;
        expectDark(scene, "far away");
    }
}

TEST_F(LeakTest, NeedlesAreDarkInside) {
    for (const double radius : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
        const std::string text = std::to_string(radius);
        Scene scene = textCase(R"({"camera": {"fovY": 120}, "ambient": 0,
            "lights": [{"type": "point", "position": [5, 1, 3]},
                       {"type": "directional", "direction": [-1.3, -0.6, 1.1]}],
            "objects": [{"type": "group", "objects": [{"type": "cylinder", "base": [0, -1, 0], "top": [0, 1, 0],
            "radius": )" + text + R"(, "capped": true}], "transform": [{"rotate": [1, 2, 3, 40]}]}]})",
                               64, 64)
                          .scene;
        const glm::dmat3 turn = turnBy(40);
        scene.camera.eye = turn * dvec3(0.1 * radius, 0.2, -0.1 * radius);
        scene.camera.target = turn * dvec3(0, -1, 0);
        expectDark(scene, "radius " + text);
    }
}

// An arch of slivers, one ten-thousandth of a turn from the next, under a lamp that shines along them. At the
// pixel (26, 143) the shadow ray hit the sliver beside the one that it leaves.
TEST_F(LeakTest, SliversDoNotShadeTheirNeighbours) {
    const Case c = fileCase("arcade", 800, 450);
    ASSERT_TRUE(c.packed.features.slivers);
    Request request = wholeWithData(c);
    request.region = {24, 140, 32, 148};
    const Picture truth = reference::render(c.packed, request);
    for (const render::Traversal traversal : {render::Traversal::Lane, render::Traversal::Packet}) {
        render::Options options;
        options.traversal = traversal;
        render::Renderer renderer(device(), c.packed, options);
        const Picture picture = renderer.render(request);
        ASSERT_EQ(picture.data.size(), truth.data.size());
        for (size_t i = 0; i < truth.data.size(); ++i)
            EXPECT_EQ(picture.data[i].shadowBits, truth.data[i].shadowBits) << i;
    }
}

// T82. Down to 8 ulp of the coordinates; the offset itself, gamma_7 of them, is up to 7.
TEST_F(LeakTest, ThinGapsStayDark) {
    const struct {
        double height, gap;
    } lids[] = {{1, 1e-2}, {1, 1e-3}, {1, 1e-4}, {1, 1e-5}, {1, 1e-6}, {1e3, 1e-2}, {1e3, 1e-3}};
    for (const auto& lid : lids) {
        for (const auto& [name, subject] : subjects()) {
            const PixelCount count = countLitUnderLid(subject, lid.height, lid.gap);
            EXPECT_GT(count.seen, 200u) << lid.height << " " << lid.gap;
            EXPECT_EQ(count.wrong, 0u)
                << name << ' ' << lid.height << " " << lid.gap << ", of " << count.seen;
        }
    }
}

}  // namespace glint::stability::leaks_test
