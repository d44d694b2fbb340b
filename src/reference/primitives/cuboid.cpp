// Ray against box. Unlike the shader, it tests each of the six faces as a parallelogram.
#include <algorithm>
#include <cmath>

#include "core/vectors.h"
#include "reference/intersect.h"
#include "reference/rounding.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// Widens each face, so that an edge belongs to both of its faces despite rounding.
constexpr double kEdgeSlack = 0x1p-58;

// A ray in distances from the box's point along the normals of its faces.
struct Seen {
    Sum<Extended> o[3], d[3];

    Seen(const rows::Cuboid& c, const PreparedRay& ray) {
        const glm::dmat3 normals = rowsOf(c);
        for (int i = 0; i < 3; ++i) {
            const auto n = toVec<Extended>(normals[i]);
            o[i] = sumOfProducts(n, toVec<Extended>(ray.origin) - toVec<Extended>(c.point));
            d[i] = sumOfProducts(n, toVec<Extended>(ray.direction));
        }
        if (ray.noise.step == 0) return;
        // fp32 rounds each height and speed by itself, which moves nearly parallel faces against each other.
        // Height: five roundings of its terms; speed: three, and its quotient and product in t five more.
        uint64_t state = ray.noise.seed ^ c.id;
        for (int i = 0; i < 3; ++i) {
            o[i].value += std::min(ray.noise.step, gammaOf(5)) * uniform(state) * o[i].terms;
            d[i].value += std::min(ray.noise.step, gammaOf(8)) * uniform(state) * d[i].terms;
        }
    }
    // t at the plane y_axis = height; d[axis] is not 0.
    Extended reach(int axis, Extended height) const { return (height - o[axis].value) / d[axis].value; }
    bool isBetween(const rows::Cuboid& c, int axis, Extended t) const {
        const Extended y = o[axis].value + t * d[axis].value;
        const Extended slack = kEdgeSlack * (o[axis].terms + std::abs(t) * d[axis].terms +
                                             std::abs(static_cast<Extended>(c.hi[axis])) +
                                             std::abs(static_cast<Extended>(c.lo[axis])));
        return y >= c.lo[axis] - slack && y <= c.hi[axis] + slack;
    }
};

}  // namespace

bool intersect(const rows::Cuboid& c, const RayTest& test, Root& root) {
    const Seen seen(c, test.ray);
    bool found = false, leaves = false;
    for (uint32_t face = 0; face < 6; ++face) {
        const int axis = static_cast<int>(face / 2);
        if (seen.d[axis].value == 0) continue;
        const double plane = face & 1 ? c.hi[axis] : c.lo[axis];
        const Extended t = seen.reach(axis, plane);
        if (found && static_cast<double>(t) > root.t) continue;
        if (!seen.isBetween(c, (axis + 1) % 3, t) || !seen.isBetween(c, (axis + 2) % 3, t)) continue;
        const double slip = slipOfFace(c, axis, plane, seen.d[axis].value, t, test.ray);
        if (!countsAt(test.ray, static_cast<double>(t), slip, test.tMax)) continue;
        const bool leavesHere = (face & 1) == (seen.d[axis].value > 0 ? 1u : 0u);
        if (found && static_cast<double>(t) == root.t) {
            root.twice = root.twice || leavesHere != leaves;
            continue;
        }
        root = {.t = static_cast<double>(t), .slip = slip, .part = face};
        leaves = leavesHere;
        found = true;
    }
    return found;
}

void surfaceOf(const rows::Cuboid& c, const Place& place, Surface& surface) {
    const glm::dmat3 normals = rowsOf(c);
    const int axis = static_cast<int>(place.part() / 2);
    const bool upper = place.part() % 2 == 1;
    const dvec3 normal = glm::normalize(normals[axis]);
    const double distance =
        glm::dot(normals[axis], place.point - c.point) - (upper ? c.hi[axis] : c.lo[axis]);
    surface.position = place.point - distance * normal;
    surface.error = errorBox(surface.position - c.point, c.point);
    surface.scale = greatestMagnitude(reachFrom(glm::abs(c.point), c));
    surface.geometricNormal = upper ? normal : -normal;
    // The point's fractions of the box along x, y and z. Seen from outside, v goes up the sides and u goes to
    // the right.
    const dvec3 offset = surface.position - c.point;
    dvec3 share, sums;
    for (int i = 0; i < 3; ++i) {
        share[i] = (glm::dot(normals[i], offset) - c.lo[i]) / (c.hi[i] - c.lo[i]);
        sums[i] =
            (2 * glm::dot(glm::abs(normals[i]), glm::abs(offset)) + std::abs(c.lo[i])) / (c.hi[i] - c.lo[i]);
    }
    const double u[6] = {share.z, 1 - share.z, share.x, share.x, 1 - share.x, share.x};
    const double v[6] = {share.y, share.y, share.z, 1 - share.z, share.y, share.y};
    surface.uv = {u[place.part()], v[place.part()]};
    surface.uvScale = {axis == 0 ? sums.z : sums.x, axis == 1 ? sums.z : sums.y};
}

}  // namespace glint::reference
