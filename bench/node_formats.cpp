// node_formats SCENE...
//
// Which format of node would a GPU like best? Nodes visited, triangles tested and bytes loaded by a ray that
// walks by itself, nearest child first, through the same leaves in four formats:
//   BVH2  64 bytes: two boxes of floats, as glint's own nodes;
//   BVH4  128 bytes: four boxes of floats;
//   BVH8  256 bytes: eight boxes of floats, as packets have them;
//   CWBVH 80 bytes: eight boxes of bytes in a frame of the node (Ylitie, Karras, Laine, "Efficient Incoherent
//         Ray Traversal on GPUs Through Compressed Wide BVHs", 2017, sec. 2), sorted here, in octant order
//         there.
// Triangles are 48 bytes. 256x192 camera rays, a shadow ray to the first light and a random bounce from each
// hit. Counts do not depend on the machine; a GPU's caches and divergence are not in them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <vector>

#include "bounce.h"
#include "bvh/packed_scene.h"
#include "bvh/packet_tree.h"
#include "core/error.h"
#include "reference/tracer.h"
#include "scene/load.h"

namespace glint::bench {
namespace {

using glm::dvec3;
using glm::vec3;

struct Child {
    vec3 lo{0}, hi{0};
    uint32_t child = shared::kNone;

    float halfArea() const {
        const vec3 e = hi - lo;
        return e.x * e.y + e.y * e.z + e.z * e.x;
    }
    bool isInner() const { return (child & shared::kLeafFlag) == 0; }
};

using Node = std::vector<Child>;

struct Format {
    const char* name;
    size_t bytes;  // of a node
    std::vector<Node> nodes;
};

std::vector<Child> childrenOf(const shared::Node& node) {
    std::vector<Child> children;
    if (node.child0 != shared::kNone) children.push_back({node.lo0, node.hi0, node.child0});
    if (node.child1 != shared::kNone) children.push_back({node.lo1, node.hi1, node.child1});
    return children;
}

// Opens the largest child until there are `width`. Nodes that were opened stay in the list, unused.
std::vector<Node> widened(const std::vector<shared::Node>& binary, size_t width) {
    std::vector<Node> nodes;
    for (const shared::Node& node : binary) {
        Node children = childrenOf(node);
        for (;;) {
            const Child* largest = nullptr;
            for (const Child& c : children) {
                if (c.isInner() && (!largest || c.halfArea() > largest->halfArea())) largest = &c;
            }
            if (!largest) break;
            const Node below = childrenOf(binary[largest->child]);
            if (children.size() - 1 + below.size() > width) break;
            children.erase(children.begin() + (largest - children.data()));
            children.insert(children.end(), below.begin(), below.end());
        }
        nodes.push_back(std::move(children));
    }
    return nodes;
}

std::vector<Node> packetNodes(const std::vector<shared::Node>& binary) {
    const std::vector<shared::PacketCorner> corners = packetTree(binary);
    std::vector<Node> nodes;
    for (size_t first = 0; first < corners.size(); first += 16) {
        Node node;
        for (size_t i = first; i < first + 8; ++i) {
            if (corners[i].child != shared::kNone)
                node.push_back({corners[i].corner, corners[i + 8].corner, corners[i].child});
        }
        nodes.push_back(std::move(node));
    }
    return nodes;
}

// Corners on a grid of 256 steps of a power of two from the node's lower corner, rounded outwards.
std::vector<Node> quantized(std::vector<Node> nodes) {
    for (Node& node : nodes) {
        if (node.empty()) continue;
        vec3 lo = node[0].lo, hi = node[0].hi;
        for (const Child& c : node) {
            lo = glm::min(lo, c.lo);
            hi = glm::max(hi, c.hi);
        }
        for (int axis = 0; axis < 3; ++axis) {
            const float extent = hi[axis] - lo[axis];
            const float step = extent > 0 ? std::exp2(std::ceil(std::log2(extent / 255))) : 0;
            if (step == 0) continue;
            for (Child& c : node) {
                c.lo[axis] = lo[axis] + step * std::floor((c.lo[axis] - lo[axis]) / step);
                c.hi[axis] = lo[axis] + step * std::ceil((c.hi[axis] - lo[axis]) / step);
            }
        }
    }
    return nodes;
}

struct Ray {
    dvec3 origin, direction;
    double tMax;
};

struct Counts {
    uint64_t rays = 0, nodes = 0, triangles = 0;
};

double entry(const Ray& ray, const dvec3& inverse, const Child& c) {
    const dvec3 a = (dvec3(c.lo) - ray.origin) * inverse, b = (dvec3(c.hi) - ray.origin) * inverse;
    const dvec3 nearest = glm::min(a, b), farthest = glm::max(a, b);
    const double begin = std::max({nearest.x, nearest.y, nearest.z, 0.0});
    const double end = std::min({farthest.x, farthest.y, farthest.z, ray.tMax});
    return begin <= end ? begin : -1;
}

// Moller and Trumbore, 1997: what a count needs is the nearest hit, not the last bit.
double hitOf(const Ray& ray, const shared::Triangle& triangle) {
    const dvec3 v0(triangle.v0), e1 = dvec3(triangle.v1) - v0, e2 = dvec3(triangle.v2) - v0;
    const dvec3 p = glm::cross(ray.direction, e2), s = ray.origin - v0, q = glm::cross(s, e1);
    const double det = glm::dot(e1, p);
    const double u = glm::dot(s, p) / det, v = glm::dot(ray.direction, q) / det, t = glm::dot(e2, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 1e-9 ? t : -1;
}

// Returns t of the nearest hit, of any if `any`, or a negative number.
double walk(const PackedScene& scene, const Format& format, Ray ray, bool any, Counts& counts) {
    ++counts.rays;
    const dvec3 inverse = 1.0 / ray.direction;
    struct Entry {
        uint32_t child;
        double begin;
    };
    std::vector<Entry> stack = {{0, 0}};
    double found = -1;
    while (!stack.empty()) {
        const Entry top = stack.back();
        stack.pop_back();
        if (top.begin > ray.tMax) continue;
        if (top.child & shared::kLeafFlag) {
            const uint32_t first = top.child & shared::kLeafFirstMask;
            const uint32_t size = ((top.child >> shared::kLeafCountShift) & shared::kLeafCountMask) + 1;
            for (uint32_t i = first; i < first + size; ++i) {
                ++counts.triangles;
                const double t = hitOf(ray, scene.triangles[i]);
                if (t < 0 || t > ray.tMax) continue;
                ray.tMax = found = t;
                if (any) return found;
            }
            continue;
        }
        ++counts.nodes;
        const auto first = static_cast<std::ptrdiff_t>(stack.size());
        for (const Child& c : format.nodes[top.child]) {
            const double begin = entry(ray, inverse, c);
            if (begin >= 0) stack.push_back({c.child, begin});
        }
        std::sort(stack.begin() + first, stack.end(),
                  [](const Entry& a, const Entry& b) { return a.begin > b.begin; });
    }
    return found;
}

struct Rays {
    std::vector<Ray> camera, shadow, bounce;
};

Rays raysOf(const Scene& scene, const PackedScene& packed) {
    constexpr int kWidth = 256, kHeight = 192;
    const reference::Tracer tracer(packed);
    const shared::Camera camera = packCamera(scene.camera, kWidth, kHeight, packed.origin);
    std::mt19937 random(1);
    Rays rays;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const reference::Ray ray = tracer.cameraRay(camera, x + 0.5, y + 0.5);
            rays.camera.push_back({ray.origin, ray.direction, ray.tMax});
            const auto hit = tracer.closest(ray, {});
            if (!hit) continue;
            const reference::Surface surface = tracer.surface(ray, *hit);
            const dvec3 normal = glm::dot(surface.geometricNormal, ray.direction) > 0
                                     ? -surface.geometricNormal
                                     : surface.geometricNormal;
            const dvec3 start =
                surface.position + normal * (1e-6 * glm::length(surface.position - ray.origin));
            if (!packed.lights.empty()) {
                const shared::Light& light = packed.lights[0];
                const bool directional = light.kind == shared::kLightDirectional;
                const dvec3 at(light.position);
                rays.shadow.push_back({start, directional ? at : at - start, directional ? 1e30 : 1.0});
            }
            rays.bounce.push_back({start, bounceAbout(normal, random), 1e30});
        }
    }
    return rays;
}

void report(const std::string& file) {
    const Scene scene = loadScene(file);
    const PackedScene packed = packScene(scene);
    if (packed.triangles.empty() || !packed.spheres.empty() || !packed.instances.empty())
        throw Error(ExitCode::Usage, file + ": not a scene of triangles alone");
    const std::vector<Node> wide = packetNodes(packed.nodes);
    const Format formats[] = {{"BVH2", 64, widened(packed.nodes, 2)},
                              {"BVH4", 128, widened(packed.nodes, 4)},
                              {"BVH8", 256, wide},
                              {"CWBVH", 80, quantized(wide)}};
    const Rays rays = raysOf(scene, packed);
    const struct {
        const char* name;
        const std::vector<Ray>& rays;
        bool any;
    } classes[] = {
        {"camera", rays.camera, false}, {"shadow", rays.shadow, true}, {"bounce", rays.bounce, false}};
    const std::string name = std::filesystem::path(file).stem().string();
    for (const Format& format : formats) {
        std::printf("| %s | %s |", name.c_str(), format.name);
        for (const auto& kind : classes) {
            Counts counts;
            uint64_t hits = 0;
            for (const Ray& ray : kind.rays) hits += walk(packed, format, ray, kind.any, counts) >= 0;
            const double n = std::max<double>(1, static_cast<double>(counts.rays));
            const double nodes = static_cast<double>(counts.nodes) / n;
            const double triangles = static_cast<double>(counts.triangles) / n;
            std::printf(" %.1f, %.1f, %.0f |", nodes, triangles,
                        nodes * static_cast<double>(format.bytes) + 48 * triangles);
            std::fprintf(stderr, "%s %s %s: %llu hits\n", name.c_str(), format.name, kind.name,
                         static_cast<unsigned long long>(hits));
        }
        std::printf("\n");
    }
}

}  // namespace
}  // namespace glint::bench

int main(int count, char** arguments) {
    try {
        std::printf("| scene | nodes | camera | shadow | bounce |\n|---|---|---|---|---|\n");
        for (int i = 1; i < count; ++i) glint::bench::report(arguments[i]);
    } catch (const glint::Error& error) {
        std::fprintf(stderr, "node_formats: %s\n", error.what());
        return 1;
    }
    return count > 1 ? 0 : 2;
}
