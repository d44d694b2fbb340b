#include "import/polygon_split.h"

#include <algorithm>
#include <cmath>

namespace glint {

namespace {

using Point = glm::dvec2;

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
// 1975). Quadratic: cutting an ear changes only its neighbours (Eberly, Triangulation by Ear Clipping, 2002).
class EarClipper {
  public:
    explicit EarClipper(const std::vector<Point>& points)
        : points_(points), next_(points.size()), previous_(points.size()), ear_(points.size()) {
        const auto n = static_cast<uint32_t>(points.size());
        for (uint32_t i = 0; i < n; i++) {
            next_[i] = (i + 1) % n;
            previous_[i] = (i + n - 1) % n;
        }
        for (uint32_t i = 0; i < n; i++)
            if (turn(i) <= 0) reflex_.push_back(i);
        for (uint32_t i = 0; i < n; i++) ear_[i] = isEar(i);
    }

    void clip(std::vector<std::array<uint32_t, 3>>& triangles) {
        uint32_t corner = 0;
        for (size_t left = points_.size(); left > 3; left--) {
            size_t tried = 0;
            while (!ear_[corner] && tried++ < left) corner = next_[corner];
            // Without an ear all the way round the polygon crosses itself: then this cuts the rest as a fan.
            triangles.push_back({previous_[corner], corner, next_[corner]});
            remove(corner);
            corner = next_[corner];
        }
        triangles.push_back({previous_[corner], corner, next_[corner]});
    }

  private:
    double turn(uint32_t i) const { return area(points_[previous_[i]], points_[i], points_[next_[i]]); }

    bool isEar(uint32_t i) const {
        if (turn(i) <= 0) return false;
        const Point &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
        for (const uint32_t other : reflex_) {
            const Point& p = points_[other];
            // Corners in the same place: the ear's own, and those of a bridge to a hole, walked twice.
            if (p == a || p == b || p == c) continue;
            if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
        }
        return true;
    }

    void remove(uint32_t i) {
        const uint32_t before = previous_[i], after = next_[i];
        next_[before] = after;
        previous_[after] = before;
        std::erase_if(reflex_,
                      [&](uint32_t r) { return r == i || ((r == before || r == after) && turn(r) > 0); });
        ear_[before] = isEar(before);
        ear_[after] = isEar(after);
    }

    const std::vector<Point>& points_;
    std::vector<uint32_t> next_, previous_;
    std::vector<char> ear_;
    std::vector<uint32_t> reflex_;  // only these can lie inside an ear
};

}  // namespace

void splitPolygon(std::span<const glm::dvec3> corners, std::vector<std::array<uint32_t, 3>>& triangles) {
    if (corners.size() > 3) {
        const std::vector<Point> points = project(corners);
        if (!points.empty() && !isConvex(points)) {
            EarClipper(points).clip(triangles);
            return;
        }
    }
    for (uint32_t i = 1; i + 1 < corners.size(); i++) triangles.push_back({0, i, i + 1});
}

}  // namespace glint
