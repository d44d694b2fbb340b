// What kernels know of the path they work on: its pixel, listed or not, and its sample's dimensions, which
// are the reference's in every bit.
#include <algorithm>
#include <numeric>

#include "core/device_layout.h"
#include "gpu/compute.h"
#include "pack/pack_samples.h"
#include "path_probe.spv.h"
#include "reference/sampling.h"
#include "render/path_state.h"
#include "support.h"

namespace glint::render::test::path_test {
using gpu::Access;

constexpr uint32_t kPairs = 2;  // shared::kPairFilm and kPairLens
constexpr uint32_t kWords = 5 + 2 * kPairs;
static_assert(kWords == GLINT_PROBE_WORDS);

struct Probed {
    uint32_t present, path, inside, x, y;
    std::array<std::array<uint32_t, 2>, kPairs> pairs;
};
static_assert(sizeof(Probed) == 4 * kWords);

size_t samplesBinding() {
#define GLINT_FIND(binding, field, Struct, ROWS) \
    if (std::string_view(#field) == "samples") return binding;
    GLINT_SCENE_ARRAYS(GLINT_FIND)
#undef GLINT_FIND
    return 0;
}

uint32_t mirrorsConstant() {
#define GLINT_FIND(ID, NAME, field) \
    if (std::string_view(#field) == "mirrors") return ID;
    GLINT_FEATURES(GLINT_FIND)
#undef GLINT_FIND
    return 0;
}

// Two tiles and a bit, from a pixel that is not the first.
Slice sliceOf(const Region& region, uint32_t first, uint32_t tiles, uint32_t interleave) {
    Slice slice;
    slice.region = region;
    slice.firstTile = first;
    slice.tileCount = tiles;
    slice.interleave = interleave;
    return slice;
}

class PathTest : public RenderTest {
  protected:
    // The kernel over all paths of the slice, or over those of `list`.
    std::vector<Probed> probe(const Slice& slice, const PackedSamples& samples, uint32_t sample,
                              const std::vector<uint32_t>& list = {}) const;
};

std::vector<Probed> PathTest::probe(const Slice& slice, const PackedSamples& samples, uint32_t sample,
                                    const std::vector<uint32_t>& list) const {
    const uint32_t paths = slice.paths();
    PathState state(device(), Access::TexelBuffer, paths, shared::kPathRows + shared::kListRows);
    std::vector<RowEntry> entries(paths, RowEntry{.u = {shared::kNone, 0, 0, 0}});
    for (size_t i = 0; i < list.size(); ++i) entries[i].u[0] = list[i];
    state.writeRow(device(), shared::kPathRows + 1, entries);

    shared::Dispatch dispatch;
    dispatch.firstTile = slice.firstTile;
    dispatch.tileCount = slice.tileCount;
    dispatch.interleave = slice.interleave;
    dispatch.run = slice.run();
    dispatch.regionX = static_cast<uint32_t>(slice.region.x0);
    dispatch.regionY = static_cast<uint32_t>(slice.region.y0);
    dispatch.regionWidth = static_cast<uint32_t>(slice.region.width());
    dispatch.regionHeight = static_cast<uint32_t>(slice.region.height());
    dispatch.capacity = paths;
    dispatch.sampleIndex = sample;
    dispatch.listed = static_cast<uint32_t>(list.size());
    dispatch.listRead = 1;

    gpu::KernelOptions options;
    options.name = "path probe";
    options.spirv = path_probe_spv;
    options.bindings.assign(GLINT_BINDING_COUNT + 1, Access::TexelBuffer);
    options.bindings.front() = options.bindings.back() = Access::StorageBuffer;
    // Of all features and modes mirrors alone, so that there are lists.
    options.constants.assign(GLINT_ARRAYS_TOGETHER + 1, 0u);
    options.constants[mirrorsConstant()] = 1;
    options.pushConstantBytes = sizeof(dispatch);
    options.workgroupSizeX = shared::kWorkgroupSize;
    std::vector<gpu::Buffer> buffers(options.bindings.size());
    std::vector<const gpu::Buffer*> bound;
    const uint32_t groups =
        list.empty()
            ? slice.groups()
            : static_cast<uint32_t>((list.size() + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize);
    std::vector<Probed> probed(groups * shared::kWorkgroupSize);
    for (size_t i = 0; i < buffers.size(); ++i) {
        size_t bytes = 16;
        if (i == samplesBinding()) bytes = samples.rows.size() * sizeof(shared::Sample);
        if (i + 1 == buffers.size()) bytes = probed.size() * sizeof(Probed);
        if (i != 1)
            buffers[i] = gpu::Buffer(device(), "probe", bytes, options.bindings[i], gpu::MemoryKind::Device);
        bound.push_back(i == 1 ? &state.buffer() : &buffers[i]);
    }
    gpu::upload(device(), buffers[samplesBinding()], std::as_bytes(std::span(samples.rows)));
    gpu::Kernel kernel(device(), options);
    kernel.bind(bound);
    gpu::Submission submission(device());
    submission.dispatch(kernel, groups, std::as_bytes(std::span<const shared::Dispatch, 1>(&dispatch, 1)));
    submission.submit();
    gpu::download(device(), buffers.back(), std::as_writable_bytes(std::span(probed)));
    return probed;
}

PackedSamples samplesOf(Sampler sampler, int count) {
    const ImageSettings image = {
        .samplesPerPixel = count, .sampler = sampler, .filter = Filter::Tent, .filterRadius = 1, .seed = 11};
    return packSamples(image, true);
}

void expectPixel(const Slice& slice, const Probed& probed) {
    glm::ivec2 pixel(-1);
    const bool inside = slice.pixelOf(probed.path, pixel);
    ASSERT_EQ(probed.inside != 0, inside) << probed.path;
    if (!inside) return;
    EXPECT_EQ(probed.x, static_cast<uint32_t>(pixel.x)) << probed.path;
    EXPECT_EQ(probed.y, static_cast<uint32_t>(pixel.y)) << probed.path;
}

TEST_F(PathTest, PathsKnowTheirPixels) {
    const PackedSamples samples = samplesOf(Sampler::Grid, 1);
    for (const Slice& slice : {sliceOf({0, 0, 64, 64}, 0, 64, 16), sliceOf({3, 5, 30, 22}, 2, 7, 4),
                               sliceOf({100, 7, 101, 90}, 0, 11, 1)}) {
        const std::vector<Probed> probed = probe(slice, samples, 0);
        size_t inside = 0;
        for (uint32_t i = 0; i < probed.size(); ++i) {
            EXPECT_EQ(probed[i].present, 1u);
            ASSERT_EQ(probed[i].path, i);
            expectPixel(slice, probed[i]);
            inside += probed[i].inside;
        }
        EXPECT_GT(inside, 0u);
    }
}

// A list in any order: an invocation works on the path that is listed for it, in that path's column, and
// knows that path's pixel.
TEST_F(PathTest, ListedPathsKnowTheirPixels) {
    const Slice slice = sliceOf({3, 5, 61, 44}, 1, 30, 16);
    std::vector<uint32_t> list(slice.paths());
    std::iota(list.begin(), list.end(), 0u);
    std::erase_if(list, [](uint32_t path) { return path * 2654435761u >> 30 != 0; });
    std::sort(list.begin(), list.end(),
              [](uint32_t a, uint32_t b) { return a * 2246822519u < b * 2246822519u; });
    ASSERT_GT(list.size(), 300u);
    const std::vector<Probed> probed = probe(slice, samplesOf(Sampler::Grid, 1), 0, list);
    ASSERT_GT(probed.size(), list.size());
    for (size_t i = 0; i < probed.size(); ++i) {
        EXPECT_EQ(probed[i].present, i < list.size() ? 1u : 0u);
        if (i >= list.size()) continue;
        ASSERT_EQ(probed[i].path, list[i]);
        expectPixel(slice, probed[i]);
    }
}

TEST_F(PathTest, DimensionsAreTheReferences) {
    const Slice slice = sliceOf({40, 13, 75, 40}, 0, 20, 2);
    for (const Sampler sampler : {Sampler::Grid, Sampler::Jittered, Sampler::LowDiscrepancy}) {
        const PackedSamples samples = samplesOf(sampler, 9);
        for (const uint32_t index : {0u, 1u, 6u, 8u}) {
            const shared::Sample& row = samples.rows[shared::kFirstSample + index];
            for (const Probed& at : probe(slice, samples, index)) {
                if (!at.inside) continue;
                for (uint32_t pair = 0; pair < kPairs; ++pair)
                    ASSERT_EQ(at.pairs[pair], reference::samplePair(row, pair, at.x, at.y))
                        << static_cast<int>(sampler) << ' ' << index << ' ' << pair;
            }
        }
    }
}

// Kernels are first run over these, whose numbers lanes follow: none may be what was in the memory before.
TEST_F(PathTest, EndedPathsHaveNoNumberToFollow) {
    constexpr uint32_t kRows = shared::kPathRows + 6, kGroup = shared::kWorkgroupSize;
    const PathState state(device(), Access::TexelBuffer, 100, kRows);
    RowEntry garbage;
    std::fill_n(garbage.u, 4, 0x05050505u);
    for (uint32_t row = 0; row < kRows; ++row)
        state.writeRow(device(), row, std::vector<RowEntry>(100, garbage));
    state.writeEnded(device());
    std::vector<RowEntry> found(kRows * kGroup);
    gpu::download(device(), state.buffer(), std::as_writable_bytes(std::span(found)));
    for (uint32_t row = 0; row < kRows; ++row) {
        for (uint32_t path = 0; path < kGroup; ++path) {
            const RowEntry& entry = found[row * kGroup + path];
            for (uint32_t word = 0; word < 4; ++word) {
                if (row == shared::kRowDirection && word == 3)
                    EXPECT_EQ(entry.f[word], shared::kInfinity) << path;
                else
                    EXPECT_EQ(entry.u[word], row == shared::kRowHit && word == 3 ? shared::kNone : 0u)
                        << row << ' ' << path;
            }
        }
    }
}

}  // namespace glint::render::test::path_test
