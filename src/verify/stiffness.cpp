#include "verify/stiffness.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace glint::verify {

namespace {

double greatestChange(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = glm::abs(a - b);
    const double change = std::max({d.x, d.y, d.z});
    return std::isfinite(change) ? change : std::numeric_limits<double>::max();
}

// Other first hits at one t, to within gamma_16 on either side as in explain.cpp. Under jitter the reference
// tosses a coin there; the device has a rule, and must follow it.
bool isTie(const reference::PixelRecord& a, const reference::PixelRecord& b) {
    if (!a.hit || !b.hit || a.hit->id == b.hit->id) return false;
    return std::abs(a.hit->t - b.hit->t) <= 2 * 16 * kFloatUnit * std::max(a.hit->t, b.hit->t);
}

}  // namespace

double percentile99(std::vector<float> values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 99 / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double conditionNumber(const reference::Tracer& tracer, const shared::Camera& camera, int width, int height,
                       int seeds) {
    return sensitivityOf(tracer, camera, width, height, 0, seeds).kappa;
}

Sensitivity sensitivityOf(const reference::Tracer& tracer, const shared::Camera& camera, int width,
                          int height, double tolerance, int seeds) {
    const double pixels = static_cast<double>(width) * height;
    const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMaxKappaPixels))));
    const size_t columns = static_cast<size_t>((width + step - 1) / step);
    const size_t rows = static_cast<size_t>((height + step - 1) / step);
    std::vector<float> changes(columns * rows);
    std::vector<int> otherwise(rows);
    parallelFor(rows, [&](size_t row) {
        for (size_t column = 0; column < columns; ++column) {
            const int x = std::min(static_cast<int>(column) * step + step / 2, width - 1);
            const int y = std::min(static_cast<int>(row) * step + step / 2, height - 1);
            const reference::Ray ray = tracer.cameraRay(camera, x + 0.5, y + 0.5);
            const reference::PixelRecord still = tracer.trace(ray);
            double change = 0;
            for (int seed = 1; seed <= seeds; ++seed) {
                const reference::Jitter jitter = {
                    static_cast<uint64_t>(seed) + 977u * (row * columns + column), 1};
                const reference::PixelRecord moved = tracer.trace(ray, jitter);
                const double here = greatestChange(still.color, moved.color);
                const bool other = here > tolerance || still.pathHash != moved.pathHash;
                otherwise[row] += other && !isTie(still, moved);
                change = std::max(change, here);
            }
            changes[row * columns + column] =
                static_cast<float>(std::min<double>(change, std::numeric_limits<float>::max()));
        }
    });
    const double tried = static_cast<double>(changes.size()) * seeds;
    const int sum = std::accumulate(otherwise.begin(), otherwise.end(), 0);
    return {percentile99(std::move(changes)) / kFloatUnit, tried > 0 ? sum / tried : 0};
}

StiffnessClass classOf(double kappa) {
    if (kappa < 1e2) return StiffnessClass::NonStiff;
    return kappa <= 1e5 ? StiffnessClass::Stiff : StiffnessClass::BeyondFp32;
}

}  // namespace glint::verify
