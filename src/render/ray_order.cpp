#include "render/ray_order.h"

#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace glint::render {

namespace {

// Rays that are sorted together (16 MB). More rays would make neighbours more similar.
constexpr size_t kWindow = size_t{1} << 20;
// Fewer rays keep the caller's order.
constexpr size_t kMinRays = 4096;
constexpr size_t kReadBlock = 1024;

// ---- Rows of an image

constexpr size_t kLongestRow = 8192, kBlockWidth = 8, kBlockHeight = 4;

// Squared distance of two rays: of directions as an angle, of origins in diagonals of the space.
float apart(const RayInput& a, const RayInput& b, float diagonal) {
    const glm::vec3 turn = glm::normalize(a.direction) - glm::normalize(b.direction);
    const glm::vec3 way = (a.origin - b.origin) / diagonal;
    return glm::dot(turn, turn) + glm::dot(way, way);
}

// The number of rays in a row, if the rays form rows: rays within a row are close, and the step to the next
// row is as long as a row.
size_t rowLength(const ReadRays& read, const RayNumbers& numbers, size_t count, float diagonal) {
    constexpr float kFar = 64, kNear = 256, kRounding = 1e-12f;  // squares
    std::array<RayInput, kReadBlock> rays;
    RayInput before;
    float step = 0;
    size_t row = 0;
    for (size_t at = 0; at < std::min(count, kLongestRow + 1) && row == 0; at += kReadBlock) {
        const size_t present = std::min(kReadBlock, count - at);
        read(numbers.from(at), std::span(rays).first(present));
        if (at == 0) step = std::max(apart(rays[0], rays[1], diagonal), kRounding);
        for (size_t i = at == 0 ? 1 : 0; i < present && row == 0; ++i)
            if (!(apart(i == 0 ? before : rays[i - 1], rays[i], diagonal) <= kFar * step)) row = at + i;
        before = rays[present - 1];
    }
    if (row < 2 * kBlockWidth || row > kLongestRow || count < kBlockHeight * row) return 0;
    std::array<RayInput, 2> start, above;
    read(numbers, start);
    for (size_t k = 1; k < kBlockHeight; ++k) {
        above = start;
        read(numbers.from(k * row), start);
        read(numbers.from(k * row - 1), std::span(rays).first(1));
        const bool begins = apart(rays[0], start[0], diagonal) > kFar * step;
        const bool goesOn = apart(start[0], start[1], diagonal) <= kFar * step;
        if (!begins || !goesOn || !(apart(start[0], above[0], diagonal) <= kNear * step)) return 0;
    }
    return row;
}

// Orders four rows at a time, in blocks from left to right.
std::unique_ptr<uint32_t[]> blocksOf(const Context& context, size_t row, size_t count) {
    auto numbers = std::make_unique_for_overwrite<uint32_t[]>(count);
    parallelFor(context, count / (kBlockHeight * row), [&](size_t strip) {
        uint32_t* out = numbers.get() + strip * kBlockHeight * row;
        const auto first = static_cast<uint32_t>(strip * kBlockHeight * row);
        for (size_t left = 0; left < row; left += kBlockWidth) {
            const size_t width = std::min(kBlockWidth, row - left);
            for (size_t y = 0; y < kBlockHeight; ++y)
                for (size_t x = 0; x < width; ++x) *out++ = first + static_cast<uint32_t>(y * row + left + x);
        }
    });
    return numbers;
}

// ---- Coherence

// True if most sampled packets have rays with nearby origins and directions.
bool isCoherent(const ReadRays& read, const RayNumbers& numbers, size_t count, float diagonal) {
    constexpr size_t kPacket = 32, kLooks = 32;
    // Squared; as an angle 2.6 degrees. From there on packets are slower than sorted single rays for closest
    // hits of scenes/showcase.json (0.97 of their rate). Its other queries, and all of scenes/knot.json and
    // scenes/arcade.json, still gain 1.08 to 1.87 (blocks of pinhole rays, lavapipe, commit 29d9cb50).
    constexpr float kApart = 0.002f;
    size_t coherent = 0;
    std::array<RayInput, kPacket> rays;
    for (size_t look = 0; look < kLooks; ++look) {
        read(numbers.from(look * (count / kLooks) / kPacket * kPacket), rays);
        bool together = true;
        for (size_t i = 1; i < kPacket; ++i)
            together = together && apart(rays[0], rays[i], diagonal) < kApart;
        coherent += together ? 1 : 0;
    }
    return 4 * coherent >= 3 * kLooks;
}

// ---- Sorting

constexpr uint32_t kAxisBits = 5;

// Bits 0 to 4 at positions 0, 6, 12, 18 and 24.
uint32_t spread(uint32_t x) {
    return (x & 1u) | (x & 2u) << 5 | (x & 4u) << 10 | (x & 8u) << 15 | (x & 16u) << 20;
}

// The cells in which the ray enters and leaves the space, with interleaved bits (Morton order). A ray that
// starts inside enters there.
uint32_t keyOf(const RayInput& ray, const Space& space, const glm::vec3& scale) {
    constexpr float kCells = 1 << kAxisBits;
    float enters = 0, leaves = shared::kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
        const float inverse = 1 / ray.direction[axis];
        const float a = (space.lower[axis] - ray.origin[axis]) * inverse;
        const float b = (space.upper[axis] - ray.origin[axis]) * inverse;
        const float low = a < b ? a : b, high = a < b ? b : a;
        enters = low > enters ? low : enters;
        leaves = high < leaves ? high : leaves;
    }
    uint32_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float start = ray.origin[axis] - space.lower[axis];
        for (const float t : {enters, leaves}) {
            float cell = (start + t * ray.direction[axis]) * scale[axis];
            cell = cell > 0 ? cell : 0;  // NaN too
            cell = cell < kCells - 1 ? cell : kCells - 1;
            key = key << 1 | spread(static_cast<uint32_t>(static_cast<int32_t>(cell)));
        }
    }
    return key;
}

// An entry is a key above the ray's number, so that rays with equal keys keep their order.
constexpr uint32_t kDigitBits = 10, kHighDigit = 2;
constexpr size_t kDigits = size_t{1} << kDigitBits;
static_assert(6 * kAxisBits == (kHighDigit + 1) * kDigitBits);
size_t digitOf(uint64_t entry, uint32_t digit) {
    return (entry >> (32 + digit * kDigitBits)) & (kDigits - 1);
}

// Sorts by the high digit of the key; returns the start of each digit's run, and the end. Parts run in
// parallel.
std::vector<uint32_t> dealOut(const Context& context, std::span<const uint64_t> from, uint64_t* to) {
    constexpr size_t kParts = 16;
    const size_t each = (from.size() + kParts - 1) / kParts;
    std::vector<std::array<uint32_t, kDigits>> places(kParts);
    const auto partOf = [&](size_t part) {
        return from.subspan(std::min(part * each, from.size()))
            .first(std::min((part + 1) * each, from.size()) - std::min(part * each, from.size()));
    };
    parallelFor(context, kParts, [&](size_t part) {
        places[part].fill(0);
        for (const uint64_t entry : partOf(part)) ++places[part][digitOf(entry, kHighDigit)];
    });
    std::vector<uint32_t> starts(kDigits + 1);
    uint32_t sum = 0;
    for (size_t d = 0; d < kDigits; ++d) {
        starts[d] = sum;
        for (auto& part : places) sum += std::exchange(part[d], sum);
    }
    starts[kDigits] = sum;
    parallelFor(context, kParts, [&](size_t part) {
        for (const uint64_t entry : partOf(part)) to[places[part][digitOf(entry, kHighDigit)]++] = entry;
    });
    return starts;
}

// Sorts a run by one digit of the key; equal digits stay in order.
void dealRun(std::span<const uint64_t> from, uint64_t* to, uint32_t digit) {
    std::array<uint32_t, kDigits> places{};
    for (const uint64_t entry : from) ++places[digitOf(entry, digit)];
    std::exclusive_scan(places.begin(), places.end(), places.begin(), 0u);
    for (const uint64_t entry : from) to[places[digitOf(entry, digit)]++] = entry;
}

// Sorts entries with the same high digit, about a thousand. Two radix passes take 10 ms for a million rays,
// std::sort 34.
void sortRun(std::span<uint64_t> run, uint64_t* spare) {
    if (run.size() < kDigits / 8) {
        std::sort(run.begin(), run.end());
    } else {
        dealRun(run, spare, 0);
        dealRun({spare, run.size()}, run.data(), 1);
    }
}

std::unique_ptr<uint32_t[]> sorted(const Context& context, const ReadRays& read, const RayNumbers& rays,
                                   size_t count, const Space& space) {
    const glm::vec3 size = space.upper - space.lower;
    glm::vec3 scale(0);
    for (int axis = 0; axis < 3; ++axis)
        if (size[axis] > 0) scale[axis] = static_cast<float>(1 << kAxisBits) / size[axis];
    // Not zeroed.
    auto entries = std::make_unique_for_overwrite<uint64_t[]>(count);
    auto other = std::make_unique_for_overwrite<uint64_t[]>(count);
    parallelFor(context, (count + kReadBlock - 1) / kReadBlock, [&](size_t block) {
        std::array<RayInput, kReadBlock> inputs;
        const size_t start = block * kReadBlock, present = std::min(kReadBlock, count - start);
        read(rays.from(start), std::span(inputs).first(present));
        for (size_t i = 0; i < present; ++i)
            entries[start + i] = uint64_t{keyOf(inputs[i], space, scale)} << 32 | (start + i);
    });
    const std::vector<uint32_t> starts = dealOut(context, std::span(entries.get(), count), other.get());
    auto numbers = std::make_unique_for_overwrite<uint32_t[]>(count);
    parallelFor(context, kDigits, [&](size_t d) {
        const std::span run(other.get() + starts[d], starts[d + 1] - starts[d]);
        sortRun(run, entries.get() + starts[d]);
        for (size_t i = 0; i < run.size(); ++i) numbers[starts[d] + i] = static_cast<uint32_t>(run[i]);
    });
    return numbers;
}

}  // namespace

RayOrder orderRays(const ReadRays& read, uint64_t first, size_t count, const Space& space, bool told,
                   const Context& context) {
    RayOrder order;
    order.count = std::min(count, kWindow);
    order.coherent = told;
    if (order.count < kMinRays) return order;
    const float diagonal = glm::length(space.upper - space.lower);
    const RayNumbers given{first, nullptr};
    if (const size_t row = rowLength(read, given, order.count, diagonal); row != 0) {
        const size_t strip = kBlockHeight * row;
        const size_t fitting = order.count / strip * strip;
        RayOrder blocks{fitting, true, blocksOf(context, row, fitting),
                        row % kBlockWidth == 0 ? kBlockWidth : 1};
        if (told || isCoherent(read, blocks.from(first), fitting, diagonal)) return blocks;
    }
    order.coherent = told || isCoherent(read, given, order.count, diagonal);
    if (order.coherent) return order;
    order.numbers = sorted(context, read, given, order.count, space);
    order.coherent = isCoherent(read, order.from(first), order.count, diagonal);
    return order;
}

}  // namespace glint::render
