// Solids near to and far from the eye.
#include "scene/transform.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::near_and_far_test {

// Solids much larger than the way to them: hits err by the rounding of the way, and not of the size.

using glm::dvec3;

// A square image whose neighbouring values differ.
std::shared_ptr<Image> scatteredValues(int size, int channels) {
    auto image = std::make_shared<Image>(size, size, channels);
    for (size_t i = 0; i < image->pixels.size(); ++i)
        image->pixels[i] = static_cast<float>(i * 37 % 251) / 251;
    return image;
}

class NearSolidsTest : public RenderTest {
  protected:
    // The report of verify on an image of one shape.
    static verify::Report seen(const Shape& shape, const std::optional<Affine>& transform, const dvec3& eye,
                               const dvec3& target, double fovY) {
        Scene scene = emptyScene();
        scene.materials[addMaterial(scene, Color(0.7))].specular = Color(0.3);
        scene.objects.push_back({"/objects/0", shape, 0});
        scene.objects.back().transform = transform;
        scene.lights.push_back(PointLight{eye + dvec3(1, 3, 2), Color(1)});
        aim(scene.camera, eye, target);
        scene.camera.fovY = fovY;
        const Case c = makeCase(scene, 48, 36);
        return verified(c);
    }
};

void expectExact(const verify::Report& report) {
    EXPECT_TRUE(report.passed());
    EXPECT_EQ(report.roundings + report.unexplained, 0u);
}

TEST_F(NearSolidsTest, HitsErrByTheWayAndNotTheSize) {
    const Affine turned = rotation({1, 2, 3}, 50);
    const ConeShape tipped{{-101, -10, 0}, {-101, 400, 0}, 100, 0, true};
    const struct {
        Shape shape;
        std::optional<Affine> transform;
        dvec3 eye, target;  // before the transform
        double fovY = 90;
    } rows[] = {
        // Their near ends are at the origin, so that the way is short to everything that a hit is a sum of.
        {BoxShape{{-5, -2, -3}, {2000, 2, 3}}, turned, {0, 6, 1}, {3, 0, 0}},
        {ConeShape{{-101, -10, 0}, {-101, 400, 0}, 100, 30, true}, turned, {1.5, 0, 0}, {0, 2, 3}},
        // Cones with a tip are measured from near the eye and from the tip: hits do not err by their size,
        // and the tip, which the second image shows, is closed.
        {tipped, turned, {1.5, 0, 0}, {0, 2, 3}},
        {tipped, turned, {1.5, 0, 0}, {-101, 380, 0}},
        // From its apex this one is a hundred radii away, and the eye a radius.
        {ConeShape{{0, 0, 0}, {-390, -47, -140}, 4.5, 0, true}, {}, {3.3, 5.8, -0.6}, {-1, 1, 0}},
        // Corners sixty times as far away as the hits, which are seen aslant.
        {TriangleShape{{{59, 98.9, 1456}, {-17.3, -114, 2794}, {-33.6, 36.4, -1914}}},
         {},
         {10.76, 25.45, 34.13},
         {-2.27, -0.2, 2.08},
         40}};
    for (const auto& row : rows) {
        SCOPED_TRACE(&row - rows);
        const glm::dmat3 turn = row.transform ? row.transform->linear : glm::dmat3(1);
        expectExact(seen(row.shape, row.transform, turn * row.eye, turn * row.target, row.fovY));
    }
}

// A needle of 347 by 0.01, whose edge functions resolve the place of a ray to a ten-thousandth of its length.
TEST_F(NearSolidsTest, Needles) {
    const TriangleShape needle{{{-155.9, -28.2, -16.9}, {122.3, -211.8, 79.4}, {-16.8, -120, 31.24}}};
    Scene scene = emptyScene();
    scene.ambient = Color(1);
    scene.objects.push_back({"/objects/0", needle, addMaterial(scene, Color(0.7))});
    scene.camera.eye = {1.5, 1.2, -0.4};
    scene.camera.fovY = 0.5;
    for (const double along : {0.3, 0.45, 0.6}) {
        scene.camera.target = dvec3(-155.9, -28.2, -16.896) + along * dvec3(278.2, -183.6, 96.3);
        expectExact(verified(makeCase(scene, 96, 72)));
    }
    // An edge, in pixels of a seventh of the coordinates' last place: hits stay in their place along it.
    scene.objects[0].shape =
        TriangleShape{{{-155.9, -28.2, -16.9}, {122.3, -211.8, 79.4}, {122.3, -211.8, 79.41}}};
    scene.camera.target = dvec3(-155.9, -28.2, -16.9) + 0.45 * dvec3(278.2, -183.6, 96.3);
    scene.camera.fovY = 1e-4;
    EXPECT_EQ(verified(makeCase(scene, 96, 72)).unexplained, 0u);
}

// Rounding decides which texels of a mask are holes: rays may hit a box behind holes of itself, any texel may
// be seen, and each light may be hidden, or cross any of several faces of glass.
TEST_F(NearSolidsTest, MasksOfFarTexelsHideTheirOwnBackSides) {
    const auto image = scatteredValues(8, 4);
    const std::pair<double, double> rows[] = {{0, 1e6}, {0.8, 1e5}};
    for (const auto& [transmission, repeats] : rows) {
        Scene scene = emptyScene();
        scene.ambient = scene.background = Color(1);
        scene.transmissiveShadows = TransmissiveShadows::Colored;
        scene.textures.push_back(
            {ImageTexture{"", image, Wrap::Repeat, Wrap::Repeat, TexelFilter::Nearest}, glm::dvec2(repeats)});
        const uint32_t number = addMaterial(scene, Color(0.7));
        Material& material = scene.materials[number];
        material.diffuseTexture = 0;
        material.alphaCutoff = 0.5;
        material.transmission = Color(transmission);
        material.ior = 1.3;
        addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, number);
        scene.objects.back().transform = rotation({1, 2, 0}, 30);
        addObject(scene, BoxShape{{-3, -2, -3}, {3, -1.8, 3}}, number);
        for (const dvec3& place : {dvec3(3, 4, 5), dvec3(-3, 5, 2), dvec3(0, 6, 3), dvec3(5, 1, 1),
                                   dvec3(-5, 2, -2), dvec3(1, 3, -5)})
            scene.lights.push_back(PointLight{place, Color(0.5)});
        aim(scene.camera, {0, 1, 6}, {0, 0, 0});
        scene.camera.fovY = 30;
        const verify::Report report = verifiedAsRead(makeCase(scene, 48, 36));
        EXPECT_TRUE(report.passed()) << transmission;
        EXPECT_GT(report.explained(), 50u) << transmission;
    }
}

// Ten million away a plane is hit at about 1e-6 radians. One unit of a ray's direction moves the hit by 6 %,
// and the device rounds the coordinates of each texture by themselves, to whole texels.
TEST_F(NearSolidsTest, FarTexelsAreThoseOfTheDevicesOwnHit) {
    const auto image = scatteredValues(16, 3);
    Scene scene = emptyScene();
    scene.ambient = scene.background = Color(1);
    Material& material = scene.materials[addMaterial(scene, Color(0.7), Color(0.7))];
    for (const double part : {1.0, 0.5})
        scene.textures.push_back({ImageTexture{"", image, Wrap::Repeat, Wrap::Mirror, TexelFilter::Nearest},
                                  part * glm::dvec2(0.013, 0.27)});
    material.ambientTexture = 0;
    material.mirrorTexture = 1;
    addPlane(scene, {0, 0, 0}, {0, 1, 0}, static_cast<uint32_t>(scene.materials.size() - 1));
    aim(scene.camera, {0, 10, 0}, {1e7, 0, 3e6});
    scene.camera.fovY = 1e-4;
    const verify::Report report = verified(makeCase(scene, 24, 18));
    EXPECT_TRUE(report.passed());
    EXPECT_GT(report.explained(), 20u);
}

// From 1e5 away a unit of the direction moves hits by a hundredth of a cell.
TEST_F(NearSolidsTest, CheckersFromFarAway) {
    Scene scene = emptyScene();
    scene.ambient = Color(1);
    scene.textures.push_back({CheckerTexture{Color(0.9), Color(0.2)}, glm::dvec2(2)});
    scene.materials[addMaterial(scene, Color(1), Color(1))].ambientTexture = 0;
    addPlane(scene, {0, -1, 0}, {0, 1, 0}, static_cast<uint32_t>(scene.materials.size() - 1));
    aim(scene.camera, {0, 16667, 1e5}, {0, 0, 0});
    scene.camera.fovY = 2.4e-3;
    EXPECT_TRUE(verified(makeCase(scene, 64, 48)).passed());
}

// The weights of fp32's edge functions err by a road's length over its width.
TEST_F(NearSolidsTest, LongRoadsOfTwoTriangles) {
    Scene scene = emptyScene();
    auto road = std::make_shared<Mesh>();
    road->positions = {{-2, 0, -1e4}, {2, 0, -1e4}, {2, 0, 1e4}, {-2, 0, 1e4}};
    road->corners = {{0, 1, 2}, {0, 2, 3}};
    addObject(scene, MeshShape{road}, addMaterial(scene, Color(0.6)));
    scene.lights.push_back(PointLight{{3, 6, 4}, Color(0.8)});
    aim(scene.camera, {0, 1.5, 5}, {0, 0.5, 0});
    EXPECT_TRUE(verified(makeCase(scene, 64, 48)).passed());
}

// Scenes that lie thousands of times their size from 0, with an object among them that hides it: fp32 counts
// from where most objects are, so pictures are those of the same scene at 0.

class FarSceneTest : public RenderTest {
  protected:
    static verify::Report seen(Scene scene, const dvec3& middle, double fovY) {
        scene.lights.push_back(PointLight{middle + dvec3(5, 4, 1), Color(0.9)});
        aim(scene.camera, middle + dvec3(6, 1.5, 0.5), middle);
        scene.camera.fovY = fovY;
        scene.ambient = Color(0.2);
        const Case c = makeCase(std::move(scene), 160, 120);
        return verifiedAsRead(c);
    }
};

// From 0 the coordinates' last place is a quarter of a pane's thickness: the next ray begins behind it.
TEST_F(FarSceneTest, PanesAFewRoundingsThick) {
    const dvec3 middle(2587, 4, 126);
    Scene scene = emptyScene();
    const uint32_t plain = addMaterial(scene, Color(0.6)), glass = addMaterial(scene, Color(0.1));
    scene.materials[glass].transmission = Color(0.9);
    scene.materials[glass].ior = 1.5;
    for (int i = 0; i < 4; ++i) {
        const dvec3 corner = middle + dvec3(0.31 * i, -1, -2.1 + i);
        scene.objects.push_back({"/pane", BoxShape{corner, corner + dvec3(6e-4, 2, 1.5)}, glass});
    }
    scene.objects.push_back({"/ball", SphereShape{middle - dvec3(2, 0.3, 0), 1}, plain});
    scene.objects.push_back(
        {"/block", BoxShape{middle + dvec3(-170, -400, -371), middle + dvec3(200, -4, -1)}, plain});
    const verify::Report report = seen(std::move(scene), middle, 40);
    EXPECT_TRUE(report.passed());
    EXPECT_LE(report.edges + report.roundings, 4u);
    EXPECT_EQ(report.unexplained, 0u);
}

// From 0 their corners are no farther apart than one or two roundings.
TEST_F(FarSceneTest, CrumbsKeepTheirShape) {
    const dvec3 middle(40366, 4, 9);
    Scene scene = emptyScene();
    const uint32_t plain = addMaterial(scene, Color(0.6));
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const dvec3 at = middle + random.box(0.15);
        scene.objects.push_back(
            {"/crumb", TriangleShape{{at, at + random.box(0.01), at + random.box(0.01)}}, plain});
    }
    scene.objects.push_back({"/planet", SphereShape{middle - dvec3(300, 640, 0), 700}, plain});
    const verify::Report report = seen(std::move(scene), middle, 3);
    EXPECT_TRUE(report.passed());
    EXPECT_EQ(report.unexplained, 0u);
    ASSERT_TRUE(report.representation.has_value());
    EXPECT_EQ(report.representation->explained + report.representation->unexplained, 0u);
}

}  // namespace glint::render::test::near_and_far_test
