#include "pack/build_tree.h"

#include <array>
#include <span>
#include <utility>

#include "core/content_hash.h"
#include "pack/presplit.h"

namespace glint {
namespace {

// Further entries that splitting may add, in triangles. Measured on a hall of arches (docs/lab/building.md):
// box and triangle tests of a camera ray 187 without, 99 with 0.3, 77 with 1, 76 with 3.
constexpr double kSplitBudget = 1;
// Triangles that a random ray tests only because their boxes are too large. Measured: 1.0 to 3.8 for scanned
// and modelled meshes, where splitting costs 2 to 60 %; 51 for the hall of arches, where it gains a factor of
// 2.4.
constexpr double kMuchEmptiness = 6;
// Least share of all tests of such a ray for which `default` tries splitting: 0.43 in the hall of arches;
// 0.08 in a shader ball of 64 k triangles, where splitting took six times as long as the tree and gained
// nothing.
constexpr double kMuchOfAll = 0.2;

bool mayGrow(const Primitives& primitives) {
    const double grown = (1 + kSplitBudget) * primitives.counts[shared::kKindTriangle];
    return grown < shared::kLeafFirstMask;
}

Tree plainTree(const Primitives& primitives, const TreeOptions& options, const Context& context) {
    Tree tree;
    tree.bvh = buildBvh(primitives.boxes, options.bvh, context);
    tree.cost = expectedCost(tree.bvh, options.bvh.traversalCost);
    return tree;
}

// Keeps whichever of both trees is cheaper, and the primitives that go with it.
void trySplits(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context, Tree& tree) {
    const double emptiness = boxEmptiness(primitives, scene, frame, context);
    if (emptiness < kMuchEmptiness) return;
    if (options.quality == BuildQuality::Default && emptiness < kMuchOfAll * tree.cost) return;
    Primitives split = primitives;
    const uint32_t added = splitLargeTriangles(split, scene, frame, kSplitBudget, context);
    if (added == 0) return;
    TreeOptions splitOptions = options;
    if (options.bvh.groups != nullptr) splitOptions.bvh.groups = &split.kinds;
    Tree candidate = plainTree(split, splitOptions, context);
    if (!(candidate.cost < tree.cost)) return;
    candidate.splitTriangles = added;
    tree = std::move(candidate);
    primitives = std::move(split);
}

bool maySplit(const TreeOptions& options) {
    return options.split && options.quality != BuildQuality::Fast;
}

Tree freshTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context) {
    Tree tree = plainTree(primitives, options, context);
    if (maySplit(options) && mayGrow(primitives)) trySplits(primitives, scene, frame, options, context, tree);
    return tree;
}

template <typename T>
uint64_t hashOf(const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T>);
    return contentHash(std::span(reinterpret_cast<const uint8_t*>(items.data()), items.size() * sizeof(T)));
}

// Hash of the triangles' corners, which splitting reads; in pieces, since together they would take half as
// much memory as the BVH.
uint64_t hashOfCorners(const Primitives& primitives, const Scene& scene) {
    constexpr size_t kPiece = 4096;
    std::vector<glm::dvec3> corners;
    std::vector<uint64_t> hashes;
    const auto close = [&] {
        hashes.push_back(hashOf(corners));
        corners.clear();
    };
    for (size_t i = 0; i < primitives.sources.size(); ++i) {
        if (primitives.kinds[i] != shared::kKindTriangle) continue;
        const Primitives::Source source = primitives.sources[i];
        const auto vertices = TriangleSource(scene.objects[source.object]).vertices(source.face);
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        if (corners.size() >= kPiece) close();
    }
    close();
    return hashOf(hashes);
}

// Hash of everything that the BVH depends on.
uint64_t treeKey(const Primitives& primitives, const Scene& scene, const Frame& frame,
                 const TreeOptions& options) {
    const BvhOptions& bvh = options.bvh;
    const std::array<double, 9> numbers = {static_cast<double>(bvh.maxLeafSize),
                                           static_cast<double>(bvh.maxLevels),
                                           bvh.traversalCost,
                                           static_cast<double>(bvh.soloGroup),
                                           bvh.groups ? 1.0 : 0.0,
                                           static_cast<double>(options.quality) + (options.split ? 10 : 0),
                                           frame.origin.x,
                                           frame.origin.y,
                                           frame.origin.z};
    std::vector<uint64_t> hashes = {hashOf(primitives.boxes), hashOf(primitives.kinds),
                                    hashOf(primitives.sources),
                                    hashOf(std::vector(numbers.begin(), numbers.end()))};
    if (maySplit(options)) hashes.push_back(hashOfCorners(primitives, scene));
    return hashOf(hashes);
}

}  // namespace

void TreeMemory::begin() {
    std::erase_if(entries_, [](const auto& entry) { return !entry.second.used; });
    for (auto& [key, entry] : entries_) entry.used = false;
}

const TreeMemory::Entry* TreeMemory::find(uint64_t key) {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    found->second.used = true;
    return &found->second;
}

void TreeMemory::keep(uint64_t key, Entry entry) {
    const std::lock_guard lock(mutex_);
    entry.used = true;
    ++built_;
    entries_.insert_or_assign(key, std::move(entry));
}

double expectedCost(const Bvh& bvh, double traversalCost) {
    if (bvh.nodes.empty()) return 0;
    // A random line that hits a convex box hits one inside it with a probability of the ratio of their areas.
    // If both boxes are points or lines, it hits both.
    const double rootArea = bvh.nodes[0].box.halfArea();
    double cost = 0;
    for (const BvhNode& node : bvh.nodes) {
        const double chance = rootArea > 0 ? node.box.halfArea() / rootArea : 1.0;
        cost += chance * (node.count > 0 ? node.count : traversalCost);
    }
    return cost;
}

Tree buildTree(Primitives& primitives, const Scene& scene, const Frame& frame, const TreeOptions& options,
               const Context& context) {
    if (!options.memory) return freshTree(primitives, scene, frame, options, context);
    const uint64_t key = treeKey(primitives, scene, frame, options);
    if (const TreeMemory::Entry* known = options.memory->find(key)) {
        if (known->split) primitives = *known->split;
        return known->tree;
    }
    TreeMemory::Entry entry;
    entry.tree = freshTree(primitives, scene, frame, options, context);
    if (entry.tree.splitTriangles > 0) entry.split = primitives;
    Tree tree = entry.tree;
    options.memory->keep(key, std::move(entry));
    return tree;
}

}  // namespace glint
