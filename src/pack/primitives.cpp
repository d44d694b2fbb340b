#include "pack/primitives.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/error.h"
#include "core/parallel.h"
#include "pack/instances.h"
#include "pack/kind_packer.h"
#include "scene/placement.h"

namespace glint {
namespace {

// Dropped primitives of one object.
struct Dropped {
    uint32_t object = 0;
    uint32_t noArea = 0, notFinite = 0;
};

struct ChunkCount {
    std::array<uint32_t, shared::kKindCount> kept{};
    std::vector<Dropped> dropped;
};

#define GLINT_KIND_NAMES(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                         loops, uv)                                                                      \
#many,
constexpr const char* kKindNames[shared::kKindCount] = {GLINT_PRIMITIVES(GLINT_KIND_NAMES, 0)};
#undef GLINT_KIND_NAMES

Fate judgeInstance(const Instances& instances, uint32_t object) {
    if (!instances.showsAnything(object)) return Fate::Absent;
    return instances.isFinite(object) ? Fate::Kept : Fate::NotFinite;
}

ChunkCount judgeChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, size_t chunk,
                      std::vector<Fate>& fates) {
    ChunkCount count;
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const shared::PrimitiveKind kind = kindOf(scene.objects[object]);
        Fate* fate = &fates[numbers.firstItem(object)];
        Dropped dropped{object, 0, 0};
        for (uint32_t face = begin; face < end; ++face) {
            fate[face] = kind == shared::PrimitiveKind::Instance
                             ? judgeInstance(*frame.instances, object)
                             : packerOf(kind).judge(scene.objects[object], face, frame);
            count.kept[static_cast<size_t>(kind)] += fate[face] == Fate::Kept;
            dropped.noArea += fate[face] == Fate::NoArea;
            dropped.notFinite += fate[face] == Fate::NotFinite;
        }
        if (dropped.noArea + dropped.notFinite > 0) count.dropped.push_back(dropped);
    });
    return count;
}

void warn(const Scene& scene, const PrimitiveNumbers& numbers, const Dropped& dropped,
          std::vector<std::string>& warnings) {
    const std::string& name = scene.objects[dropped.object].name;
    const std::string where = name.empty() ? "/objects/" + std::to_string(dropped.object) : name;
    const std::string of = " of " + std::to_string(numbers.facesOf(dropped.object)) + " " +
                           kKindNames[static_cast<size_t>(kindOf(scene.objects[dropped.object]))] +
                           " dropped: ";
    if (dropped.noArea > 0)
        warnings.push_back(where + ": " + std::to_string(dropped.noArea) + of +
                           "no area after rounding to fp32");
    if (dropped.notFinite > 0)
        warnings.push_back(where + ": " + std::to_string(dropped.notFinite) + of +
                           "a vertex is not finite or beyond the range of fp32");
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
                  const std::vector<Fate>& fates, size_t next, Primitives& out) {
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const Fate* fate = &fates[numbers.firstItem(object)];
        const shared::PrimitiveKind kind = kindOf(scene.objects[object]);
        for (uint32_t face = begin; face < end; ++face) {
            if (fate[face] != Fate::Kept) continue;
            out.boxes[next] = kind == shared::PrimitiveKind::Instance
                                  ? frame.instances->box(object)
                                  : packerOf(kind).box(scene.objects[object], face, frame);
            out.kinds[next] = static_cast<uint8_t>(kind);
            out.sources[next++] = {object, face};
        }
    });
}

}  // namespace

PrimitiveNumbers::PrimitiveNumbers(const Scene& scene) {
    uint64_t id = 0, item = 0;
    first_.reserve(scene.objects.size() + 1);
    ids_.reserve(scene.objects.size());
    for (const Object& object : scene.objects) {
        first_.push_back(static_cast<uint32_t>(item));
        ids_.push_back(static_cast<uint32_t>(id));
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        const size_t faces = mesh != nullptr ? mesh->mesh->corners.size() : 1;
        id += faces;
        item += object.transform ? 1 : faces;
        checkLimit("primitives", id, shared::kNone - 1);
    }
    first_.push_back(static_cast<uint32_t>(item));
}

void checkLimit(const char* what, uint64_t count, uint64_t limit) {
    if (count <= limit) return;
    throw Error(ErrorKind::Scene, std::string(what) + ": the scene has " + std::to_string(count) +
                                      ", the limit is " + std::to_string(limit) + "; leave some out");
}

std::optional<glm::vec3> roundPoint(const glm::dvec3& p) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    // NaN compares false.
    if (!(std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest))
        return std::nullopt;
    return glm::vec3(p);
}

void setRounded(Box& box, int axis, double center, double extent, double margin) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    box.lo[axis] = std::nextafter(static_cast<float>(center - extent - margin), -kInf);
    box.hi[axis] = std::nextafter(static_cast<float>(center + extent + margin), kInf);
}

const KindPacker& packerOf(shared::PrimitiveKind kind) {
    switch (kind) {
#define GLINT_CASE(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                   uv)                                                                                    \
    case shared::PrimitiveKind::Kind:                                                                     \
        return packerOf##Kind();
        GLINT_PRIMITIVES(GLINT_CASE, 0)
#undef GLINT_CASE
    }
    throw std::logic_error("no such kind of primitive");
}

shared::PrimitiveKind kindOf(const Object& object) {
    if (object.transform && !takesTransform(object.shape)) return shared::PrimitiveKind::Instance;
    for (uint32_t kind = 0; kind < shared::kKindCount; ++kind)
        if (packerOf(static_cast<shared::PrimitiveKind>(kind)).packs(object.shape))
            return static_cast<shared::PrimitiveKind>(kind);
    throw std::logic_error("a shape that no kind of primitive packs");
}

Primitives collectPrimitives(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                             unsigned threads, PackStatistics& statistics,
                             std::vector<std::string>& warnings) {
    std::vector<Fate> fates(numbers.total(), Fate::Absent);
    std::vector<ChunkCount> counts(numbers.chunks());
    const auto judge = [&](size_t i) { counts[i] = judgeChunk(scene, numbers, frame, i, fates); };
    parallelFor(counts.size(), judge, threads);
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

    parallelTasks(
        {[&] { out.boxes.resize(total); }, [&] { out.kinds.resize(total), out.sources.resize(total); }},
        threads);
    const auto collect = [&](size_t i) { collectChunk(scene, numbers, frame, i, fates, first[i], out); };
    parallelFor(counts.size(), collect, threads);
    return out;
}

}  // namespace glint
