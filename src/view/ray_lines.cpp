#include "view/ray_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint::view {

// A camera ray of film point (x, y) starts at eye + x ox + y oy and goes along center + x sx + y sy
// (shaders/generate.comp), so a point is at the (x, y) that solve a linear equation: with parallel rays
// p - eye = x ox + y oy + t center, else p - eye = t (x sx + y sy + center).
std::optional<Segment> projected(const shared::Camera& camera, const glm::dvec3& from, const glm::dvec3& to) {
    const bool parallel = camera.originStepX != glm::vec3(0);
    const glm::dmat3 film(parallel ? glm::dvec3(camera.originStepX) : glm::dvec3(camera.stepX),
                          parallel ? glm::dvec3(camera.originStepY) : glm::dvec3(camera.stepY),
                          glm::dvec3(camera.center));
    const glm::dmat3 inverse = glm::inverse(film);
    const glm::dvec3 eye(camera.eye);
    glm::dvec3 a = inverse * (from - eye), b = inverse * (to - eye);
    const double least = 1e-6 * std::max({std::abs(a.z), std::abs(b.z), 1e-12});
    if (!parallel) {
        if (a.z < least && b.z < least) return std::nullopt;
        if (a.z < least) a = glm::mix(a, b, (least - a.z) / (b.z - a.z));
        if (b.z < least) b = glm::mix(b, a, (least - b.z) / (a.z - b.z));
        a = {a.x / a.z, a.y / a.z, 1};
        b = {b.x / b.z, b.y / b.z, 1};
    }
    const glm::dvec2 middle(camera.halfWidth, camera.halfHeight);
    const Segment segment = {middle + glm::dvec2(a), middle + glm::dvec2(b)};
    const bool finite = std::isfinite(segment.from.x) && std::isfinite(segment.from.y) &&
                        std::isfinite(segment.to.x) && std::isfinite(segment.to.y);
    return finite ? std::optional(segment) : std::nullopt;
}

}  // namespace glint::view
