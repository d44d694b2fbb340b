#include "report/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace glint::report {

std::vector<size_t> paretoFront(std::span<const WorkPoint> points) {
    std::vector<size_t> order(points.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        if (points[a].seconds != points[b].seconds) return points[a].seconds < points[b].seconds;
        return points[a].error < points[b].error;
    });
    std::vector<size_t> front;
    for (const size_t i : order) {
        if (front.empty() || points[i].error < points[front.back()].error) front.push_back(i);
    }
    return front;
}

std::optional<double> logSlope(std::span<const double> x, std::span<const double> y) {
    double n = 0, sx = 0, sy = 0;
    const auto usable = [&](size_t i) { return x[i] > 0 && y[i] > 0; };
    for (size_t i = 0; i < x.size(); ++i) {
        if (!usable(i)) continue;
        n += 1;
        sx += std::log(x[i]);
        sy += std::log(y[i]);
    }
    if (n < 2) return std::nullopt;
    double sxx = 0, sxy = 0;  // about the mean, which does not cancel
    for (size_t i = 0; i < x.size(); ++i) {
        if (!usable(i)) continue;
        const double dx = std::log(x[i]) - sx / n;
        sxx += dx * dx;
        sxy += dx * (std::log(y[i]) - sy / n);
    }
    if (sxx <= 0) return std::nullopt;
    return sxy / sxx;
}

}  // namespace glint::report
