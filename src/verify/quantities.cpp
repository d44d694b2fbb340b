#include "verify/quantities.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vectors.h"

namespace glint::verify {

namespace {

constexpr size_t kDepth = 3, kPosition = 4, kNormal = 7, kGeometric = 10, kU = 13, kV = 14, kClearance = 19;

// Quantities in the order of kQuantityNames.
template <typename... Numbers>
Quantities listed(Numbers... numbers) {
    return {static_cast<double>(numbers)...};
}

}  // namespace

Quantities quantitiesOf(const reference::PixelRecord& record, const glm::dvec3& origin) {
    const glm::dvec3 c = record.color;
    if (!record.hit) return listed(c.x, c.y, c.z);
    const reference::Surface& s = *record.surface;
    const glm::dvec3 p = origin + s.position, n = s.shadingNormal, g = s.geometricNormal;
    const glm::dvec2 uv = record.hit->isTriangle() ? glm::dvec2(record.hit->u, record.hit->v) : s.uv;
    const double clearance = reference::clearanceOf(s.error, g);
    return listed(c.x, c.y, c.z, record.hit->t, p.x, p.y, p.z, n.x, n.y, n.z, g.x, g.y, g.z, uv.x, uv.y,
                  record.shadowBits, s.object, s.primitive, s.material,
                  std::isnan(clearance) ? 0 : clearance);
}

Quantities quantitiesOf(const glm::vec3& c, const PixelData& data) {
    if (data.object == PixelData::kNoIndex) return listed(c.x, c.y, c.z);
    const glm::dvec3 p = data.position;
    const glm::vec3 n = data.normal, g = data.geometricNormal;
    return listed(c.x, c.y, c.z, data.depth, p.x, p.y, p.z, n.x, n.y, n.z, g.x, g.y, g.z, data.u, data.v,
                  data.shadowBits, data.object, data.primitive, data.material, data.clearance);
}

Reach reachOf(const PackedScene& scene, const reference::PixelRecord& record, const reference::Ray& ray) {
    const reference::Surface& surface = *record.surface;
    double way = record.hit->t + greatestMagnitude(ray.origin) + ray.originScale, slant = 1;
    if (record.hit->isTriangle()) {
        const double cosine = glm::dot(surface.geometricNormal, glm::normalize(ray.direction));
        slant = 1 / std::max(std::abs(cosine), kFloatUnit);
        way += surface.scale * slant;
    } else {
        way += greatestMagnitude(surface.position);
    }
    const double gain = record.hit->instance == shared::kNone ? 0 : scene.instanceGain;
    return {way, 12 + reference::normalError(surface.bend, way, gain), slant};
}

// t and each coordinate of a point are sums of a dozen products: 16 units with the last rounding, of numbers
// up to the way, the eye's coordinates and a triangle's corners. Normals take as many units of numbers up to
// 1. A camera that moves with the scene's origin rounds the sum once more.
//
// The clearance is a sum of magnitudes, which rounding cannot cancel. It errs by at most 4096 units of 2^-24,
// and by the floors of its terms: point, normal (of a quadric its gradient) and barycentrics. On a cone it
// may be unknown where the two places of measurement change over.
Quantities floorsOf(const PackedScene& scene, const reference::PixelRecord& record,
                    const reference::Ray& ray) {
    Quantities f{};
    for (int i = 0; i < 3; ++i) f[static_cast<size_t>(i)] = record.rounding[i] + kUnderflow;
    if (!record.hit) return f;
    const reference::Surface& surface = *record.surface;
    const auto [way, turn, slant] = reachOf(scene, record, ray);
    f[kDepth] = 16 * kFloatUnit * way;
    for (size_t i = 0; i < 3; ++i) {
        f[kPosition + i] = 16 * kFloatUnit * way + 0x1p-50 * greatestMagnitude(scene.origin);
        f[kNormal + i] = f[kGeometric + i] = turn * kFloatUnit;
    }
    f[kU] = reference::kUvRoundings * kFloatUnit * slant * std::max(1.0, surface.uvScale.x);
    f[kV] = reference::kUvRoundings * kFloatUnit * slant * std::max(1.0, surface.uvScale.y);
    const glm::dvec3 error = surface.error;
    const double corners = record.hit->isTriangle() ? 4 * (f[kU] + f[kV]) * surface.scale : 0;
    f[kClearance] = std::max(0x1p-12, 6 * f[kNormal]) * (error.x + error.y + error.z) +
                    2 * reference::gammaOf(16) * f[kPosition] + reference::gammaOf(7) * corners;
    if (std::isnan(f[kClearance])) f[kClearance] = std::numeric_limits<double>::infinity();
    return f;
}

void Box::add(const glm::dvec3& value, const glm::dvec3& error) {
    for (int i = 0; i < 3; ++i) {
        lo.push_back(value[i]);
        hi.push_back(value[i]);
        floors.push_back(error[i]);
    }
}

void Box::include(const Box& other) {
    for (size_t i = 0; i < lo.size(); ++i) {
        lo[i] = std::min(lo[i], other.lo[i]);
        hi[i] = std::max(hi[i], other.hi[i]);
        floors[i] = std::max(floors[i], other.floors[i]);
    }
}

bool Box::contains(size_t at, double value, double stretch) const {
    const double room = floors[at] + stretch * (hi[at] - lo[at]);
    return (value >= lo[at] - room && value <= hi[at] + room) || std::isinf(room);
}

bool Box::contains(size_t at, std::span<const double> values, double stretch) const {
    return std::all_of(values.begin(), values.end(),
                       [&](const double& value) { return contains(at++, value, stretch); });
}

}  // namespace glint::verify
