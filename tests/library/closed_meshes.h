// Closed meshes, and rays aimed at their corners and edges and along their planes.
#pragma once

#include <cmath>
#include <cstdlib>
#include <glm/gtc/type_ptr.hpp>
#include <random>
#include <utility>

#include "support.h"
#include "support/packed_scene_maker.h"

namespace glint::library::test {

// So many as usual, or as the environment says.
inline size_t aimedRays(size_t usual) {
    const char* wanted = std::getenv("GLINT_AIMED_RAYS");
    return wanted == nullptr ? usual : std::strtoull(wanted, nullptr, 10);
}

struct Closed {
    std::vector<D3> vertices;
    std::vector<U3> corners;
    double inner, outer;  // a ball about 0 that is inside, one that holds everything

    std::vector<D3> movedBy(double offset) const {
        std::vector<D3> moved = vertices;
        for (D3& v : moved) v += offset;
        return moved;
    }
};

// Star-shaped about 0, spikes and dents (tests/support/packed_scene_maker.h).
inline Closed bumpy(uint32_t steps = 16) {
    const glint::test::ClosedMesh mesh = glint::test::makeBumpyMesh(7, steps);
    return {mesh.vertices, mesh.triangles, 0.2, 7};
}
inline Closed gridCube(uint32_t n) {
    const glint::test::ClosedMesh mesh = glint::test::gridCube(n);
    return {mesh.vertices, mesh.triangles, 0.9, 2};
}

// By a transform of the C API: three rows of four.
inline D3 moved(const double* rows, const D3& v) {
    const glm::dmat3x4 columns = glm::make_mat3x4(rows);
    return glm::dvec4(v, 1) * columns;
}

// Planes: parallel to an axis, level with a corner.
enum class Aim { Corners, Edges, Planes };

struct Random {
    std::mt19937_64 engine;
    explicit Random(uint64_t seed) : engine(seed) {}
    double uniform() { return std::uniform_real_distribution<double>(0, 1)(engine); }
    size_t index(size_t count) { return std::uniform_int_distribution<size_t>(0, count - 1)(engine); }
    D3 direction() {
        std::normal_distribution<double> normal;
        const D3 v = {normal(engine), normal(engine), normal(engine)};
        return v / glm::length(v);
    }
    // From where to where.
    std::pair<D3, D3> aimed(const Closed& mesh, Aim aim, bool inside);
};

// A point of the mesh to aim at.
inline D3 targetOf(const Closed& mesh, Aim aim, Random& random) {
    const U3& triangle = mesh.corners[random.index(mesh.corners.size())];
    const D3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]];
    if (aim == Aim::Corners) return a;
    return a + random.uniform() * (b - a);
}

inline std::pair<D3, D3> Random::aimed(const Closed& mesh, Aim aim, bool inside) {
    const D3 out = direction();
    const double far = inside ? mesh.inner * uniform() : mesh.outer * (1 + uniform());
    D3 from = far * out;
    D3 to = targetOf(mesh, aim == Aim::Planes ? Aim::Corners : aim, *this);
    if (aim != Aim::Planes) return {from, to};
    const auto axis = static_cast<int>(index(3));
    if (!inside) {
        from = to;
        from[axis] = -3 * mesh.outer;
        return {from, to};
    }
    // Level with it along one axis, and within the ball.
    const int other = (axis + 1) % 3;
    from *= 0.5;
    from[other] = std::abs(to[other]) < 0.5 * mesh.inner ? to[other] : 0;
    to = from;
    to[axis] += 1;
    return {from, to};
}

// From a sphere around the scene's box to points in it.
inline RayList raysInto(const glint_scene* scene, size_t count, uint32_t seed) {
    GLINT_INIT(glint_scene_info, info);
    EXPECT_OK(glint_scene_info_of(scene, &info));
    const D3 lo = glm::make_vec3(info.lower), size = glm::make_vec3(info.upper) - lo;
    Random random(seed);
    RayList rays;
    for (size_t i = 0; i < count; ++i) {
        const D3 to = lo + size * D3{random.uniform(), random.uniform(), random.uniform()};
        const D3 from = to + 2 * std::max({size.x, size.y, size.z}) * random.direction();
        rays.add(from, to - from);
    }
    return rays;
}

}  // namespace glint::library::test
