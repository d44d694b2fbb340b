#include "trace/ray_batch.h"

#include <cmath>
#include <cstdio>

namespace glint {

double LocalRay::worldT(double t) const {
    return std::scalbn(t, -exponent);
}

LocalRay rescaledRay(const LocalRay& ray, double greatest) {
    LocalRay local = ray;
    if (!std::isfinite(greatest)) return local;  // it misses
    if (greatest < kShortestDirection) {
        local.direction = glm::dvec3(0);
        return local;
    }
    const int exponent = std::ilogb(greatest);
    for (int axis = 0; axis < 3; ++axis)
        local.direction[axis] = std::scalbn(local.direction[axis], -exponent);
    local.tMin = std::scalbn(local.tMin, exponent);
    local.tMax = std::scalbn(local.tMax, exponent);
    local.exponent = exponent;
    return local;
}

std::string hitCsv(const WorldHit& hit, int digits, bool anyOnly) {
    if (!hit.hit) return "0,,,,,,,,,,,\n";
    if (anyOnly) return "1,,,,,,,,,,,\n";
    char line[512];
    std::snprintf(line, sizeof(line), "1,%.*g,%.*g,%.*g,%u,%u,%.*g,%.*g,%.*g,%.*g,%.*g,%.*g\n", digits, hit.t,
                  digits, hit.u, digits, hit.v, hit.object, hit.face, digits, hit.point.x, digits,
                  hit.point.y, digits, hit.point.z, digits, hit.normal.x, digits, hit.normal.y, digits,
                  hit.normal.z);
    return line;
}

WorldHit hitOf(const PixelData& data) {
    WorldHit hit;
    hit.cost = data.cost;
    if (data.object == PixelData::kNoIndex) return hit;
    hit.hit = true;
    hit.t = data.depth;
    hit.u = data.u;
    hit.v = data.v;
    hit.point = data.position;
    hit.normal = glm::dvec3(data.geometricNormal);
    hit.object = data.object;
    hit.face = data.primitive;
    hit.material = data.material;
    return hit;
}

}  // namespace glint
