// Every scene of the repository, pixel by pixel against the reference.
#include <algorithm>
#include <cmath>

#include "reference/instance.h"
#include "reference/render.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::scenes_test {
namespace {

using glm::dvec3;

constexpr double kUnit = 0x1p-24;

// What rounding may do to the first hit of a pixel, for pixels that hit the same primitive as the reference.
//
// Let D be the greatest distance from the eye to a point that the primitive is given by, c = |n.d|. The
// camera ray's direction is good to 8 units (src/reference/ray_mover.h), which moves a hit by at most 8
// sqrt(3) u t along the ray's sides, that is by 14 u D. A sphere's discriminant errs by 22 u r D (o - centre,
// b, the perpendicular part and the subtraction, about 20 roundings of numbers up to D), its root r c by half
// of that over r c, so t by 11 u D / c; q and the last division add 10 u D. A plane's t errs by 14 u D / c
// (docs/numerics.md 2.5: gamma_7 of both sums), a triangle's by its edge functions, below. Doubled for second
// order: 64 u D / c for t. The normal of a sphere turns by that over its radius.
struct Bounds {
    double t, normal, uv;
};

double greatest(const dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Woop's weights: corners sheared to x, y <= S at depth <= Z err by gamma_5 (S + Z) each (PBRT 4th ed.,
// sec. 6.8.7) and 14 u Z from the direction; an edge function then by 2 S times twice that and gamma_2 S^2
// more, a weight by four times that over the determinant (its own error and those of the three terms of the
// determinant).
double weightBound(const shared::Triangle& triangle, const reference::Ray& ray, double determinant,
                   double& reach) {
    double spread = 0, depth = 0;
    for (const glm::vec3& corner : {triangle.v0, triangle.v1, triangle.v2}) {
        const dvec3 v = dvec3(corner) - ray.origin;
        depth = std::max(depth, glm::length(v));
        spread = std::max(spread, glm::length(v - glm::dot(v, ray.direction) * ray.direction));
    }
    reach = depth;
    const double corner = 5 * kUnit * (2 * spread + depth) + 14 * kUnit * depth;
    return 4 * (4 * spread * corner + 2 * kUnit * spread * spread) / determinant + 4 * kUnit;
}

Bounds triangleBounds(const PackedScene& scene, uint32_t index, const reference::Ray& ray) {
    const shared::Triangle& triangle = scene.triangles[index];
    const dvec3 v0(triangle.v0), v1(triangle.v1), v2(triangle.v2);
    const dvec3 area = glm::cross(v1 - v0, v2 - v0);
    // Seen along the ray; the shear along an axis only makes it larger.
    const double determinant = std::abs(glm::dot(area, ray.direction));
    double reach = 0;
    Bounds bounds{};
    bounds.uv = weightBound(triangle, ray, determinant, reach);
    const double cosine = determinant / glm::length(area);
    // The weights move the point on the triangle; t follows by the corners' depths.
    bounds.t =
        64 * kUnit * reach / cosine + 2 * bounds.uv * std::max(glm::length(v1 - v0), glm::length(v2 - v0));
    bounds.normal = 4 * kUnit;
    const uint32_t corners = scene.triangleSurfaces[index].vertexNormals;
    if (corners != shared::kNone) {
        const shared::VertexNormals& n = scene.vertexNormals[corners];
        const double turn = glm::length(dvec3(n.n1) - dvec3(n.n0)) + glm::length(dvec3(n.n2) - dvec3(n.n0));
        // The sum of unit normals that differ little is about 1 long, and 1/2 at the least in these scenes;
        // 16 roundings.
        bounds.normal = 2 * (bounds.uv * turn + 16 * kUnit);
    }
    return bounds;
}

// Of a triangle in an instance. There the ray has been transformed, which errs by 3 units in sums up to
// |A| |A^-1| times as large as what they come to: as many times the 19 units for each part of the depth that
// weightBound knows already, and more. Normals go back by a matrix of that condition.
Bounds instanceBounds(const PackedScene& scene, const reference::Hit& hit, const reference::Ray& ray) {
    reference::Ray local = reference::InstanceFrame(scene.instances[hit.instance]).enterInstance(ray);
    const double stretch = glm::length(local.direction);
    local.direction /= stretch;
    const Bounds bounds = triangleBounds(scene, hit.primitive & shared::kPrimitiveIndexMask, local);
    const double gain = 1 + scene.instanceGain;
    return {gain * bounds.t / stretch, gain * scene.instanceGain * bounds.normal, gain * bounds.uv};
}

// The normal turns with the gradient 2 T^t (Q y + g), by 2 |T^t Q T| over its length for each unit of way.
Bounds quadricBounds(const PackedScene& scene, const reference::Hit& hit, const reference::Ray& ray,
                     const reference::Surface& surface, double cosine) {
    const shared::Quadric& q = scene.quadrics[hit.primitive & shared::kLeafFirstMask];
    const glm::dmat3 toLocal =
        glm::transpose(glm::dmat3(dvec3(q.toLocal0), dvec3(q.toLocal1), dvec3(q.toLocal2)));
    const dvec3 y = toLocal * (surface.position - dvec3(q.point));
    const glm::dmat3 squares(q.squares.x, q.products.z, q.products.y, q.products.z, q.squares.y, q.products.x,
                             q.products.y, q.products.x, q.squares.z);
    const glm::dmat3 turning = glm::transpose(toLocal) * squares * toLocal;
    const double most = glm::length(turning[0]) + glm::length(turning[1]) + glm::length(turning[2]);
    const double slope = glm::length(glm::transpose(toLocal) * (squares * y + dvec3(q.linear)));
    const double reach = glm::length(dvec3(q.point) - ray.origin) + hit.t;
    const double t = 64 * kUnit * reach / cosine;
    const bool side = (hit.primitive >> shared::kPartShift & shared::kPartMask) == 0;
    return {t, side ? most / slope * t + 16 * kUnit : 8 * kUnit, 0};
}

Bounds boundsOf(const PackedScene& scene, const reference::Hit& hit, const reference::Ray& ray,
                const reference::Surface& surface) {
    const uint32_t kind = hit.primitive >> shared::kPrimitiveKindShift;
    const uint32_t index = hit.primitive & shared::kPrimitiveIndexMask;
    if (kind == shared::kKindTriangle) {
        return hit.instance == shared::kNone ? triangleBounds(scene, index, ray)
                                             : instanceBounds(scene, hit, ray);
    }
    const double cosine = std::abs(glm::dot(surface.geometricNormal, ray.direction));
    if (kind == shared::kKindPlane) {
        const double reach = glm::length(dvec3(scene.planes[index].point) - ray.origin) + hit.t;
        return {64 * kUnit * reach / cosine, 4 * kUnit, 0};
    }
    if (kind == shared::kKindPolygon) {
        // The plane's t, or that of a vertex.
        double reach = hit.t;
        for (const shared::PolygonVertex& v : scene.polygonVertices)
            reach = std::max(reach, glm::length(dvec3(v.position) - ray.origin));
        return {64 * kUnit * reach / cosine, 4 * kUnit, 0};
    }
    if (kind == shared::kKindDisc) {
        const double reach = glm::length(dvec3(scene.discs[index].center) - ray.origin) + hit.t;
        return {64 * kUnit * reach / cosine, 4 * kUnit, 0};
    }
    if (kind == shared::kKindCuboid) {
        const double reach = glm::length(dvec3(scene.cuboids[hit.primitive & shared::kLeafFirstMask].point)) +
                             glm::length(ray.origin) + hit.t;
        return {64 * kUnit * reach / cosine, 8 * kUnit, 0};
    }
    if (kind == shared::kKindQuadric) return quadricBounds(scene, hit, ray, surface, cosine);
    const shared::Sphere& sphere = scene.spheres[index];
    const bool anchored = sphere.anchorNormal != glm::vec3(0);
    const double reach =
        glm::length(dvec3(sphere.point) - ray.origin) + (anchored ? hit.t : double(sphere.radius));
    const double t = 64 * kUnit * reach / cosine;
    return {t, t / sphere.radius + 8 * kUnit, 0};
}

class SceneTest : public RenderTest, public testing::WithParamInterface<std::string> {
  protected:
    struct Counts {
        size_t ids = 0, hashes = 0, shadows = 0, colors = 0;
        size_t normals = 0, roughNormals = 0;  // compared; off by more than 1e-5, in instances by more
    };
    // Ids, shadow bits and colours that differ are counted; where the ids agree, everything else must.
    Counts compare(const Case& c, const Picture& device);
    void comparePixel(const Case& c, const reference::Tracer& tracer, int x, int y, const PixelData& data,
                      const PixelData& expected, Counts& counts);
};

void SceneTest::comparePixel(const Case& c, const reference::Tracer& tracer, int x, int y,
                             const PixelData& data, const PixelData& expected, Counts& counts) {
    if (expected.object == PixelData::kNoIndex) {
        EXPECT_EQ(data.depth, std::numeric_limits<double>::infinity());
        EXPECT_EQ(data.material, PixelData::kNoIndex);
        EXPECT_EQ(data.shadowBits, 0u);
        return;
    }
    reference::Ray ray = tracer.cameraRay(c.camera, x + 0.5, y + 0.5);
    ray.ties = true;  // as the rays of the picture
    const std::optional<reference::Hit> hit = tracer.closest(ray);
    ASSERT_TRUE(hit);
    const reference::Surface surface = tracer.surfaceAt(ray, *hit);
    const Bounds bounds = boundsOf(c.packed, *hit, ray, surface);
    const std::string where = "pixel " + std::to_string(x) + "," + std::to_string(y);
    EXPECT_EQ(data.material, surface.material) << where;
    const double turn = glm::length(dvec3(data.normal) - surface.shadingNormal);
    EXPECT_LE(turn, bounds.normal) << where;
    ++counts.normals;
    // Small triangles of an instance are far away by its own measure.
    const bool instanced = hit->instance != shared::kNone;
    counts.roughNormals += turn > 1e-5 * (instanced ? 1 + c.packed.instanceGain : 1);
    EXPECT_LE(glm::length(dvec3(data.geometricNormal) - surface.geometricNormal), bounds.normal) << where;
    EXPECT_EQ(expected.geometricNormal, glm::vec3(surface.geometricNormal)) << where;
    EXPECT_NEAR(data.depth, expected.depth, bounds.t) << where;
    // Of other surfaces the device gives texture coordinates, which texture_test.cpp judges.
    if (hit->primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle) {
        EXPECT_NEAR(data.u, expected.u, bounds.uv) << where;
        EXPECT_NEAR(data.v, expected.v, bounds.uv) << where;
    }
    // The hit point moves along the ray with t, and across it with the direction and its own rounding.
    const double across = 32 * kUnit * (expected.depth + greatest(surface.position) + greatest(ray.origin));
    EXPECT_LE(glm::length(data.position - expected.position), bounds.t + across) << where;
}

SceneTest::Counts SceneTest::compare(const Case& c, const Picture& device) {
    const Picture expected = reference::render(c.packed, c.camera, wholeWithData(c));
    const reference::Tracer tracer(c.packed);
    Counts counts;
    for (int y = 0; y < c.height; ++y) {
        for (int x = 0; x < c.width; ++x) {
            const PixelData& data = device.at(x, y);
            const PixelData& pixel = expected.at(x, y);
            const bool sameId = data.object == pixel.object && data.primitive == pixel.primitive;
            counts.ids += !sameId;
            counts.hashes += data.pathHash != pixel.pathHash || data.bounces != pixel.bounces;
            counts.shadows += data.shadowBits != pixel.shadowBits;
            const dvec3 color(device.color.at(x, y, 0), device.color.at(x, y, 1), device.color.at(x, y, 2));
            counts.colors += !(greatest(color - expected.exactAt(x, y)) <= 1.0 / 512);
            EXPECT_EQ(device.color.at(x, y, 3) > 0, data.object != PixelData::kNoIndex);
            if (sameId) comparePixel(c, tracer, x, y, data, pixel, counts);
        }
    }
    return counts;
}

TEST_P(SceneTest, AgreesWithTheReference) {
    const Case c = fileCase(GetParam(), 160, 120);
    Renderer renderer(device(), c.packed);
    verify::Options options;
    options.width = c.width;
    options.height = c.height;
    const verify::Report report = verify::verify(renderer, c.packed, c.camera, options);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_TRUE(report.passed()) << report.explained() << " explained pixels of " << report.pixels;
    EXPECT_EQ(report.pixels, 160u * 120u);

    const Picture picture = draw(renderer, c);
    EXPECT_EQ(picture.notFinite, 0u);
    const Counts counts = compare(c, picture);
    // A pixel that verify passed over has the reference's path; and its colour, where no pixel's own
    // predicted error is larger than that of a byte.
    EXPECT_LE(counts.hashes, report.explained());
    EXPECT_LE(counts.ids, counts.hashes);
    if (verify::classOf(report.sensitivity.kappa) == verify::StiffnessClass::NonStiff) {
        EXPECT_LE(counts.colors, report.explained());
    }
    EXPECT_LE(static_cast<double>(counts.shadows), 160 * 120 / 1000);
    // The bounds are for the worst pixel, grazed or far away; few come near them.
    EXPECT_LE(counts.roughNormals, counts.normals / 100);
    // A picture of nothing, or of one thing alone, would prove little.
    EXPECT_LT(std::count_if(picture.data.begin(), picture.data.end(),
                            [](const PixelData& d) { return d.object == PixelData::kNoIndex; }),
              160 * 120 * 3 / 4);
}

INSTANTIATE_TEST_SUITE_P(All, SceneTest, testing::ValuesIn(sceneNames()),
                         [](const auto& p) { return p.param; });

}  // namespace
}  // namespace glint::render::test::scenes_test
