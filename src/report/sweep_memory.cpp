// What measuring a scene takes of memory: what sweep.cpp and sweep_truth.cpp hold at a time, by its size.
#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "render/path_limits.h"
#include "render/path_state.h"
#include "report/sweep.h"

namespace glint::report {

namespace {

// Of a pixel: colour and whether it is done; the colour in double precision, with alpha and without; what
// else is known of its first sample.
constexpr uint64_t kPicture = 4 * sizeof(float) + sizeof(uint8_t);
constexpr uint64_t kExact = sizeof(glm::dvec4), kColor = sizeof(glm::dvec3), kData = sizeof(PixelData);
constexpr uint64_t kConverged = kColor + 3 * sizeof(float);
constexpr uint64_t kGreatest = sizeof(float);  // difference, of which measureError takes the percentile

// While measureArithmetic looks at it, or while what it looks at is drawn.
constexpr uint64_t kJudged = std::max(
    kPicture + kData + 2 * sizeof(uint32_t) + 2 * sizeof(uint8_t) + kGreatest, kPicture + kData + kExact);

// Rows that are read back at a time: those of AovRows, or sums and means; and one on its way.
constexpr uint64_t kRowsOfData = 6, kRowsOfColor = 3;

// What a driver that computes on the processor takes for the code of a renderer's kernels, and to make it.
// Measured on lavapipe at 384x288 and 16x12.
constexpr uint64_t kCodeOfRenderer = uint64_t{48} << 20;

uint64_t drawnBytes(const Configuration& c) {
    uint64_t bytes = kPicture + kGreatest;
    if (c.contrast) bytes += sizeof(uint32_t);
    // Two replicates, means and alphas; and the picture that they make, its samples and errors.
    if (c.error) bytes += 2 * (kColor + sizeof(double)) + kPicture + sizeof(uint32_t) + sizeof(float);
    if (c.filter) bytes += kColor;  // beside that of the run before, which stays
    return bytes;
}

}  // namespace

// Its paths on the device: of its pictures, and of the one that judges them.
uint64_t SceneSweep::pathBytes(const Configuration& c, const Region& region) const {
    Request request = requestFor(c, 0);
    request.ledger = request.ledger || c.error.has_value();
    const gpu::DeviceInfo& info = deviceOf(c).info();
    const SceneFeatures features = c.leaveOut ? loaded_.packed.features : allFeatures();
    const auto room = [&] {
        return render::roomFor(info, c.access.value_or(access_), features,
                               render::modesOf(request, NodeFormat::Two),
                               request.maxDepth.value_or(loaded_.packed.environment.maxDepth), region);
    };
    const auto withRows = [](const render::PathRoom& r, uint64_t readBack) {
        return r.bytes() + r.paths * readBack * sizeof(render::RowEntry);
    };
    uint64_t bytes = withRows(room(), kRowsOfColor);
    if (!isJudgedAlone(c)) return bytes;
    request.data = request.ledger = true;
    return std::max(bytes, withRows(room(), kRowsOfData));
}

MemoryNeed SceneSweep::memory(int width) const {
    const Region region = {0, 0, width, heightOf(width)};
    const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(region.height());
    const std::string usual = keyOf(machineKind({}));
    std::set<std::tuple<Sampler, int>> truths;
    MemoryNeed need;
    uint64_t usualBytes = 0;  // of the renderer that stays
    const auto count = [&](const gpu::DeviceInfo& info, uint64_t paths, uint64_t& host, uint64_t& device) {
        (info.software ? host : device) += paths + arrayBytes_;
        if (info.software) host += kCodeOfRenderer;
    };
    uint64_t deviceMost = 0;
    for (const Batch& batch : batches_) {
        uint64_t drawn = 0, kept = 0;  // of a pixel, within the batch
        std::map<std::string, std::pair<const gpu::DeviceInfo*, uint64_t>> renderers;
        for (const Configuration& c : batch.configurations) {
            drawn = std::max(drawn, drawnBytes(c));
            if (c.filter) kept += kColor;
            if (isJudgedAlone(c)) {
                drawn = std::max(drawn, kJudged);
                truths.insert({c.sampler, c.spp});
            }
            if (c.onReference) continue;
            const std::string kind = keyOf(machineKind(c));
            const uint64_t paths = pathBytes(c, region);
            if (kind == usual) {
                usualBytes = std::max(usualBytes, paths);
                continue;
            }
            auto& renderer = renderers[kind];
            renderer = {&deviceOf(c).info(), std::max(renderer.second, paths)};
        }
        uint64_t host = (drawn + kept) * pixels, device = 0;
        for (const auto& [kind, renderer] : renderers) count(*renderer.first, renderer.second, host, device);
        need.passing = std::max(need.passing, host);
        deviceMost = std::max(deviceMost, device);
    }
    // The converged picture's halves and a picture of it.
    const uint64_t halves = 2 * kColor + kPicture + (limits_.truth == Backend::Cpu ? kExact : 0);
    need.passing = std::max(need.passing, halves * pixels);
    need.kept = (kConverged + truths.size() * (kColor + sizeof(uint32_t))) * pixels;
    count(device_.info(), usualBytes, need.kept, need.device);
    need.device += deviceMost;
    return need;
}

}  // namespace glint::report
