// Rays that leave surfaces: glint_hits.origin and GLINT_RAYS_LEAVE.
#include "closed_meshes.h"

namespace glint::library::test {
namespace {

using glm::dvec3;

class LibraryLeaving : public LibraryTest {
  protected:
    // Hits of rays from `distance` around `center`, aimed at places within `spread` of it.
    Found hitsAround(const dvec3& center, double distance, double spread) {
        Random random(5);
        RayList rays;
        for (int i = 0; i < 500; ++i) {
            const dvec3 from = center + distance * random.direction();
            rays.add(from, center + spread * random.direction() - from);
        }
        return hitsOf(rays);
    }
    Found hitsOf(const RayList& rays) {
        const Found left = closest(rays.rays());
        EXPECT_EQ(left.hit, std::vector<uint8_t>(rays.size(), 1));
        return left;
    }
    // Share of the rays that hit anything: 20 from each origin, over the hemisphere about side * normal.
    double occluded(const std::vector<D3>& origins, const std::vector<D3>& normals, double side = 1) {
        Random random(6);
        RayList leaving;
        for (size_t i = 0; i < origins.size(); ++i) {
            for (int k = 0; k < 20; ++k) {
                const dvec3 way = random.direction();
                leaving.add(origins[i], way * (glm::dot(way, normals[i]) * side < 0 ? -1.0 : 1.0));
            }
        }
        glint_rays rays = leaving.rays();
        rays.flags = GLINT_RAYS_LEAVE;
        const std::vector<uint8_t> hit = any(rays);
        return static_cast<double>(std::count(hit.begin(), hit.end(), 1)) / static_cast<double>(hit.size());
    }
    // A ball of triangles, and with sphere a primitive.
    void addBall(bool isSphere, double center, double radius) {
        if (isSphere) {
            addSpheres(scene(), {{center, center, center}}, {radius});
            return;
        }
        // An octahedron, each face cut in four: convex.
        std::vector<D3> vertices;
        for (int octant = 0; octant < 8; ++octant) {
            const dvec3 x(octant & 1 ? 1 : -1, 0, 0), y(0, octant & 2 ? 1 : -1, 0),
                z(0, 0, octant & 4 ? 1 : -1);
            const bool isFlipped = x.x * y.y * z.z < 0;
            for (const auto& face :
                 {std::array{x, x + y, x + z}, {y, y + z, x + y}, {z, x + z, y + z}, {x + y, y + z, x + z}})
                for (const int corner : {0, isFlipped ? 2 : 1, isFlipped ? 1 : 2})
                    vertices.push_back(center + radius * glm::normalize(face[corner]));
        }
        addMesh(vertices);
    }
};

TEST_F(LibraryLeaving, ConvexBallsHideNothingFromTheirSurface) {
    for (const bool isSphere : {false, true}) {
        for (const auto& [center, radius] : {std::pair(0.0, 1.0), {1e6, 1.0}, {3.0, 1e-3}, {0.0, 1e4}}) {
            useScene(nullptr);
            addBall(isSphere, center, radius);
            commit();
            const Found left = hitsAround(dvec3(center), 3 * radius, 0.4 * radius);
            EXPECT_EQ(occluded(left.origin, left.normal), 0) << isSphere << " " << center << " " << radius;
            std::vector<D3> inside;
            for (size_t i = 0; i < left.origin.size(); ++i)
                inside.push_back(2.0 * left.point[i] - left.origin[i]);
            EXPECT_EQ(occluded(inside, left.normal, -1), 1) << isSphere << " " << center << " " << radius;
        }
    }
}

// The triangles have no corner in common, so that the heights of rays above them round differently.
TEST_F(LibraryLeaving, RaysThatMissHaveNoOrigin) {
    addBall(false, 0, 1);
    commit();
    RayList rays;
    for (int i = 0; i < 100; ++i) rays.add({0, 0, 5}, {0, i % 2, -1});
    const Found found = closest(rays.rays());
    for (size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(found.hit[i], i % 2 == 0 ? 1 : 0);
        EXPECT_EQ(found.origin[i] == D3(0), i % 2 == 1) << i;
    }
}

TEST_F(LibraryLeaving, TwinsInOnePlaneAreNotHit) {
    const dvec3 x = glm::normalize(dvec3(3, 1, 2)), y = glm::normalize(glm::cross(dvec3(0, 1, 0.3), x));
    const dvec3 n = glm::cross(x, y);
    for (const double place : {0.0, 0.01, 5.0}) {
        const auto at = [&](double u, double v, double height = 0) {
            return place + u * x + v * y + height * n;
        };
        useScene(nullptr);
        addMesh<D3>({at(-1000, -900), at(1100, -950), at(20, 1500)});
        addMesh<D3>({at(0, 1), at(1, -1), at(-1, -1)});
        commit();
        RayList rays;
        Random random(7);
        for (int i = 0; i < 500; ++i) {
            const dvec3 from = at(random.uniform(), random.uniform(), 5);
            rays.add(from, at(0.3 * random.uniform(), 0.3 * random.uniform()) - from);
        }
        const Found left = hitsOf(rays);
        const std::vector<D3> up(left.origin.size(), n);
        EXPECT_EQ(occluded(left.origin, up), 0) << place;
        // A lid far above rounding and far wider than high is met.
        addMesh<D3>({at(-1e4, -1e4, 0.01), at(1e4, -1e4, 0.01), at(0, 2e4, 0.01)});
        commit();
        EXPECT_GT(occluded(left.origin, up), 0.99) << place;
    }
}

TEST_F(LibraryLeaving, IsNotForCountsAndCertainty) {
    addBall(false, 0, 1);
    commit();
    const std::vector<D3> from = {{0, 0, 5}}, along = {{0, 0, -1}};
    glint_rays rays = raysFrom(from, along);
    rays.flags = GLINT_RAYS_LEAVE;
    std::vector<uint32_t> count(1);
    const glint_out out = outOf(count);
    EXPECT_EQ(glint_query_count(scene(), &rays, &out, nullptr), GLINT_ERROR_ARGUMENT);
    std::vector<uint8_t> sure(1);
    GLINT_INIT(glint_hits, hits);
    hits.sure = outOf(sure);
    EXPECT_EQ(glint_query_closest(scene(), &rays, &hits, nullptr), GLINT_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace glint::library::test
