// node_formats SCENE...
//
// Which format of node would a GPU like best? Nodes visited, triangles tested and bytes loaded by a ray that
// walks by itself through the same leaves:
//   BVH2  64 bytes: two boxes of floats, the nearer child first (--traversal lane);
//   BVH4  64 bytes: four boxes of bytes on a grid of the node, nearest child first (bvh4);
//   BVH8  256 bytes: eight boxes of floats, as packets have them, nearest child first;
//   CWBVH 80 bytes: eight boxes of bytes in a frame of the node (Ylitie, Karras, Laine, "Efficient Incoherent
//         Ray Traversal on GPUs Through Compressed Wide BVHs", 2017), in octant order, leaves at once
//         (cwbvh); and, not built, nearest child first.
// + t: distances stand on the stack, and what has come to lie behind a hit is dropped when it is taken off;
// not built either. Triangles are 48 bytes, the word of a compressed node's leaf 16. 256x192 camera rays, a
// shadow ray to the first light and a random bounce from each hit. Counts do not depend on the machine; a
// GPU's caches and divergence are not in them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <vector>

#include "bounce.h"
#include "bvh/packet_tree.h"
#include "bvh/wide_tree.h"
#include "core/error.h"
#include "import/load.h"
#include "pack/packed_scene.h"
#include "reference/tracer.h"

namespace glint::bench {
namespace {

using glm::dvec3;
using glm::vec3;

struct Child {
    vec3 lo{0}, hi{0};
    uint32_t child = shared::kNone;

    bool isInner() const { return (child & shared::kLeafFlag) == 0; }
};

using Node = std::vector<Child>;

struct Format {
    const char* name;
    size_t bytes;  // of a node
    std::vector<Node> nodes;
    bool byOctant = false;  // children are in slots
    bool keepsDistances = false;
    size_t leafBytes = 0;
};

std::vector<Node> binaryNodes(const std::vector<shared::Node>& binary) {
    std::vector<Node> nodes;
    for (const shared::Node& node : binary) {
        Node children;
        if (node.child0 != shared::kNone) children.push_back({node.lo0, node.hi0, node.child0});
        if (node.child1 != shared::kNone) children.push_back({node.lo1, node.hi1, node.child1});
        nodes.push_back(std::move(children));
    }
    return nodes;
}

uint32_t wordOf(const shared::WideRow& row, uint32_t i) {
    return i == 0 ? row.x : i == 1 ? row.y : i == 2 ? row.z : row.w;
}

std::vector<Node> fourNodes(const std::vector<shared::Node>& binary) {
    const std::vector<shared::WideRow> rows = wideTree(binary, NodeFormat::Four).rows;
    std::vector<Node> nodes;
    for (size_t first = 0; first < rows.size(); first += shared::kFourRows) {
        const shared::WideRow &head = rows[first], &xy = rows[first + 1], &z = rows[first + 2];
        const uint32_t lower[] = {xy.x, xy.z, z.x}, upper[] = {xy.y, xy.w, z.y};
        Node node;
        for (uint32_t i = 0; i < 4; ++i) {
            Child c;
            c.child = wordOf(rows[first + 3], i);
            for (int axis = 0; axis < 3; ++axis) {
                const float origin = std::bit_cast<float>(wordOf(head, static_cast<uint32_t>(axis)));
                const uint32_t exponent = (head.w >> 8 * axis & 0xff) << 23;
                const auto steps = [&](uint32_t bytes) {
                    return std::bit_cast<float>(exponent | (bytes >> 8 * i & 0xff) << 15);
                };
                c.lo[axis] = origin + steps(lower[axis]);
                c.hi[axis] = origin + steps(upper[axis]);
            }
            if (c.child != shared::kNone) node.push_back(c);
        }
        nodes.push_back(std::move(node));
    }
    return nodes;
}

// In their slots; those without a child hold kNone.
Node compressedNode(const std::vector<shared::WideRow>& rows, size_t first) {
    const shared::WideRow &head = rows[first], &links = rows[first + 1];
    uint32_t nextNode = links.x, nextLeaf = links.y;
    Node node(8);
    for (uint32_t i = 0; i < 8; ++i) {
        Child& c = node[i];
        if (head.w >> 24 >> i & 1) c.child = nextNode++;
        if (links.z >> i & 1) c.child = wordOf(rows[nextLeaf / 4], nextLeaf % 4), ++nextLeaf;
        for (int axis = 0; axis < 3; ++axis) {
            const shared::WideRow& planes = rows[first + 2 + static_cast<size_t>(axis)];
            const float origin = std::bit_cast<float>(wordOf(head, static_cast<uint32_t>(axis)));
            const float step = std::bit_cast<float>((head.w >> 8 * axis & 0xff) << 23);
            const uint32_t shift = 8 * (i % 4);
            c.lo[axis] = origin + step * static_cast<float>((i < 4 ? planes.x : planes.y) >> shift & 0xff);
            c.hi[axis] = origin + step * static_cast<float>((i < 4 ? planes.z : planes.w) >> shift & 0xff);
        }
    }
    return node;
}

std::vector<Node> compressedNodes(const std::vector<shared::Node>& binary) {
    const std::vector<shared::WideRow> rows = wideTree(binary, NodeFormat::Compressed).rows;
    std::vector<Node> nodes;
    // The first leaf's word follows the last node; leaves go to nodes in their order.
    size_t end = rows.size();
    for (size_t first = 0; first < end; first += shared::kCompressedRows) {
        if (rows[first + 1].z != 0) end = std::min<size_t>(end, rows[first + 1].y / 4);
        nodes.push_back(compressedNode(rows, first));
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

struct Ray {
    dvec3 origin, direction;
    double tMax;
};

struct Counts {
    uint64_t rays = 0, nodes = 0, leaves = 0, triangles = 0;
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

struct Entry {
    uint32_t child;
    double begin;
};

// A ray on its way through a tree.
class Walk {
  public:
    Walk(const PackedScene& scene, const Format& format, const Ray& ray, bool any, Counts& counts)
        : scene_(scene),
          format_(format),
          ray_(ray),
          inverse_(1.0 / ray.direction),
          any_(any),
          counts_(counts) {}

    // Returns t of the nearest hit, of any if `any`, or a negative number.
    double run() {
        ++counts_.rays;
        stack_ = {{0, 0}};
        while (!stack_.empty() && !(any_ && found_ >= 0)) {
            const Entry top = stack_.back();
            stack_.pop_back();
            if (format_.keepsDistances && top.begin > ray_.tMax) continue;
            if (top.child & shared::kLeafFlag)
                leaf(top.child);
            else
                node(format_.nodes[top.child]);
        }
        return found_;
    }

  private:
    void leaf(uint32_t child) {
        ++counts_.leaves;
        const uint32_t first = child & shared::kLeafFirstMask;
        const uint32_t size = ((child >> shared::kLeafCountShift) & shared::kLeafCountMask) + 1;
        for (uint32_t i = first; i < first + size; ++i) {
            ++counts_.triangles;
            const double t = hitOf(ray_, scene_.triangles[i]);
            if (t < 0 || t > ray_.tMax) continue;
            ray_.tMax = found_ = t;
            if (any_) return;
        }
    }
    void node(const Node& children) {
        ++counts_.nodes;
        std::vector<Entry> entered;
        const size_t octant =
            (ray_.direction.x < 0 ? 1 : 0) | (ray_.direction.y < 0 ? 2 : 0) | (ray_.direction.z < 0 ? 4 : 0);
        for (size_t i = 0; i < children.size(); ++i) {
            const Child& c = children[format_.byOctant ? i ^ octant : i];
            if (c.child == shared::kNone) continue;
            const double begin = entry(ray_, inverse_, c);
            if (begin >= 0) entered.push_back({c.child, begin});
        }
        if (format_.byOctant) {
            for (const Entry& e : entered) {
                if ((e.child & shared::kLeafFlag) && !(any_ && found_ >= 0)) leaf(e.child);
            }
            std::erase_if(entered, [](const Entry& e) { return (e.child & shared::kLeafFlag) != 0; });
        } else {
            std::sort(entered.begin(), entered.end(),
                      [](const Entry& a, const Entry& b) { return a.begin < b.begin; });
        }
        stack_.insert(stack_.end(), entered.rbegin(), entered.rend());
    }

    const PackedScene& scene_;
    const Format& format_;
    Ray ray_;
    dvec3 inverse_;
    bool any_;
    Counts& counts_;
    std::vector<Entry> stack_;
    double found_ = -1;
};

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
            const reference::Surface surface = tracer.surfaceAt(ray, *hit);
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
        throw Error(ErrorKind::Argument, file + ": not a scene of triangles alone");
    const std::vector<Node> two = binaryNodes(packed.nodes), four = fourNodes(packed.nodes),
                            eight = packetNodes(packed.nodes), compressed = compressedNodes(packed.nodes);
    const Format formats[] = {{"BVH2", 64, two},
                              {"BVH2 + t", 64, two, false, true},
                              {"BVH4", 64, four},
                              {"BVH4 + t", 64, four, false, true},
                              {"BVH8 + t", 256, eight, false, true},
                              {"CWBVH", 80, compressed, true, false, 16},
                              {"CWBVH, nearest first", 80, compressed, false, false, 16},
                              {"CWBVH, nearest first + t", 80, compressed, false, true, 16}};
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
            for (const Ray& ray : kind.rays) hits += Walk(packed, format, ray, kind.any, counts).run() >= 0;
            const double n = std::max<double>(1, static_cast<double>(counts.rays));
            const double nodes = static_cast<double>(counts.nodes) / n;
            const double triangles = static_cast<double>(counts.triangles) / n;
            const double leaves = static_cast<double>(counts.leaves) / n;
            std::printf(" %.1f, %.1f, %.0f |", nodes, triangles,
                        nodes * static_cast<double>(format.bytes) +
                            leaves * static_cast<double>(format.leafBytes) + 48 * triangles);
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
