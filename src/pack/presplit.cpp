#include "pack/presplit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kChunk = 8192;
constexpr size_t chunksOf(size_t count) {
    return (count + kChunk - 1) / kChunk;
}
constexpr uint32_t kMaxParts = 64;  // of one triangle
constexpr int kLevels = 20;         // of halving planes: finer ones split nothing that is worth it

// Calls body(chunk, i) for each i < count, by several threads in chunks.
template <typename Body>
void forEach(const Context& context, size_t count, const Body& body) {
    parallelFor(context, chunksOf(count), [&](size_t chunk) {
        const size_t end = std::min(count, (chunk + 1) * kChunk);
        for (size_t i = chunk * kChunk; i < end; ++i) body(chunk, i);
    });
}

// A plane of the grid that halves the root's box `level` times along `axis`.
struct Plane {
    int axis = -1;  // none
    int level = kLevels;
    float position = 0;
};

// The coarsest plane of the grid inside (lo, hi) that cuts off no sliver.
Plane coarsestPlane(int axis, double lo, double hi, double rootLo, double rootHi) {
    Plane plane;
    const double size = rootHi - rootLo;
    if (!(hi > lo) || !(size > 0)) return plane;
    const double sliver = (hi - lo) / 16;
    for (int level = 1; level < kLevels; ++level) {
        const double cell = std::ldexp(size, -level);
        const double next = rootLo + (std::floor((lo + sliver - rootLo) / cell) + 1) * cell;
        const auto rounded = static_cast<float>(next);
        if (rounded > lo + sliver && rounded < hi - sliver) return {axis, level, rounded};
        // No plane of a finer level can lie inside once the cells are smaller than the last bit.
        if (!(cell > std::abs(hi) * 0x1p-22)) break;
    }
    return plane;
}

// The one that is coarsest over the three axes; of equals, along the longest edge.
Plane bestPlane(const Box& box, const Box& root) {
    Plane best;
    for (int axis = 0; axis < 3; ++axis) {
        const Plane plane = coarsestPlane(axis, box.lo[axis], box.hi[axis], root.lo[axis], root.hi[axis]);
        if (plane.axis < 0) continue;
        const bool longer = best.axis >= 0 && plane.level == best.level &&
                            box.hi[axis] - box.lo[axis] > box.hi[best.axis] - box.lo[best.axis];
        if (best.axis < 0 || plane.level < best.level || longer) best = plane;
    }
    return best;
}

// Margin of a triangle's part, as of a whole triangle (edgeMargin), plus the rounding error of the cut.
float partMargin(const Box& whole) {
    const glm::vec3 far = glm::max(glm::abs(whole.lo), glm::abs(whole.hi));
    return edgeMargin(whole) + 0x1p-23f * std::max({far.x, far.y, far.z});
}

// A part of a triangle, as a convex polygon.
using Outline = std::vector<glm::dvec3>;

// Clips an outline at a plane (Sutherland & Hodgman, "Reentrant Polygon Clipping", 1974).
Outline clipped(const Outline& outline, const Plane& plane, bool upper) {
    Outline result;
    const double sign = upper ? 1 : -1;
    for (size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec3& a = outline[i];
        const glm::dvec3& b = outline[(i + 1) % outline.size()];
        const double da = sign * (a[plane.axis] - plane.position),
                     db = sign * (b[plane.axis] - plane.position);
        if (da >= 0) result.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            glm::dvec3 crossing = a + (b - a) * (da / (da - db));
            crossing[plane.axis] = plane.position;
            result.push_back(crossing);
        }
    }
    return result;
}

// Encloses the outline; conversions round outwards by way of the margin that is added later.
Box boxOf(const Outline& outline) {
    Box box;
    for (const glm::dvec3& point : outline) box.include(glm::vec3(point));
    return box;
}

double longestEdge(const Box& box) {
    const glm::dvec3 edges = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    return std::max({edges.x, edges.y, edges.z});
}

// The area that the triangle shows along the three axes: what half the area of boxes around ever smaller
// parts of it come down to.
double idealHalfArea(const Corners& c) {
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(c[1]) - glm::dvec3(c[0]), glm::dvec3(c[2]) - glm::dvec3(c[0]));
    return (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)) / 2;
}

struct Part {
    Outline outline;
    uint32_t pieces;
};

uint32_t partsFor(double importance, double scale) {
    return 1 + static_cast<uint32_t>(std::min<double>(scale * importance, kMaxParts - 1));
}

double importance(const Corners& corners, const Box& box, const Box& root) {
    const double empty = box.halfArea() - idealHalfArea(corners);
    const Plane plane = bestPlane(box, root);
    if (plane.axis < 0 || !(empty > 0)) return 0;
    return std::cbrt(std::ldexp(empty, -plane.level));
}

Outline outlineOf(const Corners& corners) {
    return {corners[0], corners[1], corners[2]};
}

}  // namespace

std::vector<Box> splitTriangle(const Corners& corners, const Box& root, uint32_t parts) {
    const Outline whole = outlineOf(corners);
    const Box wholeBox = boxOf(whole);
    const float margin = partMargin(wholeBox), ownMargin = edgeMargin(wholeBox);
    std::vector<Box> boxes;
    std::vector<Part> pending{{whole, parts}};
    while (!pending.empty()) {
        const Part part = std::move(pending.back());
        pending.pop_back();
        const Box box = boxOf(part.outline);
        const Plane plane = part.pieces > 1 ? bestPlane(box, root) : Plane{};
        if (plane.axis < 0) {
            boxes.push_back({glm::max(box.lo - margin, wholeBox.lo - ownMargin),
                             glm::min(box.hi + margin, wholeBox.hi + ownMargin)});
            continue;
        }
        Part lower{clipped(part.outline, plane, false), 0}, upper{clipped(part.outline, plane, true), 0};
        const double a = longestEdge(boxOf(lower.outline)), b = longestEdge(boxOf(upper.outline));
        const double share = std::round(part.pieces * a / std::max(a + b, 1e-300));
        lower.pieces = static_cast<uint32_t>(std::clamp(share, 1.0, part.pieces - 1.0));
        upper.pieces = part.pieces - lower.pieces;
        pending.push_back(std::move(upper));
        pending.push_back(std::move(lower));
    }
    return boxes;
}

namespace {

Corners triangleCorners(Primitives::Source source, const Scene& scene, const Frame& frame) {
    const TriangleSource triangles(scene.objects[source.object]);
    return roundTriangle(triangles.vertices(source.face), frame.origin).value();
}

// The factor from importance to parts for which the sum of all further parts is nearest to `wanted`, by
// bisection.
double scaleFor(const std::vector<float>& importances, double wanted, const Context& context) {
    const auto further = [&](double scale) {
        std::vector<double> sums(chunksOf(importances.size()));
        forEach(context, importances.size(),
                [&](size_t chunk, size_t i) { sums[chunk] += partsFor(importances[i], scale) - 1; });
        return std::accumulate(sums.begin(), sums.end(), 0.0);
    };
    const double greatest = *std::max_element(importances.begin(), importances.end());
    if (!(greatest > 0)) return 0;
    double low = 0, high = kMaxParts / greatest;
    for (int i = 0; i < 8 && further(high) < wanted; ++i) high *= 4;
    for (int i = 0; i < 20; ++i) {
        const double middle = (low + high) / 2;
        (further(middle) <= wanted ? low : high) = middle;
    }
    return low;
}

}  // namespace

double boxEmptiness(const Primitives& primitives, const Scene& scene, const Frame& frame,
                    const Context& context) {
    const size_t count = primitives.boxes.size();
    std::vector<double> sums(chunksOf(count));
    std::vector<Box> boxes(chunksOf(count));
    forEach(context, count, [&](size_t chunk, size_t i) {
        boxes[chunk].include(primitives.boxes[i]);
        if (primitives.kinds[i] != shared::kKindTriangle) return;
        const Corners corners = triangleCorners(primitives.sources[i], scene, frame);
        sums[chunk] += primitives.boxes[i].halfArea() - idealHalfArea(corners);
    });
    Box root;
    for (const Box& box : boxes) root.include(box);
    const double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
    const double area = root.halfArea();
    return area > 0 ? sum / area : 0;
}

uint32_t splitLargeTriangles(Primitives& primitives, const Scene& scene, const Frame& frame, double budget,
                             const Context& context) {
    const size_t count = primitives.boxes.size();
    const uint32_t triangles = primitives.counts[shared::kKindTriangle];
    if (triangles == 0) return 0;
    Box root;
    for (const Box& box : primitives.boxes) root.include(box);
    const auto cornersOf = [&](size_t entry) {
        return triangleCorners(primitives.sources[entry], scene, frame);
    };
    std::vector<float> importances(count, 0.0f);
    forEach(context, count, [&](size_t, size_t i) {
        if (primitives.kinds[i] == shared::kKindTriangle)
            importances[i] = static_cast<float>(importance(cornersOf(i), primitives.boxes[i], root));
    });
    const double scale = scaleFor(importances, budget * triangles, context);
    std::vector<std::vector<Box>> added(chunksOf(count));
    std::vector<std::vector<Primitives::Source>> sources(chunksOf(count));
    forEach(context, count, [&](size_t chunk, size_t i) {
        const uint32_t parts = partsFor(importances[i], scale);
        if (parts < 2) return;
        const std::vector<Box> boxes = splitTriangle(cornersOf(i), root, parts);
        primitives.boxes[i] = boxes[0];
        added[chunk].insert(added[chunk].end(), boxes.begin() + 1, boxes.end());
        sources[chunk].insert(sources[chunk].end(), boxes.size() - 1, primitives.sources[i]);
    });
    for (size_t chunk = 0; chunk < chunksOf(count); ++chunk) {
        primitives.boxes.insert(primitives.boxes.end(), added[chunk].begin(), added[chunk].end());
        primitives.sources.insert(primitives.sources.end(), sources[chunk].begin(), sources[chunk].end());
    }
    const auto extra = static_cast<uint32_t>(primitives.boxes.size() - count);
    primitives.kinds.insert(primitives.kinds.end(), extra, uint8_t{shared::kKindTriangle});
    primitives.counts[shared::kKindTriangle] += extra;
    return extra;
}

}  // namespace glint
