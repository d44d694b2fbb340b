// Rays that start on a surface: they must neither hit it again (acne) nor jump over its neighbour (leaks).
#include <cmath>
#include <numbers>

#include "reference/render.h"
#include "support.h"

namespace glint::render::test {
namespace {

using glm::dvec3;

// A closed convex mesh, nearly a sphere, with 2 x 16 x 24 triangles.
void addBall(Scene& scene, const dvec3& center, double radius) {
    constexpr uint32_t kRings = 16, kSides = 24;
    std::vector<dvec3> positions;
    for (uint32_t ring = 0; ring <= kRings; ++ring) {
        for (uint32_t side = 0; side < kSides; ++side) {
            const double theta = std::numbers::pi * ring / kRings, phi = 2 * std::numbers::pi * side / kSides;
            positions.push_back(center + radius * dvec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                                        std::sin(theta) * std::sin(phi)));
        }
    }
    std::vector<glm::uvec3> corners;
    for (uint32_t ring = 0; ring < kRings; ++ring) {
        for (uint32_t side = 0; side < kSides; ++side) {
            const uint32_t a = ring * kSides + side, b = ring * kSides + (side + 1) % kSides;
            if (ring > 0) corners.emplace_back(a, b, a + kSides);
            if (ring + 1 < kRings) corners.emplace_back(b, b + kSides, a + kSides);
        }
    }
    addMesh(scene, positions, corners);
}

enum class Kind { Plane, Sphere, Mesh };
struct Acne {
    Kind kind;
    double offset, size;
    bool moved;  // the packing moves the origin to the object
};

class ShadowTest : public RenderTest {
  protected:
    // The object at (offset, offset, offset), a camera two and a half sizes above it, a point light beside
    // the camera and a directional one.
    static Case caseOf(const Acne& a) {
        Scene scene = emptyScene();
        const dvec3 center(a.offset);
        if (a.kind == Kind::Plane) addPlane(scene, center, {0.2, 1, 0.1});
        if (a.kind == Kind::Sphere) addSphere(scene, center, a.size);
        if (a.kind == Kind::Mesh) addBall(scene, center, a.size);
        // Far behind, so that the scene's middle is the origin.
        if (!a.moved) addSphere(scene, -4.0 * center - dvec3(0, 9 * a.size, 0), a.size);
        scene.camera.eye = center + a.size * dvec3(0.5, 2.5, 1);
        scene.camera.target = center;
        scene.lights.push_back(PointLight{center + a.size * dvec3(3, 4, 1), Color(1), false});
        scene.lights.push_back(DirectionalLight{{1, -2, 1}, Color(0.5)});
        return makeCase(scene, 40, 40);
    }
};

// A convex object has no shadow on itself: where the light faces it, it is lit.
TEST_F(ShadowTest, convexObjectsDoNotShadeThemselves) {
    for (const Kind kind : {Kind::Plane, Kind::Sphere, Kind::Mesh}) {
        for (const double offset : {0.0, 1e3, 1e6}) {
            for (const double size : {1e-3, 1.0, 1e3}) {
                for (const bool moved : {true, false}) {
                    // Unmoved, fp32 must still be able to tell the object's points apart.
                    if (!moved && (offset == 0 || size < 4e-6 * offset)) continue;
                    const Case c = caseOf({kind, offset, size, moved});
                    const Picture picture = draw(device(), c);
                    const reference::RenderResult truth =
                        reference::render(c.packed, c.camera, c.width, c.height);
                    int hits = 0, shaded = 0;
                    for (int y = 0; y < c.height; ++y) {
                        for (int x = 0; x < c.width; ++x) {
                            const PixelData& data = picture.at(x, y);
                            hits += data.object == 0;
                            // Rounded corners far from the origin may make a mesh dented: the reference
                            // knows.
                            shaded += (data.shadowBits & ~truth.at(x, y).shadowBits) != 0;
                        }
                    }
                    const std::string where = "kind " + std::to_string(static_cast<int>(kind)) + " offset " +
                                              std::to_string(offset) + " size " + std::to_string(size) +
                                              (moved ? " moved" : "");
                    EXPECT_GT(hits, c.width * c.height / 5) << where;
                    EXPECT_EQ(shaded, 0) << where;
                }
            }
        }
    }
}

struct Lid {
    double height, gap;  // of the floor above 0; between floor and lid
};

// A floor under a lid of two triangles, seen from between them; the light above must not come through.
Case lidCase(const Lid& lid) {
    Scene scene = emptyScene();
    const double floor = lid.height, top = lid.height + lid.gap, half = 1;
    addTriangle(scene, {-half, floor, -half}, {half, floor, -half}, {half, floor, half});
    addTriangle(scene, {-half, floor, -half}, {half, floor, half}, {-half, floor, half});
    addTriangle(scene, {-2 * half, top, -2 * half}, {2 * half, top, -2 * half}, {2 * half, top, 2 * half});
    addTriangle(scene, {-2 * half, top, -2 * half}, {2 * half, top, 2 * half}, {-2 * half, top, 2 * half});
    // Keeps the packing from moving the origin.
    addSphere(scene, {0, -lid.height - 2, 0}, 0.5);
    scene.lights.push_back(PointLight{{0.3, lid.height + 2, 0.1}, Color(1), false});
    scene.camera.eye = {0, floor + 0.5 * lid.gap, 0.5};
    scene.camera.target = {0, floor, 0.5 - 4 * lid.gap};
    scene.camera.fovY = 60;
    return makeCase(scene, 32, 32);
}

// NUMERICS T82: dark until the gap is less than 4 ulp of the coordinates.
TEST_F(ShadowTest, thinGapsStayDark) {
    for (const Lid& lid :
         {Lid{1, 1e-2}, Lid{1, 1e-3}, Lid{1, 1e-4}, Lid{1, 1e-5}, Lid{1e3, 1e-2}, Lid{1e3, 1e-3}}) {
        const Case c = lidCase(lid);
        ASSERT_EQ(c.packed.origin, dvec3(0));
        const Picture picture = draw(device(), c);
        int floor = 0, lit = 0;
        for (const PixelData& data : picture.data) {
            if (data.object > 1) continue;
            ++floor;
            lit += data.shadowBits == 0;
        }
        EXPECT_GT(floor, 200) << lid.height << " " << lid.gap;
        EXPECT_EQ(lit, 0) << lid.height << " " << lid.gap << ", of " << floor;
    }
}

// A lamp close above a table in a large room: the cup between them casts its shadow however short the way is.
TEST_F(ShadowTest, lightCloseToASurface) {
    for (const double distance : {1.0, 0.1, 0.01, 0.001}) {
        Scene scene = emptyScene();
        addTriangle(scene, {-10, 0, -10}, {10, 0, -10}, {0, 0, 15});
        addTriangle(scene, {-8, 0.5 * distance, -8}, {8, 0.5 * distance, -8}, {0, 0.5 * distance, 12});
        scene.lights.push_back(PointLight{{0, distance, 0}, Color(1), false});
        scene.camera.eye = {0, 0.25 * distance, 0};
        scene.camera.target = {0, 0, -0.5 * distance};
        scene.camera.fovY = 40;
        const Case c = makeCase(scene, 32, 32);
        const Picture picture = draw(device(), c);
        int table = 0, lit = 0;
        for (const PixelData& data : picture.data) {
            if (data.object != 0) continue;
            ++table;
            lit += data.shadowBits == 0;
        }
        EXPECT_GT(table, 500) << distance;
        EXPECT_EQ(lit, 0) << "light " << distance << " above the table: lit pixels of " << table;
    }
}

// The floor's own primitive is no obstacle, its neighbour in a mesh is one.
TEST_F(ShadowTest, wedgeIsDarkInsideAndLitOutside) {
    Scene scene = emptyScene();
    addTriangle(scene, {0, 0, -50}, {4, 0, 0}, {0, 0, 50});
    addTriangle(scene, {0, 0, -50}, {0, 0, 50}, {4, 0.004, 0});  // a thousandth of a radian above it
    scene.lights.push_back(DirectionalLight{{0, -1, 0}, Color(1)});
    scene.camera.eye = {2, 3, 0};
    scene.camera.target = {2, 0, 0};
    scene.camera.up = {0, 0, 1};
    scene.camera.fovY = 30;
    const Picture above = draw(device(), makeCase(scene, 32, 32));
    for (const PixelData& data : above.data) EXPECT_EQ(data.shadowBits, 0u);
    scene.camera.eye = {3.9, 0.0015, 0};
    scene.camera.target = {3.5, 0, 0};
    scene.camera.up = {0, 1, 0};
    const Picture inside = draw(device(), makeCase(scene, 32, 32));
    int dark = 0;
    for (const PixelData& data : inside.data) {
        if (data.object != 0) continue;
        EXPECT_EQ(data.shadowBits, 1u);
        ++dark;
    }
    EXPECT_GT(dark, 100);
}

}  // namespace
}  // namespace glint::render::test
