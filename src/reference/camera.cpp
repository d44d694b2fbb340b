// Camera rays (docs/reference/shading.md).
#include <algorithm>
#include <cmath>

#include "reference/scatter.h"
#include "reference/tracer.h"

namespace glint::reference {

using glm::dvec3;

Ray Tracer::cameraRay(const rows::Camera& camera, double x, double y, const glm::dvec2& lens) const {
    // From the middle of the film.
    const double right = x - camera.halfWidth, down = y - camera.halfHeight;
    const auto reach = [&](const dvec3& middle, const dvec3& stepX, const dvec3& stepY) {
        return greatestMagnitude(glm::abs(dvec3(middle)) + glm::abs(right * dvec3(stepX)) +
                                 glm::abs(down * dvec3(stepY)));
    };
    const dvec3 direction = dvec3(camera.center) + right * dvec3(camera.stepX) + down * dvec3(camera.stepY);
    Ray ray;
    ray.origin = dvec3(camera.eye) + right * dvec3(camera.originStepX) + down * dvec3(camera.originStepY);
    ray.direction = glm::normalize(direction);
    ray.originScale = reach(camera.eye, camera.originStepX, camera.originStepY);
    ray.directionScale =
        std::max(1.0, reach(camera.center, camera.stepX, camera.stepY) / glm::length(direction));
    if (camera.inverseFocus != 0) {
        const dvec3 aside = lens.x * dvec3(camera.lensX) + lens.y * dvec3(camera.lensY);
        const double focus = 1 / static_cast<double>(camera.inverseFocus);
        const dvec3 pinhole = ray.origin;
        ray.origin += aside;
        ray.direction = glm::normalize(pinhole + focus * direction - ray.origin);
        // Twice a pinhole's roundings: those of the lens point and its way to the focus.
        const double radius = glm::length(dvec3(camera.lensX));
        ray.originScale = 2 * (ray.originScale + radius);
        const double reached = glm::length(direction - aside / focus);
        ray.directionScale =
            2 * std::max(1.0, (reach(camera.center, camera.stepX, camera.stepY) + radius / focus) / reached);
    }
    ray.tMin = camera.nearT;
    if (camera.farT < shared::kInfinity) ray.tMax = camera.farT;
    return ray;
}

}  // namespace glint::reference
