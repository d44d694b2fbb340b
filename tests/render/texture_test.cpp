// Textures on the device and in the reference: pixels with known colours, and the accuracy of texture
// coordinates.
#include <cmath>
#include <numbers>

#include "reference/render.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::texture_test {
using glm::dvec2;
using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

// Two by two texels, rows from the top: 1 2 / 3 4 in red; alpha 0 in the upper row.
std::shared_ptr<const Image> quadImage() {
    auto image = std::make_shared<Image>(2, 2, 4, 0.0f);
    for (int i = 0; i < 4; ++i) image->at(i % 2, i / 2, 0) = static_cast<float>(i + 1);
    for (int x = 0; x < 2; ++x) image->at(x, 1, 3) = 1;
    return image;
}

uint32_t addTexture(Scene& scene, Texture texture) {
    scene.textures.push_back(std::move(texture));
    return static_cast<uint32_t>(scene.textures.size() - 1);
}

// White, by ambient light alone, with a texture.
uint32_t addTextured(Scene& scene, Texture texture) {
    const uint32_t material = addMaterial(scene, Color(1));
    scene.materials[material].ambient = Color(1);
    scene.materials[material].ambientTexture = scene.materials[material].diffuseTexture =
        addTexture(scene, std::move(texture));
    scene.ambient = Color(1);
    return material;
}

// Images of one pixel by one renderer, whose kernels are compiled once. Expects that the reference agrees.
class Viewer {
  public:
    Viewer(const gpu::Device& device, Scene scene, const Options& options = {})
        : case_(makeCase(std::move(scene), 1, 1)),
          renderer_(device, case_.packed, options),
          tracer_(case_.packed) {}

    vec3 operator()(const dvec3& eye, const dvec3& target) {
        Camera camera;
        aim(camera, eye, target,
            std::abs(glm::normalize(target - eye).y) > 0.9 ? dvec3(0, 0, -1) : dvec3(0, 1, 0));
        camera.fovY = 1e-3;
        case_.camera = camera;
        const Picture picture = draw(renderer_, case_);
        const vec3 color(picture.color.at(0, 0, 0), picture.color.at(0, 0, 1), picture.color.at(0, 0, 2));
        const dvec3 exact = tracer_.trace(tracer_.cameraRay(filmOf(case_), 0.5, 0.5)).color;
        EXPECT_LT(glm::distance(dvec3(color), exact), 1e-5) << color.x << " and " << exact.x;
        return color;
    }

  private:
    Case case_;
    Renderer renderer_;
    reference::Tracer tracer_;
};

class TextureTest : public RenderTest {
  protected:
    // A wall z = 0 with this texture, at `points`. Its coordinates are (0, 0) at `start`.
    static std::vector<float> wall(const Texture& texture, const std::vector<dvec2>& points,
                                   const Options& options = {}, const dvec2& start = {}) {
        Scene scene = emptyScene();
        addPlane(scene, dvec3(start, 0), {0, 0, 1}, addTextured(scene, texture));
        Viewer viewer(device(), std::move(scene), options);
        std::vector<float> values;
        for (const dvec2& p : points) values.push_back(viewer(dvec3(p, 1), dvec3(p, 0)).x);
        return values;
    }
};

void expectNear(const std::vector<float>& values, const std::vector<double>& expected, double tolerance) {
    ASSERT_EQ(values.size(), expected.size());
    for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], expected[i], tolerance) << i;
}

TEST_F(TextureTest, BilinearAndWrapOnBothAccesses) {
    for (const gpu::Access access : {gpu::Access::StorageBuffer, gpu::Access::TexelBuffer}) {
        const Options options = {.access = access};
        const Texture clamp{ImageTexture{"q", quadImage(), Wrap::Clamp, Wrap::Clamp}};
        const Texture repeat{ImageTexture{"q", quadImage()}};
        const Texture mirror{ImageTexture{"q", quadImage(), Wrap::Mirror, Wrap::Mirror}};
        expectNear(
            wall(clamp, {{0.25, 0.75}, {0.5, 0.5}, {0.375, 0.25}, {-4, 7}, {-3, 0.75}, {9, -5}}, options),
            {1, 2.5, 3.25, 1, 1, 4}, 1e-5);
        expectNear(
            wall(repeat, {{1, 0.75}, {0, 0.75}, {1.25, 0.75}, {-0.75, -0.25}, {-0.75, -0.75}, {0.25, 1}},
                 options),
            {1.5, 1.5, 1, 1, 3, 2}, 1e-5);
        expectNear(
            wall(mirror, {{0, 0.75}, {1.25, 0.75}, {1.75, 0.75}, {-0.25, 0.75}, {2.25, -0.25}}, options),
            {1, 2, 1, 1, 3}, 1e-5);
    }
}

TEST_F(TextureTest, NearestAndCheckers) {
    const Texture nearest{ImageTexture{"q", quadImage(), Wrap::Repeat, Wrap::Repeat, TexelFilter::Nearest}};
    expectNear(wall(nearest, {{0.49, 0.51}, {0.51, 0.49}}), {1, 4}, 0);
    const Texture checker{CheckerTexture{Color(1), Color(5)}};
    expectNear(wall(checker, {{0.5, 0.5}, {1.5, 0.5}, {1.5, 1.5}, {-0.5, 0.5}, {-0.5, -0.5}}),
               {1, 5, 1, 5, 1}, 0);
    const Texture moved{CheckerTexture{Color(1), Color(5)}, dvec2(2), dvec2(0.6, 0)};
    expectNear(wall(moved, {{0.75, 0.25}}), {1}, 0);
    // Of the cubes (0, 0, 1) and (1, 0, 1).
    const Texture solid{CheckerTexture{Color(1), Color(5), true, dvec3(0, 0, -0.75)}, dvec2(2)};
    expectNear(wall(solid, {{0.25, 0.25}, {0.75, 0.25}}), {5, 1}, 0);
}

// A corner 25,000 from its object is exact to 2 x 10^-3 in fp32, in the object's coordinates or the world's.
// Each object counts its cubes from near itself, with any other objects in the scene, and an object with two
// checkers of one size counts those of both. The scene before any rounding is the measure.
TEST_F(TextureTest, SolidCheckersKeepTheirCubesWhereverTheirCornerIs) {
    const char* const scenes[] = {
        R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 2, "transform": [{"translate": [3, 5, -7]}], "material": "m"}],
            "camera": {"type": "orthographic", "eye": [2, 10, -8], "target": [3, 5, -7], "height": 6}, "ambient": 1,
            "materials": {"m": {"ambient": {"checker": [0.2, 0.8], "scale": 2.08, "solid": true,
                                            "corner": [298.116, 5587.24, 25022.0969]}}}})",
        R"({"objects": [{"type": "sphere", "center": [17466, 0, -202], "radius": 2, "material": "m"}],
            "camera": {"type": "orthographic", "eye": [17464, 5, -203], "target": [17466, 0, -202], "height": 6}, "ambient": 1,
            "materials": {"m": {"ambient": {"checker": [0.2, 0.8], "scale": 2.08, "solid": true,
                                            "corner": [17464.97, -0.66, -203.5]}}}})",
        R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 2, "transform": [{"translate": [3, 5, -7]}], "material": "m"},
            {"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": [{"translate": [4, 8, -9]}], "material": "n"}],
            "camera": {"type": "orthographic", "eye": [2, 10, -8], "target": [3, 5, -7], "height": 6},
            "ambient": 1, "lights": [{"type": "directional", "direction": [1, -3, 2]}], "materials": {
            "m": {"ambient": {"checker": [0.2, 0.8], "scale": 2.08, "solid": true, "corner": [298.116, 5587.24, 25022.0969]},
                  "diffuse": {"checker": [0.1, 0.9], "scale": 2.08, "solid": true, "corner": [-6298.4, 7.24, 25021.31]}},
            "n": {"ambient": {"checker": [0.3, 0.7], "scale": 3.08, "solid": true, "corner": [9298.1, -7.3, -25022.7]}}}})"};
    for (const char* scene : scenes) {
        const verify::Report report = verifiedAsRead(textCase(scene, 160, 120));
        EXPECT_TRUE(report.passed()) << scene;
        EXPECT_EQ(report.explained() + report.representation->explained, 0u) << scene;
    }
}

// Whole periods added to coordinates change nothing, although fp32 has no fractions there; coordinates beyond
// 1e9 become 0.
TEST_F(TextureTest, GreatCoordinatesStayInTheImage) {
    for (const Wrap wrap : {Wrap::Repeat, Wrap::Mirror}) {
        Texture far{ImageTexture{"q", quadImage(), wrap, wrap, TexelFilter::Nearest}, dvec2(1),
                    dvec2(2e7, -2e7)};
        expectNear(wall(far, {{0.25, 0.75}, {0.75, 0.25}}), {1, 4}, 0);
        far.offset = {1000.1, 0};
        expectNear(wall(far, {{0.39999, 0.75}, {0.40001, 0.75}}), {1, 2}, 0);
        far.offset = {1e17, -1e17};
        expectNear(wall(far, {{0.25, 0.75}}), {3}, 0);  // the texel at (0, 0)
    }
    const Texture checker{CheckerTexture{Color(1), Color(2)}, dvec2(1), dvec2(2e7, -2e7)};
    expectNear(wall(checker, {{0.25, 0.75}, {1.25, 0.75}, {0.25, -0.75}}), {1, 2, 2}, 0);
}

// A plane 1e7 from its point looks like a plane whose point is near, moved by whole periods; verify has
// nothing to explain. Clamped coordinates and those without a common period stay.
TEST_F(TextureTest, FarPlanesKeepTheirCells) {
    const auto image = [](Wrap wrapU, Wrap wrapV, const dvec2& scale) {
        return Texture{ImageTexture{"q", quadImage(), wrapU, wrapV, TexelFilter::Nearest}, scale};
    };
    const std::vector<dvec2> points = {{0.2, 0.7}, {0.7, 0.2},  {-0.2, 0.3},
                                       {0.1, 0.3}, {0.9, -0.6}, {1.1, 1.2}};
    for (const Texture& texture :
         {image(Wrap::Repeat, Wrap::Repeat, {1, 4}), image(Wrap::Mirror, Wrap::Repeat, {0.4, -1}),
          image(Wrap::Clamp, Wrap::Mirror, dvec2(1)),
          Texture{CheckerTexture{Color(1), Color(2)}, {4, 2.5}}}) {
        const std::vector<float> near = wall(texture, points, {}, {texture.scale == dvec2(1) ? 10 : 0, 0});
        expectNear(wall(texture, points, {}, {1e7, -3e7}), {near.begin(), near.end()}, 0);
    }
    const Case floor =
        textCase(R"({"camera": {"eye": [1e7, 5, -3e7], "target": [1e7, 0, -3e7], "up": [0, 0, 1]},
        "ambient": 1, "materials": {"m": {"diffuse": {"scale": 4, "checker": [0.2, 0.8]}}}, "objects": [
        {"type": "plane", "point": [0.03, 0, 0.125], "normal": [0, 1, 0], "material": "m",
         "transform": [{"rotate": [0, 1, 0, 90]}]}]})",
                 160, 120);
    Scene scene = floor.scene;
    scene.textures.push_back(scene.textures[0]);
    scene.materials[scene.objects[0].material].specularTexture = 1;
    const auto frame = [&](const dvec2& scale) {
        scene.textures[1].scale = scale;
        return packScene(scene).objectFrames.at(0);
    };
    for (const dvec2& scale : {dvec2(4), dvec2(3, 2.8), dvec2(1e3, 0.016)}) {
        EXPECT_LT(std::abs(frame(scale).offsetU), 251.0f);
        EXPECT_LT(std::abs(frame(scale).offsetV), 251.0f);
        const verify::Report report = verifiedAsRead(makeCase(scene, 160, 120));
        EXPECT_TRUE(report.passed());
        EXPECT_EQ(report.explained() + report.representation->explained, 0u);
    }
    EXPECT_GT(std::abs(frame(dvec2(std::sqrt(2))).offsetU), 9e6f);
}

// The device's u and v against atan2 and asin in double of the normal that it reports. turnsOf is good to
// 2^-23; u is rounded once more (2^-25), v takes the angle twice and the ring, which errs by 4 units of at
// most 1/(2 pi) turns' worth: below 2^-21 in all.
TEST_F(TextureTest, AnglesAreGoodToTheirBound) {
    Scene scene = emptyScene();
    addSphere(scene, {0, 0, 0}, 1, addTextured(scene, {CheckerTexture{}}));
    Random random(7);
    std::vector<RayInput> rays;
    for (int i = 0; i < 4000; ++i) {
        dvec3 d = random.direction();
        if (i % 4 == 0) d[i / 4 % 3] *= std::exp(random.uniform(-30, 0));  // near the planes between octants
        rays.push_back(rayTowards(2.0 * glm::normalize(d), dvec3(0)));
    }
    double worstU = 0, worstV = 0;
    for (const RayHit& hit : hitsOf(packScene(scene), rays)) {
        ASSERT_TRUE(hit.hit);
        const dvec3 n(hit.data.geometricNormal);
        const double u = 0.5 + std::atan2(n.x, n.z) / (2 * std::numbers::pi);
        const double v = 0.5 + std::atan2(n.y, std::hypot(n.x, n.z)) / std::numbers::pi;
        worstU = std::max(worstU, std::abs(hit.data.u - u));
        worstV = std::max(worstV, std::abs(hit.data.v - v));
    }
    EXPECT_LE(worstU, 2 * kUnit + kUnit / 2);
    EXPECT_LE(worstV, 8 * kUnit);
}

// The image's middle column faces +z, its right quarter +x, on round objects along y; heights go from 0 to 1
// from the base (the vertex of a paraboloid). On the sides of a box u points to the right and v upwards as
// seen from outside, top and bottom as floor and ceiling. Triangles have barycentrics, discs and polygons the
// place in the image. All coordinates are the object's own, before its transform.
struct KnownUv {
    Shape shape;
    dvec3 from, towards;
    dvec2 uv;
    std::optional<Affine> transform = {};
};

std::vector<KnownUv> knownUvs() {
    const Shape sphere = SphereShape{{1, 2, 3}, 0.5}, box = BoxShape{{0, 0, 0}, {4, 2, 1}};
    const Shape cylinder = CylinderShape{{0, -1, 0}, {0, 3, 0}, 2, true};
    const Shape ellipsoid = EllipsoidShape{{0, 0, 0}, {1, 2, 3}};
    // Radius 1 about (1, 1, 1) in a box about it twice as large.
    const Shape ball = QuadricShape{{1, 1, 1, 0, 0, 0, -2, -2, -2, 2}, {-1, -1, -1}, {3, 3, 3}};
    const double half = std::sqrt(0.5);  // of 1, at 45 degrees
    const Affine moved{glm::dmat3(3.0, 0, 0, 0, 2, 0, 0, 0, 1), {0, 0, -20}},
        enlarged{glm::dmat3(1e25), {0, 0, 0}};
    return {
        {SphereShape{{0, 0, 0}, 1e-13}, {3e12, 0, 0}, {-1, 0, 0}, {0.75, 0.5}, enlarged},
        {cylinder, {0, 0, 9}, {0, 0, -1}, {0.5, 0.25}},
        {cylinder, {9, 1, 0}, {-1, 0, 0}, {0.75, 0.5}},
        {cylinder, {-9, 2, 0}, {1, 0, 0}, {0.25, 0.75}},
        {cylinder, {9, 1, 9}, {-1, 0, -1}, {0.625, 0.5}},
        {cylinder, {1, 9, 0}, {0, -1, 0}, {0.75, 1}},
        {cylinder, {-1, -9, 0}, {0, 1, 0}, {0.25, 0}},
        {cylinder, {0, 2, 9}, {0, 0, -1}, {0.5, 0.5}, moved},
        // Along x, longitude counts from -y, by way of -z.
        {CylinderShape{{0, 0, 0}, {4, 0, 0}, 1}, {1, -9, 0}, {0, 1, 0}, {0.5, 0.25}},
        {CylinderShape{{0, 0, 0}, {4, 0, 0}, 1}, {3, 0, -9}, {0, 0, 1}, {0.75, 0.75}},
        {ConeShape{{0, 0, 0}, {0, 4, 0}, 1}, {9, 1, 0}, {-1, 0, 0}, {0.75, 0.25}},
        {HyperboloidShape{{0, 0, 0}, {0, 4, 0}, 2, 1}, {0, 2, 9}, {0, 0, -1}, {0.5, 0.5}},
        {ParaboloidShape{{0, 4, 0}, {0, 0, 0}, 1}, {9, 3, 0}, {-1, 0, 0}, {0.75, 0.25}},
        {ellipsoid, {0, 0, 9}, {0, 0, -1}, {0.5, 0.5}},
        {ellipsoid, {0, 2 * half, 9}, {0, 0, -1}, {0.5, 0.75}},
        {ellipsoid, {half, 0, 9}, {0, 0, -1}, {0.625, 0.5}},
        {ball, {9, 1, 1}, {-1, 0, 0}, {0.75, 0.5}},
        {ball, {1, 9, 1}, {0, -1, 0}, {0.5, 1}},
        {sphere, {1, 2, 9}, {0, 0, -1}, {0.5, 0.5}},
        {sphere, {9, 2, 3}, {-1, 0, 0}, {0.75, 0.5}},
        {sphere, {-9, 2, 3}, {1, 0, 0}, {0.25, 0.5}},
        {sphere, {1, 9, 3}, {0, -1, 0}, {0.5, 1}},
        {sphere, {1, -9, 3}, {0, 1, 0}, {0.5, 0}},
        {sphere, {1, 2 + 0.25, 9}, {0, 0, -1}, {0.5, 0.5 + 1.0 / 6}},  // 30 degrees north
        {box, {1, 0.5, 9}, {0, 0, -1}, {0.25, 0.25}},
        {box, {1, 0.5, -9}, {0, 0, 1}, {0.75, 0.25}},
        {box, {9, 0.5, 0.25}, {-1, 0, 0}, {0.75, 0.25}},
        {box, {-9, 0.5, 0.25}, {1, 0, 0}, {0.25, 0.25}},
        {box, {1, 9, 0.25}, {0, -1, 0}, {0.25, 0.75}},
        {box, {1, -9, 0.25}, {0, 1, 0}, {0.25, 0.25}},
        {DiscShape{{0, 0, 0}, {0, 0, 1}, 2}, {1, 0.5, 5}, {0, 0, -1}, {0.75, 0.625}},
        {PolygonShape{{{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}}}, {3, 0.5, 5}, {0, 0, -1}, {0.75, 0.25}},
        {PlaneShape{{0, -5, 0}, {0, 1, 0}}, {3, 0, 7}, {0, -1, 0}, {3, -7}},
        {TriangleShape{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, {1, 2, 5}, {0, 0, -1}, {0.25, 0.5}}};
}

TEST_F(TextureTest, Coordinates) {
    for (const KnownUv& c : knownUvs()) {
        Scene scene = emptyScene();
        const uint32_t material = addTextured(scene, {CheckerTexture{}});
        scene.objects.push_back({"/objects/0", c.shape, material, c.transform});
        const PackedScene packed = packScene(scene);
        const RayHit hit =
            hitOf(packed, rayOf(vec3(c.from - packed.origin), vec3(glm::normalize(c.towards))));
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(hit.data.u, c.uv.x, 2e-6) << c.shape.index();
        EXPECT_NEAR(hit.data.v, c.uv.y, 2e-6) << c.shape.index();
    }
}

// A cap shows one end of a repeated image, for any rounding of its height.
TEST_F(TextureTest, CapsShowOneEndOfTheImage) {
    Scene scene = emptyScene();
    const Texture rows{ImageTexture{"q", quadImage(), Wrap::Repeat, Wrap::Repeat, TexelFilter::Nearest}};
    const dvec3 base(0.3, 0.1, -0.7), axis = glm::normalize(dvec3(0.37, 1, 0.21)), top = base + 1.7 * axis;
    scene.objects.push_back({"/objects/0", CylinderShape{base, top, 1, true}, addTextured(scene, rows), {}});
    std::vector<RayInput> rays;
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const dvec3 aside = glm::cross(axis, random.direction());
        rays.push_back(rayTowards(top + 5.0 * axis + 0.9 * aside, top + 0.9 * aside));
        rays.push_back(rayTowards(base - 5.0 * axis + 0.9 * aside, base + 0.9 * aside));
    }
    const std::vector<RayHit> hits = hitsOf(packScene(scene), rays);
    for (size_t i = 0; i < hits.size(); ++i) {
        ASSERT_TRUE(hits[i].hit);
        EXPECT_NEAR(hits[i].data.v, i % 2 == 0 ? 1 : 0, 1e-6);
        EXPECT_GE(hits[i].data.v, 0);
        EXPECT_LT(hits[i].data.v, 1);
    }
}

// Sphere and ellipsoid at the pole and at the seam, where fp32 rounds coordinates up to 1.
TEST_F(TextureTest, PolesAndSeamsShowOneEndOfTheImage) {
    for (const Shape& shape :
         {Shape(SphereShape{{0, 0, 0}, 1}), Shape(EllipsoidShape{{0, 0, 0}, {1, 2, 3}})}) {
        Scene scene = emptyScene();
        scene.objects.push_back({"/objects/0", shape, addTextured(scene, {CheckerTexture{}}), {}});
        std::vector<RayInput> rays;
        for (int i = -10; i <= 10; ++i) {
            const double aside = 1e-8 * i;
            rays.push_back(rayOf(vec3(aside, 5, 1e-8), vec3(0, -1, 0)));
            rays.push_back(rayOf(vec3(aside, 0, -5), vec3(0, 0, 1)));
        }
        for (const RayHit& hit : hitsOf(packScene(scene), rays)) {
            ASSERT_TRUE(hit.hit);
            EXPECT_LT(hit.data.u, 1);
            EXPECT_LT(hit.data.v, 1);
        }
    }
}

// The layer uv, of triangles and of all else.
TEST_F(TextureTest, LayersOfDeviceAndReferenceHaveTheSameCoordinates) {
    for (const char* name : {"textures", "textured_quadrics"}) {
        const Case c = fileCase(name, 24, 18);
        const Picture drawn = draw(device(), c), exact = reference::render(c.packed, wholeWithData(c));
        for (size_t i = 0; i < drawn.data.size(); ++i) {
            const PixelData &a = drawn.data[i], &b = exact.data[i];
            if (a.primitive != b.primitive) continue;
            EXPECT_NEAR(a.u, b.u, 1e-5 * (1 + std::abs(b.depth))) << name << " " << i;
            EXPECT_NEAR(a.v, b.v, 1e-5 * (1 + std::abs(b.depth))) << name << " " << i;
        }
    }
}

// Opaque below, holes above, for camera rays, mirrors and shadows; flat objects, the far side of a ball.
class MaskTest : public TextureTest {
  protected:
    static Scene maskScene() {
        Scene scene = emptyScene();
        Texture texture{ImageTexture{"q", quadImage(), Wrap::Clamp, Wrap::Clamp, TexelFilter::Nearest}};
        mask_ = addTextured(scene, std::move(texture));
        scene.materials[mask_].alphaCutoff = 0.5;
        scene.background = Color(9);
        return scene;
    }
    static inline uint32_t mask_ = 0;
};

TEST_F(MaskTest, CameraRaysPassHoles) {
    Scene scene = maskScene();
    addPolygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, mask_);
    Viewer viewer(device(), scene);
    EXPECT_EQ(viewer({0.25, 0.25, 2}, {0.25, 0.25, 0}).x, 3);
    EXPECT_EQ(viewer({0.25, 0.75, 2}, {0.25, 0.75, 0}).x, 9);
    scene.materials[mask_].alphaCutoff = 0;
    EXPECT_EQ(Viewer(device(), scene)({0.25, 0.75, 2}, {0.25, 0.75, 0}).x, 1);
}

TEST_F(MaskTest, MirrorsShowWhatIsBehindHoles) {
    Scene scene = maskScene();
    addPolygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, mask_);
    addPlane(scene, {0, 0, -3}, {0, 0, 1}, addMaterial(scene, Color(0), Color(1)));
    // Its image is clamped to the opaque row, as v < 0 below the point.
    addPlane(scene, {0, 50, 6}, {0, 0, -1}, mask_);
    Viewer viewer(device(), scene);
    // From behind the polygon into the mirror and back up to it.
    EXPECT_EQ(viewer({0.25, 0.25, -1}, {0.25, 0.25, -3}).x, 3);
    const float through = viewer({0.25, 0.75, -1}, {0.25, 0.75, -3}).x;
    EXPECT_TRUE(through == 3 || through == 4) << through;  // the far wall
}

TEST_F(MaskTest, ShadowsHaveHoles) {
    Scene scene = maskScene();
    addPolygon(scene, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, mask_);
    addPlane(scene, {0, 0, 0}, {0, 0, 1}, addMaterial(scene, Color(1)));
    scene.ambient = Color(0);
    scene.lights.push_back(DirectionalLight{{0, 0, -1}, Color(1)});
    Viewer viewer(device(), scene);
    EXPECT_EQ(viewer({0.25, 0.25, 0.5}, {0.25, 0.25, 0}).x, 0);
    EXPECT_NEAR(viewer({0.25, 0.75, 0.5}, {0.25, 0.75, 0}).x, 1, 1e-6);
}

// v = 1/2 is the equator: from above the inside of the lower half is seen through the open upper one.
TEST_F(MaskTest, OpenBallsShowTheirInside) {
    Scene scene = maskScene();
    addSphere(scene, {0, 0, 0}, 1, mask_);
    Viewer viewer(device(), scene);
    EXPECT_NEAR(viewer({0.3, 4, 0.3}, {0.3, -0.5, 0.3}).x, 4, 1e-6);  // u in (1/2, 3/4): the right texel
    EXPECT_EQ(viewer({0, 4, 4}, {0, 0.9, 0}).x, 9);                   // in and out through the upper half
}

// A ray continues behind a hole. A ray that hit the same hole again would run out of trips, and the repeated
// render by other traversals would hide it.
TEST_F(MaskTest, NoRayMeetsAHoleTwice) {
    Scene scene = maskScene();
    addSphere(scene, {0, 0, 0}, 1, mask_);
    aim(scene.camera, {0.3, 4, 0.3}, {0, 0, 0});
    const Case c = makeCase(scene, 16, 16);
    Renderer renderer(device(), c.packed, {.wholePaths = WholePaths::Off});
    draw(renderer, c);
    EXPECT_EQ(renderer.times().resumes, 0u);
}

// Each hole takes a trip, so rays through thousands of holes make more trips than lavapipe allows
// (trips_test.cpp), beside rays that end at once. The planes are a leaf of any size.
TEST_F(MaskTest, ThousandsOfHolesAreAllPassed) {
    Scene scene = maskScene();
    for (int i = 0; i < 2500; ++i) {
        const double z = -1e-3 * i;
        addPolygon(scene, {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}}, mask_);
    }
    for (int i = 0; i < 1000; ++i) addPlane(scene, {0, 0, -4 - 1e-3 * i}, {0, 0, 1}, mask_);
    aim(scene.camera, {0.5, 0.5, 3}, {0.5, 0.5, 0});
    scene.camera.projection = Projection::Orthographic;
    scene.camera.height = 1;
    const Case c = makeCase(scene, 16, 16);
    for (const WholePaths whole : {WholePaths::On, WholePaths::Off}) {
        const Picture picture = draw(device(), c, {.wholePaths = whole});
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                ASSERT_EQ(picture.color.at(x, y, 0), y < 8 ? 9 : (x < 8 ? 3 : 4)) << x << ", " << y;
    }
}

// On the cap v is the last float before 1, where the rows' weights are equal and alpha is 1/2 up to rounding.
TEST_F(MaskTest, AlphaAtTheCutoffIsAnOpenDecision) {
    auto image = std::make_shared<Image>(8, 8, 4, 1.0f);
    for (int i = 0; i < 64; ++i) image->at(i % 8, i / 8, 3) = static_cast<float>((i % 8 + i / 8) % 2);
    Scene scene = emptyScene();
    const uint32_t mask = addTextured(scene, {ImageTexture{"q", std::move(image)}});
    scene.materials[mask].alphaCutoff = 0.5;
    scene.background = Color(0.3);
    addObject(scene, CylinderShape{{0, -1, 0}, {0, 1, 0}, 1, true}, mask);
    aim(scene.camera, {0, 2, -4}, {0, 1, -1}, {0.1, 1, 0.05});
    scene.camera.fovY = 0.05;
    const verify::Report report = verified(makeCase(scene, 48, 48));
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_GT(report.explained(), 100u) << "the scene should have some";
    EXPECT_TRUE(report.passed());
}

// Verify explains pixels whose rays hit a checker's edge within rounding, and no others.
TEST_F(TextureTest, CheckerEdgesAreExplained) {
    Scene scene = emptyScene();
    const uint32_t material = addTextured(scene, {CheckerTexture{Color(1), Color(0)}, dvec2(400)});
    addPlane(scene, {0.1, 0, 0.3}, {0, 1, 0}, material);
    aim(scene.camera, {0.7, 1, 3}, {0.2, 0, 0});
    const Case c = makeCase(scene, 200, 150);
    const verify::Report report = verified(c);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_GT(report.edges, 0u) << "the scene should have some";
    EXPECT_LT(report.edges, 0.005 * 200 * 150);
}

// Packing leaves out the images of unused materials, and stores used ones once, whatever the number of
// textures.
TEST_F(TextureTest, ImagesAreStoredOnce) {
    Scene scene = emptyScene();
    const auto image = quadImage();
    addTextured(scene, {ImageTexture{"q", quadImage()}});
    addSphere(scene, {0, 0, 0}, 1, addTextured(scene, {ImageTexture{"q", image}}));
    addSphere(scene, {0, 0, 0}, 2, addTextured(scene, {ImageTexture{"q", image, Wrap::Clamp}}));
    const PackedScene packed = packScene(scene);
    EXPECT_EQ(packed.textures.size(), 2u);
    EXPECT_EQ(packed.texels.size(), 4u);
    EXPECT_TRUE(packed.features.textures);
    EXPECT_FALSE(packed.features.checkers);
}

}  // namespace glint::render::test::texture_test
