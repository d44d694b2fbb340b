#include "import/polygon_split.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace glint {

namespace {

using Point = glm::dvec2;

constexpr double kNoArea = 1e-9;  // of the square of a polygon's size

// Twice the signed area of a, b, c.
double area(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The corners in a plane, counter-clockwise, relative to the first corner and in units of the polygon's size,
// so that coordinates far from the origin lose nothing and products neither over- nor underflow. Empty if
// that cannot be done.
std::vector<Point> project(std::span<const glm::dvec3> corners) {
    double size = 0;
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 d = glm::abs(corner - corners[0]);
        const double far = std::max({d.x, d.y, d.z});
        if (!std::isfinite(d.x + d.y + d.z) || !std::isfinite(far)) return {};
        size = std::max(size, far);
    }
    if (size == 0) return {};
    std::vector<glm::dvec3> local;
    for (const glm::dvec3& corner : corners) local.push_back((corner - corners[0]) / size);

    // Newell's normal (Sutherland, Sproull, Schumacker 1974): the sum over edges of (p x q).
    glm::dvec3 normal(0);
    for (size_t i = 0; i < local.size(); i++) normal += glm::cross(local[i], local[(i + 1) % local.size()]);
    // A bow tie's halves cancel each other: then its plane is that of the corners that span most.
    if (glm::dot(normal, normal) < kNoArea * kNoArea)
        for (size_t i = 0; i < local.size(); i++) {
            const glm::dvec3 spanned = glm::cross(local[i], local[(i + 1) % local.size()]);
            if (glm::dot(spanned, spanned) > glm::dot(normal, normal)) normal = spanned;
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    // Dropping the axis keeps the orientation (x: y, z; y: z, x; z: x, y) if the normal points along it.
    int first = (axis + 1) % 3, second = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(first, second);
    std::vector<Point> points;
    for (const glm::dvec3& p : local) points.emplace_back(p[first], p[second]);
    return points;
}

// All turns to the left is not enough: a pentagram has them too, but its fan runs backwards somewhere.
bool isConvex(const std::vector<Point>& points) {
    const size_t n = points.size();
    for (size_t i = 0; i < n; i++) {
        if (area(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
        if (i > 0 && i + 1 < n && area(points[0], points[i], points[i + 1]) < 0) return false;
    }
    return true;
}

// Ear clipping over a ring of the corners that are left (Meisters, Polygons have ears, Am. Math. Monthly 82,
// 1975). Cutting an ear changes only its neighbours (Eberly, Triangulation by Ear Clipping, 2002). The search
// for corners in an ear covers the reflex corners within its range of x.
class EarClipper {
  public:
    explicit EarClipper(const std::vector<Point>& points)
        : points_(points),
          next_(points.size()),
          previous_(ringBefore(points.size())),
          reflex_(points.size()) {
        findReflex();
        for (uint32_t i = 0; i < points.size(); i++)
            if (isEar(i)) ears_.insert(ears_.end(), i);
    }

    void clip(std::vector<std::array<uint32_t, 3>>& triangles) {
        uint32_t corner = 0;
        for (size_t left = points_.size(); left > 3; left--) {
            // The next ear along the ring, whose corners are in order. Without one all the way round the
            // polygon crosses itself: then this cuts the rest as a fan.
            if (!ears_.empty()) {
                const auto ear = ears_.lower_bound(corner);
                corner = ear == ears_.end() ? *ears_.begin() : *ear;
            }
            triangles.push_back({previous_[corner], corner, next_[corner]});
            remove(corner);
            corner = next_[corner];
        }
        triangles.push_back({previous_[corner], corner, next_[corner]});
    }

  private:
    static std::vector<uint32_t> ringBefore(size_t count) {
        std::vector<uint32_t> before(count);
        for (size_t i = 0; i < count; i++) before[i] = static_cast<uint32_t>((i + count - 1) % count);
        return before;
    }

    // Only reflex corners can lie inside an ear.
    void findReflex() {
        const auto n = static_cast<uint32_t>(points_.size());
        for (uint32_t i = 0; i < n; i++) next_[i] = (i + 1) % n;
        for (uint32_t i = 0; i < n; i++) {
            reflex_[i] = turn(i) <= 0;
            if (reflex_[i]) byX_.push_back(i);
        }
        std::ranges::sort(byX_, {}, [this](uint32_t i) { return points_[i].x; });
    }

    // True if a reflex corner lies in the triangle or on its edge. Points in the same place as a corner do
    // not count: the corner itself, and points of a bridge to a hole, which the outline passes twice.
    bool anyWithin(const Point& a, const Point& b, const Point& c) const {
        const Point lo = glm::min(glm::min(a, b), c), hi = glm::max(glm::max(a, b), c);
        auto at = std::ranges::lower_bound(byX_, lo.x, {}, [this](uint32_t i) { return points_[i].x; });
        for (; at != byX_.end() && points_[*at].x <= hi.x; ++at) {
            const Point& p = points_[*at];
            if (!reflex_[*at] || p.y < lo.y || p.y > hi.y || p == a || p == b || p == c) continue;
            if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return true;
        }
        return false;
    }

    double turn(uint32_t i) const { return area(points_[previous_[i]], points_[i], points_[next_[i]]); }

    bool isEar(uint32_t i) const {
        return turn(i) > 0 && !anyWithin(points_[previous_[i]], points_[i], points_[next_[i]]);
    }

    void remove(uint32_t i) {
        const uint32_t before = previous_[i], after = next_[i];
        next_[before] = after;
        previous_[after] = before;
        ears_.erase(i);
        reflex_[i] = false;
        for (const uint32_t neighbour : {before, after})
            if (turn(neighbour) > 0) reflex_[neighbour] = false;
        for (const uint32_t neighbour : {before, after}) {
            if (isEar(neighbour))
                ears_.insert(neighbour);
            else
                ears_.erase(neighbour);
        }
    }

    const std::vector<Point>& points_;
    std::vector<uint32_t> next_, previous_;
    std::vector<char> reflex_;
    std::vector<uint32_t> byX_;  // corners that were reflex at first, by x
    std::set<uint32_t> ears_;
};

}  // namespace

bool splitPolygon(std::span<const glm::dvec3> corners, std::vector<std::array<uint32_t, 3>>& triangles) {
    if (corners.size() > 3) {
        const std::vector<Point> points = project(corners);
        if (!points.empty() && !isConvex(points)) {
            const auto before = static_cast<std::ptrdiff_t>(triangles.size());
            EarClipper(points).clip(triangles);
            return std::none_of(triangles.begin() + before, triangles.end(), [&](const auto& t) {
                return area(points[t[0]], points[t[1]], points[t[2]]) < -kNoArea;
            });
        }
    }
    for (uint32_t i = 1; i + 1 < corners.size(); i++) triangles.push_back({0, i, i + 1});
    return true;
}

}  // namespace glint
