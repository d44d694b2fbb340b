#include "pack/collect_primitives.h"

#include "core/parallel.h"
#include "pack/instances.h"
#include "pack/kind_packer.h"

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

#define GLINT_KIND_NAMES(number, Kind, kinds, one, many) #many,
constexpr const char* kKindNames[shared::kKindCount] = {GLINT_PRIMITIVES(GLINT_KIND_NAMES, GLINT_KIND_NAMES)};
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

Primitives collectPrimitives(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                             const Context& context, PackStatistics& statistics,
                             std::vector<std::string>& warnings) {
    std::vector<Fate> fates(numbers.total(), Fate::Absent);
    std::vector<ChunkCount> counts(numbers.chunks());
    const auto judge = [&](size_t i) { counts[i] = judgeChunk(scene, numbers, frame, i, fates); };
    parallelFor(context, counts.size(), judge);
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
    const auto collect = [&](size_t i) { collectChunk(scene, numbers, frame, i, fates, first[i], out); };
    parallelFor(context, counts.size(), collect);
    return out;
}

}  // namespace glint
