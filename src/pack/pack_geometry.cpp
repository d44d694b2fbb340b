#include "pack/pack_geometry.h"

#include <algorithm>
#include <array>
#include <functional>

#include "bvh/flatten.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/build_tree.h"
#include "pack/scene_arrays.h"
#include "scene/limits.h"

namespace glint {
namespace {

// ---- The primitives of a scene that can be hit

// Dropped primitives of one object.
struct Dropped {
    uint32_t object = 0;
    uint32_t noArea = 0, notFinite = 0;
};

struct ChunkCount {
    std::array<uint32_t, shared::kKindCount> kept{};
    std::vector<Dropped> dropped;
};

#define GLINT_KIND_NAMES(number, Kind, KINDS, kinds, one, many) #many,
constexpr const char* kKindNames[shared::kKindCount] = {GLINT_PRIMITIVES(GLINT_KIND_NAMES, GLINT_KIND_NAMES)};
#undef GLINT_KIND_NAMES

ChunkCount statusesOfChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                           size_t chunk, std::vector<PrimitiveStatus>& statuses) {
    ChunkCount count;
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const shared::PrimitiveKind kind = kindOf(scene.objects[object]);
        PrimitiveStatus* status = &statuses[numbers.firstItem(object)];
        Dropped dropped{object, 0, 0};
        for (uint32_t face = begin; face < end; ++face) {
            status[face] = kind == shared::PrimitiveKind::Instance
                               ? frame.instances->of(object).status
                               : packerOf(kind).statusOf(scene.objects[object], face, frame);
            count.kept[static_cast<size_t>(kind)] += status[face] == PrimitiveStatus::Kept;
            dropped.noArea += status[face] == PrimitiveStatus::NoArea;
            dropped.notFinite += status[face] == PrimitiveStatus::NotFinite;
        }
        if (dropped.noArea + dropped.notFinite > 0) count.dropped.push_back(dropped);
    });
    return count;
}

void warn(const Scene& scene, const PrimitiveNumbers& numbers, const Dropped& dropped,
          std::vector<std::string>& warnings) {
    const std::string& name = scene.objects[dropped.object].name;
    const std::string where = name.empty() ? "/objects/" + std::to_string(dropped.object) : name;
    const auto add = [&](uint64_t count, const char* why) {
        if (count > 0)
            warnings.push_back(concat(where, ": ", count, " of ", numbers.facesOf(dropped.object), ' ',
                                      kKindNames[static_cast<size_t>(kindOf(scene.objects[dropped.object]))],
                                      " dropped: ", why));
    };
    add(dropped.noArea, "no area after rounding to fp32");
    add(dropped.notFinite, "a vertex is not finite or beyond the range of fp32");
}

void reportDropped(const Scene& scene, const PrimitiveNumbers& numbers, const std::vector<ChunkCount>& counts,
                   PackStatistics& statistics, std::vector<std::string>& warnings) {
    std::vector<Dropped> perObject;
    for (const ChunkCount& count : counts) {
        for (const Dropped& d : count.dropped) {
            if (perObject.empty() || perObject.back().object != d.object)
                perObject.push_back({d.object, 0, 0});
            perObject.back().noArea += d.noArea;
            perObject.back().notFinite += d.notFinite;
            statistics.droppedZeroArea += d.noArea;
            statistics.droppedNotFinite += d.notFinite;
        }
    }
    for (const Dropped& d : perObject) warn(scene, numbers, d, warnings);
}

// Writes the chunk's primitives from position `next` on.
void collectChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, size_t chunk,
                  const std::vector<PrimitiveStatus>& statuses, size_t next, Primitives& out) {
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const PrimitiveStatus* status = &statuses[numbers.firstItem(object)];
        const shared::PrimitiveKind kind = kindOf(scene.objects[object]);
        for (uint32_t face = begin; face < end; ++face) {
            if (status[face] != PrimitiveStatus::Kept) continue;
            out.boxes[next] = kind == shared::PrimitiveKind::Instance
                                  ? frame.instances->of(object).box
                                  : packerOf(kind).box(scene.objects[object], face, frame);
            out.kinds[next] = static_cast<uint8_t>(kind);
            out.sources[next++] = {object, face};
        }
    });
}

// Leaves out planes and the triangles that cannot be hit, which are counted and warned of.
// Throws Error(Scene) if there are more primitives of a kind than a leaf can name.
Primitives collectPrimitives(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                             const Context& context, PackStatistics& statistics,
                             std::vector<std::string>& warnings) {
    std::vector<PrimitiveStatus> statuses(numbers.total(), PrimitiveStatus::Absent);
    std::vector<ChunkCount> counts(numbers.chunks());
    const auto assess = [&](size_t i) { counts[i] = statusesOfChunk(scene, numbers, frame, i, statuses); };
    parallelFor(context, counts.size(), assess);
    reportDropped(scene, numbers, counts, statistics, warnings);

    Primitives out;
    uint64_t total = 0;
    std::vector<size_t> first;
    for (const ChunkCount& count : counts) {
        first.push_back(total);
        for (uint32_t kind = 0; kind < shared::kKindCount; ++kind) {
            out.counts[kind] += count.kept[kind];
            total += count.kept[kind];
        }
    }
    for (uint32_t kind = 0; kind < shared::kKindCount; ++kind)
        checkLimit(kKindNames[kind], out.counts[kind], uint64_t{shared::kLeafFirstMask} + 1);

    parallelTasks(context, {[&] { out.boxes.resize(total); },
                            [&] { out.kinds.resize(total), out.sources.resize(total); }});
    const auto collect = [&](size_t i) { collectChunk(scene, numbers, frame, i, statuses, first[i], out); };
    parallelFor(context, counts.size(), collect);
    return out;
}

// ---- Arrays of the kinds, in the order of the tree's leaves

constexpr size_t kWriteChunk = 32768;  // primitives that one thread writes at a time

struct Counts {
    std::array<uint32_t, shared::kKindCount> kinds{};
    FurtherRows rows;
};

template <class Visit>
void visitOrder(const Primitives& primitives, const std::vector<uint32_t>& order, size_t chunk,
                Visit&& visit) {
    const size_t end = std::min(order.size(), (chunk + 1) * kWriteChunk);
    for (size_t i = chunk * kWriteChunk; i < end; ++i)
        visit(static_cast<shared::PrimitiveKind>(primitives.kinds[order[i]]), primitives.sources[order[i]]);
}

// Turns the counts of chunks into where each begins; returns the sum of all.
Counts sumUp(std::vector<Counts>& chunks) {
    Counts total;
    for (Counts& chunk : chunks) {
        const Counts here = chunk;
        chunk = total;
        for (uint32_t kind = 0; kind < shared::kKindCount; ++kind) total.kinds[kind] += here.kinds[kind];
        total.rows.normals += here.rows.normals;
        total.rows.polygonVertices += here.rows.polygonVertices;
        total.rows.attributes += here.rows.attributes;
    }
    return total;
}

// Planes are written already. In parallel, as the first touch of memory takes longest here.
void makeRoom(const Counts& total, PackedScene& packed, const Context& context) {
    std::vector<std::function<void()>> tasks;
    const auto make = [&](auto& array, size_t size) {
        if (size > 0) tasks.push_back([&array, size] { array.resize(size); });
    };
    visitPrimitiveArrays(packed, [&](shared::PrimitiveKind kind, auto& array) {
        if (kind != shared::PrimitiveKind::Plane) make(array, total.kinds[static_cast<size_t>(kind)]);
    });
    make(packed.triangleSurfaces, total.kinds[shared::kKindTriangle]);
    make(packed.polygonVertices, total.rows.polygonVertices);
    make(packed.vertexNormals, total.rows.normals);
    // At most 5 rows for each of 2^25 triangles: the number fits kAttributeFirstMask.
    make(packed.vertexAttributes, total.rows.attributes);
    parallelTasks(context, tasks);
}

// Fills the arrays of the kinds, and those of their further rows, with primitives[order[0]], ...
void writeInLeafOrder(const Packing& packing, const Primitives& primitives,
                      const std::vector<uint32_t>& order, const Context& context) {
    std::vector<Counts> chunks((order.size() + kWriteChunk - 1) / kWriteChunk);
    const auto count = [&](size_t i) {
        visitOrder(primitives, order, i, [&](shared::PrimitiveKind kind, Primitives::Source source) {
            ++chunks[i].kinds[static_cast<size_t>(kind)];
            packerOf(kind).count(packing, source, chunks[i].rows);
        });
    };
    parallelFor(context, chunks.size(), count);
    makeRoom(sumUp(chunks), packing.packed, context);
    const auto write = [&](size_t i) {
        Counts next = chunks[i];
        visitOrder(primitives, order, i, [&](shared::PrimitiveKind kind, Primitives::Source source) {
            packerOf(kind).write(packing, source, next.kinds[static_cast<size_t>(kind)]++, next.rows);
        });
    };
    parallelFor(context, chunks.size(), write);
}

// ---- The tree

// A leaf of polygons must not take more trips than one polygon may: the device cannot stop within a leaf.
void limitPolygonTrips(const Scene& scene, BvhOptions& options, PackedScene& packed) {
    uint32_t trips = 0;
    for (const Object& object : scene.objects)
        if (const auto* polygon = std::get_if<PolygonShape>(&object.shape))
            trips = std::max(trips, polygonTrips(polygon->vertices.size()));
    if (trips == 0) return;
    options.maxLeafSize = std::clamp(shared::kMaxPolygonTrips / trips, 1u, options.maxLeafSize);
    // Two more for each polygon: the end of its loop and that of the leaf.
    packed.polygonTripsPerLeaf = options.maxLeafSize * (trips + 2);
}

// Parts of the packing time until the primitives are collected, and until their BVH is built.
constexpr double kCollected = 0.1, kBuilt = 0.9;

// Products of shorter edges underflow in fp32: the device would miss every triangle.
void refuseTinyScene(const PackedScene& packed) {
    const glm::vec3 size = packed.boundsHi - packed.boundsLo;
    const double greatest = std::max({size.x, size.y, size.z});
    if (greatest < kMinSceneSize)
        throw Error(ErrorKind::Scene, "the scene is " + describe(greatest) + " across, and fp32 needs " +
                                          describe(kMinSceneSize) + " at least: scale it up");
}

void fillStatistics(const Tree& tree, PackStatistics& statistics) {
    statistics.depth = tree.bvh.depth;
    statistics.sahCost = tree.cost;
    statistics.splitTriangles = tree.splitTriangles;
    for (const BvhNode& node : tree.bvh.nodes) statistics.leaves += node.count > 0;
}

}  // namespace

void packGeometry(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, uint32_t maxLevels,
                  const PackOptions& pack, const Context& context, PackedScene& packed,
                  Materials& materials) {
    Primitives primitives =
        collectPrimitives(scene, numbers, frame, context, packed.statistics, packed.warnings);
    TreeOptions tree;
    tree.quality = pack.quality;
    tree.split = pack.split;
    tree.memory = pack.memory;
    BvhOptions& options = tree.bvh;
    options.maxLevels = maxLevels;
    const auto kinds = std::count_if(primitives.counts.begin(), primitives.counts.end(),
                                     [](uint32_t count) { return count > 0; });
    if (kinds > 1) options.groups = &primitives.kinds;
    if (primitives.counts[shared::kKindInstance] > 0) {
        options.groups = &primitives.kinds;
        options.soloGroup = shared::kKindInstance;
    }
    limitPolygonTrips(scene, options, packed);
    const Stopwatch stopwatch;
    Tree built = buildTree(primitives, scene, frame, tree, context.part(kCollected, kBuilt));
    packed.statistics.buildSeconds = stopwatch.seconds();
    Bvh& bvh = built.bvh;
    primitives.boxes = {};
    packed.nodes = flattenBvh(bvh, primitives.kinds, context);
    fillStatistics(built, packed.statistics);
    if (!bvh.nodes.empty()) {
        packed.boundsLo = bvh.nodes[0].box.lo;
        packed.boundsHi = bvh.nodes[0].box.hi;
        refuseTinyScene(packed);
    }
    bvh.nodes = {};
    writeInLeafOrder({scene, numbers, frame, packed, materials}, primitives, bvh.order, context);
}

}  // namespace glint
