// Dielectrics on the device, against closed forms and against the reference.
#include <array>
#include <cmath>
#include <numbers>

#include "scene/transform.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::optics_test {
using glm::dvec3;

class OpticsTest : public RenderTest {
  protected:
    static Picture drawWithLosses(const Case& c, const Options& options = {}, double minContribution = 0) {
        Renderer renderer(device(), c.packed, options);
        auto settings = sized<Request>(c);
        settings.data = true;
        settings.ledger = true;
        settings.limits.minContribution = minContribution;
        return renderer.render(settings);
    }
    static float channel(const Picture& picture, int c = 0) { return picture.color.at(0, 0, c); }
    // The red of the only pixel. Expects that the reference agrees.
    static float seen(const Scene& scene) {
        const Case c = makeCase(scene, 1, 1);
        const float red = channel(draw(device(), c));
        const reference::Tracer tracer(c.packed);
        EXPECT_NEAR(red, tracer.trace(tracer.cameraRay(filmOf(c), 0.5, 0.5)).color.x, 1e-5);
        return red;
    }
};

uint32_t addGlass(Scene& scene, double ior, const Color& transmission = Color(1), int priority = 0) {
    Material glass;
    glass.ambient = glass.diffuse = Color(0);
    glass.transmission = transmission;
    glass.ior = ior;
    glass.priority = priority;
    scene.materials.push_back(glass);
    return static_cast<uint32_t>(scene.materials.size()) - 1;
}

uint32_t addPaint(Scene& scene, const Color& ambient) {
    const uint32_t paint = addMaterial(scene, Color(0));
    scene.materials[paint].ambient = ambient;
    return paint;
}

// One pixel of parallel light along `direction` through `eye`.
void look(Scene& scene, const dvec3& eye, const dvec3& direction) {
    scene.camera.projection = Projection::Orthographic;
    aim(scene.camera, eye, eye + direction, {0, 0, 1});
    scene.camera.height = 1e-3;
}

void addBox(Scene& scene, const dvec3& lo, const dvec3& hi, uint32_t material) {
    std::vector<dvec3> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
    const std::vector<glm::uvec3> sides = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                           {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    addMesh(scene, corners, sides, material);
}

// tests/stability/cases.md T91. What is refracted ends on black, so a white sky shows the reflectance alone.
// Its slope in the cosine is below 6, and a cosine good to 16 u.
TEST_F(OpticsTest, ReflectanceOfGlass) {
    struct Point {
        double cosine, reflectance;
    };
    for (const Point& p : {Point{1, .04}, Point{.5, .0891867128022}, Point{1e-2, .943752543486},
                           Point{1e-4, .999418816275}, Point{.554700196225, .0739644970414}}) {
        Scene scene = emptyScene();
        scene.background = Color(1);
        scene.maxDepth = 1;
        addPlane(scene, {0, 0, 0}, {0, 1, 0}, addGlass(scene, 1.5));
        addPlane(scene, {0, -1, 0}, {0, 1, 0}, addPaint(scene, Color(0)));
        const double sine = std::sqrt((1 - p.cosine) * (1 + p.cosine));
        look(scene, {-sine, p.cosine, 0}, {sine, -p.cosine, 0});
        EXPECT_NEAR(seen(scene), p.reflectance, 6 * 16 * 0x1p-24 + 1e-6) << p.cosine;
    }
}

// tests/stability/cases.md T86. From below the surface the sky is visible up to the critical angle. Packing
// finds the eye's medium.
TEST_F(OpticsTest, TotalReflectionFromTheCriticalAngleOn) {
    for (double ior : {1.33, 1.5, 2.417}) {
        for (double side : {-1.0, 1.0}) {
            const double angle = std::asin(1 / ior) + side * 1e-4;
            Scene scene = emptyScene();
            scene.background = Color(1);
            addPlane(scene, {0, 0, 0}, {0, 1, 0}, addGlass(scene, ior));
            addPlane(scene, {0, -2, 0}, {0, 1, 0}, addPaint(scene, Color(0)));
            look(scene, {0, -1, 0}, {std::sin(angle), std::cos(angle), 0});
            const float red = channel(draw(device(), makeCase(scene, 1, 1)));
            if (side > 0) {
                EXPECT_EQ(red, 0) << ior;
                continue;
            }
            const double c = std::cos(angle), after = std::sqrt(1 - std::pow(ior * std::sin(angle), 2));
            const double across = (ior * c - after) / (ior * c + after);
            const double along = (c - ior * after) / (c + ior * after);
            // 1 - R has a slope of up to 1 / (1e-4 rad) in a direction good to 16 u.
            EXPECT_NEAR(red, 1 - (across * across + along * along) / 2,
                        16 * 0x1p-24 * ior * ior * 1e4 + 1e-6);
        }
    }
}

// tests/stability/cases.md T88: a slab of index 1 changes no bit.
TEST_F(OpticsTest, SlabOfIndexOneChangesNothing) {
    Scene scene = emptyScene();
    scene.background = {0.3, 0.6, 0.9};
    scene.ambient = Color(0.7);
    const uint32_t paint = addPaint(scene, {0.9, 0.4, 0.2}), slab = addGlass(scene, 1);
    addSphere(scene, {0.2, 0, -2}, 1, paint);
    const Picture without = draw(device(), makeCase(scene, 40, 30));
    addBox(scene, {-1, -1, 0}, {1, 1.2, 0.3}, slab);
    const Picture with = draw(device(), makeCase(scene, 40, 30));
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x)
            for (int c = 0; c < 3; ++c) EXPECT_EQ(without.color.at(x, y, c), with.color.at(x, y, c));
}

// tests/stability/cases.md T89: seen through a slab of thickness 1 at 60 degrees, the edge of a screen
// appears 0.512472013191 to the side.
TEST_F(OpticsTest, SlabShiftsWhatIsBehind) {
    const double a = std::numbers::pi / 3, shift = 0.512472013191;
    const dvec3 d(std::sin(a), -std::cos(a), 0), side(-std::cos(a), -std::sin(a), 0);
    for (double nudge : {-1e-4, 1e-4}) {
        Scene scene = emptyScene();
        scene.maxDepth = 2;
        scene.ambient = Color(1);
        const uint32_t glass = addGlass(scene, 1.5), white = addPaint(scene, Color(1));
        addBox(scene, {-10, -1, -10.5}, {10.25, 0, 10}, glass);
        // In the plane through the unshifted ray, white on the side of the shift, beyond it.
        const dvec3 edge = 4.0 * d + (shift + nudge) * side;
        const dvec3 z(0, 0, 5);
        addPolygon(scene, {edge - z, edge + z, edge + 5.0 * side + z, edge + 5.0 * side - z}, white);
        look(scene, -d, d);
        const double through = std::pow(1 - 0.0891867128022, 2);
        EXPECT_NEAR(seen(scene), nudge < 0 ? through : 0, 1e-5);
    }
}

Scene shadowScene(const Light& light) {
    Scene scene = emptyScene();
    scene.materials[0].diffuse = Color(1);
    scene.lights.push_back(light);
    addPlane(scene, {0, 0, 0}, {0, 1, 0});
    const uint32_t glass = addGlass(scene, 1.5, {0.5, 0.8, 1});
    scene.materials[glass].attenuation = {0, 0.25, 1.5};
    addBox(scene, {-1, 1, -1}, {1, 1.75, 1}, glass);
    addSphere(scene, {0, 3, 0}, 0.5, glass);
    look(scene, {0.3, 0.5, 0}, {-0.3, -0.5, 0});
    scene.camera.height = 0.4;
    return scene;
}

// The light of one that has crossed so many surfaces of shadowScene's glass, and this much of it.
void expectThroughGlass(const Picture& picture, int surfaces, double way) {
    const double transmission[] = {0.5, 0.8, 1}, attenuation[] = {0, 0.25, 1.5};
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(picture.color.at(0, 0, i),
                    std::pow(transmission[i], surfaces) * std::exp(-way * attenuation[i]), 2e-6)
            << i;
}

// Below a slab 0.75 thick and a ball 1 thick the light has crossed four surfaces and 1.75 of glass, however
// long its way; from a lamp 0.25 above the slab's underside one surface and 0.25.
TEST_F(OpticsTest, ShadowsAreColoured) {
    PointLight lamp, far, inside;
    lamp.position = {0, 10, 0};
    far.position = {0, 1e6, 0};
    inside.position = {0, 1.25, 0};
    const DirectionalLight sun;
    const struct {
        Light light;
        int surfaces;
        double way;
    } cases[] = {{lamp, 4, 1.75}, {far, 4, 1.75}, {sun, 4, 1.75}, {inside, 1, 0.25}};
    for (const auto& [light, surfaces, way] : cases) {
        const Case c = makeCase(shadowScene(light), 1, 1);
        EXPECT_TRUE(c.packed.features.coloredShadows);
        const Picture whole = draw(device(), c);
        expectThroughGlass(whole, surfaces, way);
        // In pieces: as many dispatches as it takes, in the order of the stackless walk.
        const Picture pieces = draw(device(), c, {.tripBudget = 2});
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(channel(pieces, i), channel(whole, i), 1e-6) << i;
    }
    Scene full = shadowScene(Light(sun));
    full.transmissiveShadows = TransmissiveShadows::Full;
    EXPECT_EQ(channel(draw(device(), makeCase(full, 1, 1))), 0);
}

TEST_F(OpticsTest, ABlackTexelOfGlassBlocksAllLight) {
    PointLight lamp;
    lamp.position = {0, 1.25, 0};  // one surface above the plane
    lamp.intensity = Color(1e30);
    Scene scene = shadowScene(Light(lamp));
    scene.textures.push_back({CheckerTexture{Color(0), Color(0)}});
    for (Material& material : scene.materials)
        if (material.transmission != Color(0)) material.transmissionTexture = 0;
    EXPECT_EQ(channel(draw(device(), makeCase(scene, 1, 1))), 0);
}

// Light that comes down through a slab, on points of a grid exactly at the slab's diagonals, edges and
// corners: it crosses two surfaces and 0.75 of glass, or passes the slab. If both triangles of an edge
// counted, the light would be dimmed four times over, and by as much glass more or less.
TEST_F(OpticsTest, ShadowsCrossAnEdgeOnce) {
    Scene scene = emptyScene();
    scene.materials[0].diffuse = Color(1);
    DirectionalLight sun;
    sun.direction = {0, -1, 0};
    scene.lights.push_back(Light(sun));
    addPlane(scene, {0, 0, 0}, {0, 1, 0});
    const uint32_t glass = addGlass(scene, 1.5, Color(0.5));
    scene.materials[glass].attenuation = Color(0.5);
    addBox(scene, {-1, 1, -1}, {1, 1.75, 1}, glass);
    look(scene, {0.125, 0.5, 0.125}, {0, -1, 0});
    scene.camera.height = 3;
    const Case c = makeCase(scene, 12, 12);
    const double through = 0.25 * std::exp(-0.5 * 0.75);
    const Picture whole = draw(device(), c);
    const Picture pieces = draw(device(), c, {.tripBudget = 2});
    const reference::Tracer tracer(c.packed);
    int inside = 0, onDiagonals = 0;
    for (int y = 0; y < c.height; ++y) {
        for (int x = 0; x < c.width; ++x) {
            const dvec3 p = whole.at(x, y).position;
            const double reach = std::max(std::abs(p.x), std::abs(p.z));
            ASSERT_EQ(reach * 4, std::round(reach * 4)) << "the grid is met exactly";
            inside += reach < 1;
            onDiagonals += reach < 1 && std::abs(p.x) == std::abs(p.z);
            const auto judge = [&](double seen, const char* who) {
                const bool dimmed = std::abs(seen - through) < 1e-6, bright = std::abs(seen - 1) < 1e-6;
                EXPECT_TRUE(reach < 1 ? dimmed : (reach > 1 ? bright : dimmed || bright))
                    << who << ' ' << p.x << ' ' << p.z << ": " << seen;
            };
            judge(whole.color.at(x, y, 0), "device");
            judge(pieces.color.at(x, y, 0), "device, in pieces");
            judge(tracer.trace(tracer.cameraRay(filmOf(c), x + 0.5, y + 0.5)).color.x, "reference");
        }
    }
    EXPECT_EQ(inside, 49);
    EXPECT_EQ(onDiagonals, 13);
}

// Light that touches a solid, or passes it by a few units of the last place: it crosses the surface twice, or
// not at all. Where both crossings are at one t it crossed once; and came into the glass for good where
// rounding turned both normals towards it.
TEST_F(OpticsTest, LightThatTouchesIsNotLostInside) {
    DirectionalLight sun;
    sun.direction = {-1, 0, 0};
    const auto shapesOf = [](double r, double x) {
        return std::array{Shape(SphereShape{{x, 0, 0}, r}),
                          Shape(CylinderShape{{x, 0, -4}, {x, 0, 4}, r, true}),
                          Shape(EllipsoidShape{{x, 0, 0}, {2 * r, r, 3 * r}}),
                          Shape(HyperboloidShape{{x, 0, -4}, {x, 0, 4}, 3 * r, r, true})};
    };
    size_t crossed = 0, passed = 0;
    const auto judge = [&](double seen, const std::string& what) {
        const bool dimmed = std::abs(seen - 0.25) < 1e-4, bright = std::abs(seen - 1) < 1e-6;
        EXPECT_TRUE(dimmed || bright) << what << ": " << seen;
        crossed += dimmed;
        passed += bright;
    };
    for (size_t kind = 0; kind < 4; ++kind) {
        for (int units = -16; units <= 16; units += 2) {
            Scene scene = emptyScene();
            scene.materials[0].diffuse = Color(1);
            scene.lights.push_back(Light(sun));
            addPlane(scene, {-5, 0, 0}, {1, 0, 0});
            const uint32_t glass = addGlass(scene, 1.5, Color(0.5));
            scene.materials[glass].attenuation = Color(0.005);
            glint::test::addObject(scene, shapesOf(0.5 * (1 + units * 0x1p-24), 37)[kind], glass);
            look(scene, {-3, 0, 0}, {-1, 0, 0});
            scene.camera.up = {0, 1, 0};
            scene.camera.height = 2;  // rows at y = 0.5 and -0.5
            const Case c = makeCase(scene, 1, 2);
            const Picture picture = draw(device(), c);
            const reference::Tracer tracer(c.packed);
            for (int y = 0; y < c.height; ++y) {
                const std::string what = std::to_string(kind) + " by " + std::to_string(units);
                judge(picture.color.at(0, y, 0), "device, " + what);
                judge(tracer.trace(tracer.cameraRay(filmOf(c), 0.5, y + 0.5)).color.x, "reference, " + what);
            }
        }
    }
    EXPECT_GT(crossed, 0u);
    EXPECT_GT(passed, 0u);
}

// The device and the reference keep the same account, which bounds the error of each cut.
TEST_F(OpticsTest, AccountsAgreeWithTheReference) {
    const Case c = fileCase("glass", 48, 30);
    verify::Options options;
    options.limits.minContribution = 0.01;
    const verify::Report report = verified(c, {}, options);
    EXPECT_TRUE(report.passed());
    EXPECT_FALSE(report.lossesDiffer);
    const Picture picture = drawWithLosses(c, {}, 0.01), all = drawWithLosses(c);
    EXPECT_GT(picture.losses.cut.count, 100u);
    double worst = 0;
    for (size_t i = 0; i < all.color.pixels.size(); ++i)
        worst = std::max(worst, std::abs(double(all.color.pixels[i]) - double(picture.color.pixels[i])));
    EXPECT_GT(worst, 0);
    EXPECT_LE(worst, picture.losses.cut.greatest);
}

// A light that touches a surface has no bound, so the least numbers that a throughput may be are worth much.
// Within a pane it falls to 3e-18, 1e-29, 5e-41: some devices make zero of the last, which is cut by all.
TEST_F(OpticsTest, NothingIsMadeOfSubnormalThroughput) {
    Scene scene = emptyScene();
    scene.background = Color(1);
    scene.maxDepth = 40;
    const uint32_t glass = addGlass(scene, 2);
    scene.materials[glass].attenuation = Color(24);
    scene.materials[glass].diffuse = Color(0.5);
    addBox(scene, {-9, 0, -9}, {9, 1, 9}, glass);
    PointLight light;
    light.falloff = Falloff::InverseSquare;
    scene.lights = {light};
    look(scene, {0.2, 0.5, 0.3}, {0, -1, 0});
    const Case c = makeCase(scene, 1, 1);
    ASSERT_EQ(radianceBoundOf(c.packed, {}), shared::kInfinity);
    Tracing cut;
    cut.limits.minContribution = 1e-4;
    const reference::Tracer tracer(c.packed, cut);
    const reference::PixelRecord expected = tracer.trace(tracer.cameraRay(filmOf(c), 0.5, 0.5));
    const Picture picture = drawWithLosses(c, {}, cut.limits.minContribution);
    EXPECT_EQ(picture.at(0, 0).bounces, expected.bounces);
    EXPECT_EQ(picture.losses.cut.count, expected.lost.cut.count);
    EXPECT_EQ(picture.losses.cut.sum, 0);
    EXPECT_EQ(expected.lost.cut.sum, 0);
}

// The eye is in a crystal that absorbs, 4 from a face with corners 300 away. t errs by the corners' last
// digits, which is more than its own, and the light's share errs by as much.
TEST_F(OpticsTest, LightFadesByAWayThatErrsWithItsFacesCorners) {
    Scene scene = emptyScene();
    scene.ambient = Color(1);
    const uint32_t glass = addGlass(scene, 1.5);
    scene.materials[glass].attenuation = {3, 2, 1};
    scene.materials[glass].ambient = Color(0.7);
    const glm::dmat3 turned = rotation({1, 2, 3}, 50).linear;
    auto crystal = std::make_shared<Mesh>();
    for (const dvec3& p : {dvec3(-300, -200, 4), dvec3(250, -180, 4), dvec3(20, 330, 4), dvec3(0, 0, -300)})
        crystal->positions.push_back(turned * p);
    crystal->corners = {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}};
    scene.objects.push_back({"", MeshShape{crystal}, glass, std::nullopt});
    look(scene, {0, 0, 0}, turned * dvec3(0, 0, 1));
    scene.camera.projection = Projection::Perspective;
    scene.camera.fovY = 60;
    const Case c = makeCase(scene, 48, 36);
    const verify::Report report = verified(c);
    EXPECT_TRUE(report.passed());
    EXPECT_EQ(report.explained() + report.unexplained, 0u);
}

// Within a medium light fades by all of its way from the lamp: 2.5 to the floor's point below the eye.
TEST_F(OpticsTest, LightFadesFromALampWithinTheMedium) {
    Scene scene = emptyScene();
    const uint32_t water = addGlass(scene, 1.33), paint = addMaterial(scene, Color(0.5));
    scene.materials[paint].ambient = Color(0);
    scene.materials[water].attenuation = {2, 1, 0.5};
    scene.objects.push_back({"", SphereShape{{0, 0, 0}, 20}, water, std::nullopt});
    addPlane(scene, {0, 0, 0}, {0, 0, 1}, paint);
    scene.lights.push_back(PointLight{{1.5, 0, 2}, Color(1)});
    look(scene, {0, 0, 1}, {0, 0, -1});
    scene.camera.up = {0, 1, 0};
    const Case c = makeCase(scene, 1, 1);
    const Picture picture = drawWithLosses(c);
    // Of the lamp's way 2.5, with a cosine of 0.8, and 1 to the eye.
    for (int i = 0; i < 3; ++i) {
        const double expected =
            0.5 * 0.8 * std::exp(-3.5 * std::array{2.0, 1.0, 0.5}[static_cast<size_t>(i)]);
        EXPECT_NEAR(channel(picture, i), expected, 4e-6 * expected) << i;
    }
}

// Between two facing panes each reflection leaves a branch waiting. The account of the 17th: the reflected
// one, the lesser, is dropped, once.
TEST_F(OpticsTest, FullWaitingRoomIsReported) {
    Scene scene = emptyScene();
    scene.background = Color(1);
    scene.maxDepth = 40;
    const uint32_t glass = addGlass(scene, 1.5);
    addPlane(scene, {0, 0, 0}, {0, 1, 0}, glass);
    addPlane(scene, {0, 1, 0}, {0, -1, 0}, addGlass(scene, 1.5));
    look(scene, {0, 0.5, 0}, {0.6, -0.8, 0});
    const Case c = makeCase(scene, 1, 1);
    const Picture picture = drawWithLosses(c);
    EXPECT_EQ(picture.losses.room.count, 1u);
    const reference::Tracer tracer(c.packed);
    const reference::PixelRecord record = tracer.trace(tracer.cameraRay(filmOf(c), 0.5, 0.5));
    EXPECT_EQ(record.lost.room.count, 1u);
    EXPECT_EQ(record.pathHash, picture.at(0, 0).pathHash);
    EXPECT_EQ(record.bounces, picture.at(0, 0).bounces);
    EXPECT_NEAR(picture.losses.room.sum, record.lost.room.sum, 1e-4 * record.lost.room.sum);
    // 16 reflections and as many refractions, and the refraction that is kept of the 17th surface.
    EXPECT_EQ(record.bounces, 33u);
}

TEST_F(OpticsTest, MediaAtAPoint) {
    Scene scene = emptyScene();
    const uint32_t sea = addGlass(scene, 1.33), box = addGlass(scene, 1.5), ball = addGlass(scene, 1.4),
                   leaf = addGlass(scene, 1.3);
    addPlane(scene, {0, 5, 0}, {0, 1, 0}, sea);
    addBox(scene, {-1, -1, -1}, {1, 1, 1}, box);
    addSphere(scene, {0, 0, 0}, 0.5, ball);
    addSphere(scene, {0.1, 0, 0}, 0.5, ball);
    addPolygon(scene, {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}, leaf);  // open: no inside
    const PackedScene packed = packScene(scene);
    EXPECT_EQ(mediaAt(packed, {0, 6, 0}), glm::uvec4(0));
    EXPECT_EQ(mediaAt(packed, {0, 2, 0}), glm::uvec4(1, 0, 0, 0));
    EXPECT_EQ(mediaAt(packed, {0.9, 0.9, 0.9}), glm::uvec4(1, 2, 0, 0));
    EXPECT_EQ(mediaAt(packed, {0, 0, 0}), glm::uvec4(1, 2, 3, 3));
    EXPECT_EQ(mediaAt(packed, {2.2, 0.2, 0.01}), glm::uvec4(1, 0, 0, 0));
}

}  // namespace glint::render::test::optics_test
