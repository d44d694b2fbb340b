#include "peer/sampling.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/device_layout.h"
#include "reference/sampling.h"

namespace glint::bench::peer {
namespace {

uint32_t reversed(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

// Burley, JCGT 9(4), 2020.
uint32_t owenScrambled(uint32_t x, uint32_t seed) {
    x = reversed(x);
    x ^= x * 0x3d20adeau;
    x = (x + seed) * ((seed >> 16) | 1u);
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return reversed(x);
}

// Jarzynski, Olano, JCGT 9(3), 2020, pcg4d; the low bits made as good as the high ones.
std::array<uint32_t, 4> hash(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    std::array<uint32_t, 4> v = {a, b, c, d};
    const auto mix = [&v] {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    };
    for (uint32_t& word : v) word = word * 1664525u + 1013904223u;
    mix();
    for (uint32_t& word : v) word ^= word >> 16;
    mix();
    for (uint32_t& word : v) word ^= word >> 16;
    return v;
}

// By the filter's table: each cell leads from one distance to another.
float offsetOf(const PackedSamples& samples, uint32_t table, uint32_t place) {
    const auto* words = reinterpret_cast<const int32_t*>(samples.rows.data());
    const int32_t* ends = words + table * 4 * shared::kFilterRows + 2 * (place >> shared::kFilterCellShift);
    const int64_t part = place / 1024 % 4096;
    const int64_t distance = ends[0] + (int64_t{ends[1]} - ends[0]) * part / 4096;
    return 0.5f + std::ldexp(static_cast<float>(distance), -static_cast<int>(shared::kFilterBits));
}

// Shirley, Chiu 1997.
glm::vec2 concentricDisc(uint32_t a, uint32_t b) {
    const float x = std::ldexp(static_cast<float>(a >> 8), -23) - 1,
                y = std::ldexp(static_cast<float>(b >> 8), -23) - 1;
    if (x == 0 && y == 0) return {0, 0};
    constexpr float kQuarter = std::numbers::pi_v<float> / 4;
    const bool flat = std::abs(x) > std::abs(y);
    const float radius = flat ? x : y, angle = flat ? kQuarter * (y / x) : kQuarter * (2 - x / y);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

}  // namespace

FilmSample filmSample(const PackedSamples& samples, uint32_t index, uint32_t x, uint32_t y) {
    if (!samples.scattered()) return {samples.offsets[index], glm::vec2(0), 1};
    const shared::Sample& s = samples.rows[shared::kFirstSample + index];
    if (s.scatter != shared::kScatterOwen) {
        const reference::FilmSample other = reference::filmSample(samples, index, x, y);
        return {other.offset, other.lens, static_cast<float>(other.weight)};
    }
    const std::array<uint32_t, 4> seeds = hash(x, y, s.key, s.seed);
    FilmSample sample;
    sample.offset = {offsetOf(samples, s.tableX, owenScrambled(s.x, seeds[0])),
                     offsetOf(samples, s.tableY, owenScrambled(s.y, seeds[1]))};
    sample.lens = concentricDisc(owenScrambled(s.lensX, seeds[2]), owenScrambled(s.lensY, seeds[3]));
    sample.weight = s.weight.x;
    return sample;
}

}  // namespace glint::bench::peer
