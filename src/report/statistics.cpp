#include "report/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "converge/bounds.h"

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

// The names of the variables are Hill's.
double studentQuantile(double tail, double n) {
    const double half = std::numbers::pi / 2;
    if (n == 1) return 1 / std::tan(tail * half);
    if (n == 2) return std::sqrt(2 / (tail * (2 - tail)) - 2);
    const double a = 1 / (n - 0.5), b = 48 / (a * a);
    double c = ((20700 * a / b - 98) * a - 16) * a + 96.36;
    const double d = ((94.5 / (b + c) - 3) / b + 1) * std::sqrt(a * half) * n;
    double x = d * tail, y = std::pow(x, 2 / n);
    if (y > 0.05 + a) {
        x = -converge::normalQuantile(tail / 2);
        y = x * x;
        if (n < 5) c += 0.3 * (n - 4.5) * (x + 0.6);
        c += (((0.05 * d * x - 5) * x - 7) * x - 2) * x + b;
        y = (((((0.4 * y + 6.3) * y + 36) * y + 94.5) / c - y - 3) / b + 1) * x;
        y = std::expm1(a * y * y);
    } else {
        y = ((1 / (((n + 6) / (n * y) - 0.089 * d - 0.822) * (n + 2) * 3) + 0.5 / (n + 4)) * y - 1) *
                (n + 1) / (n + 2) +
            1 / y;
    }
    return std::sqrt(n * y);
}

Interval ratioInterval(std::span<const double> a, std::span<const double> b, double tail) {
    const Interval unknown{0, std::numeric_limits<double>::infinity()};
    const size_t n = std::min(a.size(), b.size());
    if (n < 2) return unknown;
    double mean = 0, squares = 0;
    for (size_t i = 0; i < n; ++i) {
        if (!(a[i] > 0) || !(b[i] > 0)) return unknown;
        mean += std::log(a[i] / b[i]) / static_cast<double>(n);
    }
    for (size_t i = 0; i < n; ++i) squares += std::pow(std::log(a[i] / b[i]) - mean, 2);
    const double freedom = static_cast<double>(n) - 1;
    const double half =
        studentQuantile(tail, freedom) * std::sqrt(squares / freedom / static_cast<double>(n));
    return {std::exp(mean - half), std::exp(mean + half)};
}

}  // namespace glint::report
