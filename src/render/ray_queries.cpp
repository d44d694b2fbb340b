#include "render/ray_queries.h"

#include <algorithm>
#include <array>
#include <bit>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "render/engine.h"
#include "render/path_limits.h"

namespace glint::render {

namespace {

// Rays of a piece. On a software device, 128 blocks fit a processor's cache, and starting threads and kernels
// costs less than a hundredth of the time. A GPU needs larger pieces.
constexpr uint32_t kSoftwarePiece = 1u << 17, kPiece = 1u << 20;
// Nodes of the smallest BVH for which rays are sorted.
constexpr size_t kMinNodesForOrder = 64;

// Features of a scene that affect hits; the others would be dead code.
SceneFeatures hitFeatures(SceneFeatures features) {
    features.mirrors = features.transmission = features.coloredShadows = features.attenuation = false;
    features.vertexNormals = features.specular = features.environmentMap = false;
    return features;
}

// Rows for listed hits, after those of the rays: two entries a hit, four hits for each ray of a piece.
constexpr uint32_t kCrossingRows = 8;

KernelId kernelOf(RayTask::Query query) {
    switch (query) {
        case RayTask::Query::Closest:
            return KernelId::Intersect;
        case RayTask::Query::Any:
            return KernelId::IntersectAny;
        case RayTask::Query::Count:
            return KernelId::Count;
        case RayTask::Query::Point:
            return KernelId::ClosestPoint;
    }
    throw std::logic_error("kernelOf: unknown query");
}

const RowEntry kNoEntry = {.u = {shared::kNone, shared::kNone, shared::kNone, shared::kNone}};

}  // namespace

// ---- A piece of a batch's rays, in blocks, on the device ----

constexpr size_t kBlock = kRayBlock;
// llvmpipe gives each of its threads an equal run of the workgroups, so blocks are dealt to this many runs.
constexpr uint32_t kRuns = 16;

// Rows that a ray needs, in the order of the staging buffer.
constexpr std::array kSlotRows = {shared::kRowOrigin, shared::kRowDirection, shared::kRowHit,
                                  shared::kPathRows};
constexpr size_t kInstanceRow = 3, kHitRow = 2;  // of kSlotRows

// One piece of rays in flight. A software device shares its path state with the host; otherwise `staging`
// holds copies of the rows that are exchanged.
struct Slot {
    Engine engine;
    gpu::Buffer staging;

    Slot(const DeviceScene& scene, uint32_t paths, uint32_t rowCount, bool inPlace)
        : engine(scene, inPlace ? gpu::MemoryKind::Host : gpu::MemoryKind::Device) {
        engine.reserve(paths, rowCount);
        if (!inPlace)
            staging = gpu::Buffer(scene.device, "rays on their way", rowBytes() * kSlotRows.size(),
                                  gpu::Access::StorageBuffer, gpu::MemoryKind::Host);
        // Kernels write the walk row only for a ray that runs out of trips, and reset it at the end.
        engine.paths().writeRow(shared::kRowWalk, std::vector<RowEntry>(paths, kNoEntry));
    }

    uint64_t rowBytes() const { return engine.paths().rowBytes(); }
    // One of kSlotRows, where the host writes and reads it.
    RowEntry* row(size_t which) const {
        const gpu::Buffer& rows = staging ? staging : engine.paths().buffer();
        return static_cast<RowEntry*>(rows.mapped()) +
               (staging ? which : size_t{kSlotRows[which]}) * engine.paths().capacity();
    }
};

struct RayQueries::State : DeviceScene {
    bool inPlace, alwaysPackets;
    uint32_t rowCount, piece;
    std::mutex mutex;
    std::condition_variable freed;
    std::vector<std::unique_ptr<Slot>> idle;
    unsigned made = 0;  // slots

    State(const gpu::Device& dev, const PackedScene& packed, Traversal wanted, const KernelCode& kernels)
        : DeviceScene(dev, packed, hitFeatures(packed.features), {.traversal = wanted, .kernels = &kernels}),
          inPlace(dev.info().software),
          alwaysPackets(wanted == Traversal::Packet),
          rowCount(shared::kPathRows + (features.instances ? 1 : 0) + kCrossingRows),
          piece(fittingPaths(dev.info(), access, inPlace ? kSoftwarePiece : kPiece, rowCount)) {
        piece = static_cast<uint32_t>(std::max<size_t>(piece / kBlock, 1) * kBlock);
        upload();
    }

    // Pieces in flight: while one is on a GPU, a thread prepares the next.
    unsigned atOnce() const { return inPlace ? 1u : 2u; }
    // Rays of a piece, so that its places fit: all runs are as long as the longest.
    size_t usable() const { return std::max<size_t>(piece / kBlock / kRuns * kRuns, 1) * kBlock; }
    // The blocks of a piece, dealt as the tiles of a slice.
    Slice blocksOf(size_t count) const {
        const auto blocks = static_cast<uint32_t>((count + kBlock - 1) / kBlock);
        return {.tileCount = blocks, .interleave = inPlace ? std::min(kRuns, blocks) : 1};
    }
    Context hostContext() const { return inPlace ? device.context() : Context{.threads = 1}; }

    // Calls use(slot) with an idle slot. If all are in use, it makes one, or waits if there are enough.
    template <typename Use>
    void withSlot(const Use& use) {
        std::unique_lock lock(mutex);
        freed.wait(lock, [&] { return !idle.empty() || made < atOnce(); });
        if (idle.empty()) {
            idle.push_back(std::make_unique<Slot>(*this, piece, rowCount, inPlace));
            ++made;
        }
        struct Held {
            State& state;
            std::unique_ptr<Slot> slot;
            ~Held() {
                const std::lock_guard lock(state.mutex);
                state.idle.push_back(std::move(slot));
                state.freed.notify_one();
            }
        } held{*this, std::move(idle.back())};
        idle.pop_back();
        lock.unlock();
        use(*held.slot);
    }

    // Calls use(at, start, present) for each block of a piece of `count` rays, in parallel: its first entry
    // in the rows, its first ray, and the number of its rays, which may be 0.
    template <typename Use>
    void eachBlock(size_t count, const Use& use) const {
        const Slice blocks = blocksOf(count);
        parallelFor(hostContext(), blocks.groups(), [&](size_t place) {
            const size_t start = std::min(blocks.tileOf(static_cast<uint32_t>(place)) * kBlock, count);
            use(place * kBlock, start, std::min(kBlock, count - start));
        });
    }

    void fill(const Slot& slot, const RayTask& task, const RayNumbers& numbers, size_t count) const {
        eachBlock(count, [&](size_t at, size_t start, size_t present) {
            std::array<RayInput, kBlock> rays;
            if (present > 0) task.fill(numbers.from(start), std::span(rays).first(present));
            for (size_t i = present; i < kBlock; ++i) rays[i] = RayInput{.tMin = shared::kInfinity};
            RowEntry* const origin = slot.row(0) + at;
            RowEntry* const direction = slot.row(1) + at;
            RowEntry* const hit = slot.row(kHitRow) + at;
            const float noHit = task.query == RayTask::Query::Count ? 0 : std::bit_cast<float>(shared::kNone);
            for (size_t i = 0; i < kBlock; ++i) {
                const RayInput& ray = rays[i];
                origin[i] = {{ray.origin.x, ray.origin.y, ray.origin.z, ray.tMax}};
                direction[i] = {{ray.direction.x, ray.direction.y, ray.direction.z, ray.tMin}};
                hit[i] = {{ray.tMax, 0, 0, noHit}};
            }
            if (features.instances) std::fill_n(slot.row(kInstanceRow) + at, kBlock, kNoEntry);
        });
    }

    void trace(Slot& slot, size_t count, KernelId id, TraceModes modes, bool packets) const {
        const size_t paths = blocksOf(count).groups() * kBlock;
        const auto groups = static_cast<uint32_t>(paths / shared::kWorkgroupSize);
        Engine& engine = slot.engine;
        const gpu::Buffer& rows = engine.paths().buffer();
        const uint64_t row = slot.rowBytes(), used = paths * sizeof(RowEntry);
        const size_t staged = slot.staging ? kSlotRows.size() - (features.instances ? 0 : 1) : 0;
        for (size_t i = 0; i < staged; ++i)
            engine.submission().copy(slot.staging, i * row, rows, kSlotRows[i] * row, used);
        modes.given = true;
        const Slice slice = {.region = {0, 0, 1, 1}, .tileCount = groups};
        engine.trace(id, modes, engine.dispatchOf(slice), groups, packets, [&] {
            for (size_t i = kHitRow; i < staged; ++i)
                engine.submission().copy(rows, kSlotRows[i] * row, slot.staging, i * row, used);
            engine.submit();
        });
    }

    void take(const Slot& slot, const RayTask& task, const RayNumbers& numbers, size_t count) const {
        eachBlock(count, [&](size_t at, size_t start, size_t present) {
            if (present == 0) return;
            const bool counted = task.query == RayTask::Query::Count;
            const RowEntry* const instances =
                features.instances && !counted ? slot.row(kInstanceRow) + at : nullptr;
            task.take(numbers.from(start), {slot.row(kHitRow) + at, instances, present, counted});
        });
    }

    void runPiece(const RayTask& task, const RayNumbers& rays, size_t count, bool packets) {
        withSlot([&](Slot& slot) {
            fill(slot, task, rays, count);
            const ProcessorWatch processor;
            const Stopwatch watch;
            trace(slot, count, kernelOf(task.query), {.leaves = task.leaves, .methods = task.methods},
                  packets);
            if (task.kernels) {
                const std::lock_guard lock(mutex);
                task.kernels->wall += watch.seconds();
                task.kernels->processor += processor.seconds();
            }
            take(slot, task, rays, count);
        });
    }

    // ---- Lists of crossings ----

    // Lists the crossings of the rays from `first` on, which fit into the room for lists.
    void listPiece(Slot& slot, std::span<const uint32_t> counts, size_t first, const ListFill& fillRays,
                   const ListTake& takeHits) const {
        RayTask task;
        task.query = RayTask::Query::Count;
        task.fill = [&](const RayNumbers& numbers, std::span<RayInput> rays) {
            fillRays(first + numbers.first, rays);
            for (size_t i = 0; i < rays.size(); ++i)
                if (counts[numbers[i]] == 0) rays[i].tMin = shared::kInfinity;
        };
        fill(slot, task, {}, counts.size());
        std::vector<uint32_t> starts(counts.size() + 1);
        std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
        std::vector<RowEntry> places(blocksOf(counts.size()).groups() * kBlock, RowEntry{{0, 0, 0, 0}});
        eachBlock(counts.size(), [&](size_t at, size_t start, size_t present) {
            for (size_t i = 0; i < present; ++i)
                places[at + i] = {.u = {starts[start + i], counts[start + i]}};
        });
        slot.engine.paths().writeRow(shared::kRowThroughput, places);
        trace(slot, counts.size(), KernelId::Count, {.list = true}, false);
        // An unlisted crossing would be read from uninitialized memory.
        for (size_t i = 0; i < places.size(); ++i) {
            const uint32_t listed = slot.row(kHitRow)[i].u[1], wanted = places[i].u[1];
            if (wanted != 0 && listed != wanted)
                throw Error(ErrorKind::Device,
                            "a ray crosses " + std::to_string(wanted) + " surfaces, but the device listed " +
                                std::to_string(listed) + "; this is a defect of glint or of the driver");
        }
        const std::vector<RowEntry> found =
            slot.engine.paths().readRow(rowCount - kCrossingRows, 2 * size_t{starts.back()});
        std::vector<FoundHit> hits;
        for (size_t i = 0; i < counts.size(); ++i) {
            hits.clear();
            for (size_t k = starts[i]; k < starts[i + 1]; ++k) {
                const RowEntry& hit = found[2 * k];
                hits.push_back({hit.f[0], hit.f[1], hit.f[2], hit.u[3], found[2 * k + 1].u[0]});
            }
            takeHits(first + i, hits);
        }
    }

    // ---- The order of a batch's rays ----

    // Sorts on software devices only; its benefit on GPUs is unmeasured.
    RayOrder orderOf(const RayTask& task, size_t first) const {
        const size_t count = task.count - first;
        const bool coherent = task.coherent || alwaysPackets;
        if (!inPlace || scene.nodes.size() < kMinNodesForOrder) return {count, coherent, {}, 1};
        return orderRays(task.fill, first, count, {scene.boundsLo, scene.boundsHi}, coherent,
                         device.context());
    }

    bool canUsePackets(const RayTask& task) const {
        const size_t others = primitivesOfPackets(scene) - scene.triangles.size();
        const bool isCount = task.query == RayTask::Query::Count;
        if (task.query == RayTask::Query::Point || (isCount && others > 0)) return false;
        return traversal.packets && task.methods == Methods{};
    }
};

RayQueries::RayQueries(const gpu::Device& device, const PackedScene& scene, Traversal traversal,
                       const KernelCode& kernels)
    : state_(std::make_shared<State>(device, scene, traversal, kernels)) {}

void RayQueries::prepare() {
    state_->withSlot([&](Slot& slot) {
        for (const KernelId id : {KernelId::Intersect, KernelId::IntersectAny}) {
            slot.engine.kernel(id, {.given = true});
            if (state_->traversal.packets) slot.engine.kernel(packetKernel(id), {.given = true});
        }
    });
}

bool RayQueries::update() {
    // The kernels are specialized for the scene's features.
    if (state_->features != hitFeatures(state_->scene.features)) return false;
    state_->buffers.update(state_->scene);
    return true;
}

bool RayQueries::run(const RayTask& task) {
    const size_t usable = state_->usable();
    std::mutex mutex;
    size_t done = 0;
    bool stopped = false;
    const auto stops = [&] {
        const std::lock_guard lock(mutex);
        return stopped = stopped || (task.cancelled && task.cancelled());
    };
    for (size_t first = 0; first < task.count && !stopped;) {
        const RayOrder order = state_->orderOf(task, first);
        const RayNumbers rays = order.from(first);
        const bool packets = order.coherent && state_->canUsePackets(task);
        const size_t pieces = (order.count + usable - 1) / usable;
        parallelFor({.threads = state_->atOnce()}, pieces, [&](size_t i) {
            if (stops()) return;
            const size_t count = std::min(usable, order.count - i * usable);
            state_->runPiece(task, rays.from(i * usable), count, packets);
            const std::lock_guard lock(mutex);
            done += count;
            if (task.progress) task.progress(static_cast<double>(done) / static_cast<double>(task.count));
        });
        first += order.count;
    }
    return !stopped;
}

void RayQueries::list(std::span<const uint32_t> counts, const ListFill& fill, const ListTake& take) {
    const size_t usable = state_->usable();
    const uint64_t room = uint64_t{state_->piece} * kCrossingRows / 2;
    for (size_t first = 0; first < counts.size();) {
        size_t end = first;
        uint64_t hits = 0;
        while (end < counts.size() && end - first < usable && hits + counts[end] <= room)
            hits += counts[end++];
        if (end == first)
            throw Error(ErrorKind::Device, "ray " + std::to_string(first) + " crosses " +
                                               std::to_string(counts[first]) + " surfaces, but at most " +
                                               std::to_string(room) + " can be listed; shorten its interval");
        state_->withSlot([&](Slot& slot) {
            state_->listPiece(slot, counts.subspan(first, end - first), first, fill, take);
        });
        first = end;
    }
}

}  // namespace glint::render
