#include "pack/tree_memory.h"

#include <array>
#include <span>
#include <utility>

#include "core/content_hash.h"

namespace glint {

namespace {

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

uint64_t treeKey(const Primitives& primitives, const Scene& scene, const Frame& frame,
                 const TreeOptions& options) {
    const BvhOptions& bvh = options.bvh;
    const std::array<double, 10> numbers = {static_cast<double>(bvh.maxLeafSize),
                                            static_cast<double>(bvh.maxLevels),
                                            static_cast<double>(bvh.bins),
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
    if (options.split && options.quality != BuildQuality::Fast)
        hashes.push_back(hashOfCorners(primitives, scene));
    return hashOf(hashes);
}

}  // namespace glint
