#include "pack/sample_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "scene/sampling.h"
#include "trace/picture.h"

namespace glint {

namespace {

// Initial direction numbers m and primitive polynomials of dimensions 2 to 4 (dimension 1 is van der Corput's
// sequence): degree s, inner coefficients a.
struct Polynomial {
    uint32_t s, a;
    std::array<uint32_t, 3> m;
};
constexpr std::array<Polynomial, 3> kPolynomials = {{{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}}};

using Directions = std::array<std::array<uint32_t, 32>, 4>;

// P. Bratley, B. L. Fox, ACM TOMS 14(1), 1988: v_i = a_1 v_(i-1) ^ ... ^ v_(i-s) ^ (v_(i-s) >> s).
Directions makeDirections() {
    Directions v{};
    for (uint32_t i = 0; i < 32; ++i) v[0][i] = 0x80000000u >> i;
    for (size_t d = 1; d < v.size(); ++d) {
        const Polynomial& p = kPolynomials[d - 1];
        for (uint32_t i = 0; i < 32; ++i) {
            if (i < p.s) {
                v[d][i] = p.m[i] << (31 - i);
                continue;
            }
            v[d][i] = v[d][i - p.s] ^ (v[d][i - p.s] >> p.s);
            for (uint32_t k = 1; k < p.s; ++k)
                if ((p.a >> (p.s - 1 - k)) & 1u) v[d][i] ^= v[d][i - k];
        }
    }
    return v;
}

// 0 .. count-1 in an order that depends on `seed` alone (Fisher and Yates; splitmix64 of Steele, Lea, Flood
// 2014).
std::vector<uint32_t> shuffled(uint32_t count, uint32_t seed) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    uint64_t state = seed;
    for (uint32_t left = count; left > 1; --left) {
        uint64_t z = state += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        std::swap(order[left - 1], order[((z ^ (z >> 31)) >> 32) * left >> 32]);
    }
    return order;
}

uint32_t part(uint64_t index, uint64_t count) {
    return static_cast<uint32_t>(std::min<uint64_t>((index << 32) / count, 0xffffffffu));
}

uint32_t fixed(double x) {
    return static_cast<uint32_t>(std::min(std::ldexp(x, 32), 4294967295.0));
}

}  // namespace

FixedPoint sobolPoint(uint32_t index) {
    static const Directions directions = makeDirections();
    FixedPoint point{};
    for (uint32_t bit = 0; index >> bit; ++bit) {
        if (!((index >> bit) & 1u)) continue;
        for (size_t d = 0; d < point.size(); ++d) point[d] ^= directions[d][bit];
        if (bit == 31) break;
    }
    return point;
}

std::vector<FixedCell> stratifiedCells(uint32_t count, uint32_t seed) {
    const auto rows = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
    std::vector<FixedCell> cells;
    uint32_t done = 0;
    for (uint32_t row = 0; row < rows; ++row) {
        const uint32_t columns = (count - done) / (rows - row);
        const uint32_t top = part(done, count), bottom = part(done + columns, count);
        for (uint32_t column = 0; column < columns; ++column) {
            const uint32_t left = part(column, columns), right = part(column + 1, columns);
            cells.push_back({{left, top, 0, 0}, {right - left, bottom - top, 0, 0}});
        }
        done += columns;
    }
    const std::vector<uint32_t> order = shuffled(count, seed);
    for (uint32_t i = 0; i < count; ++i) {
        for (size_t d = 0; d < 2; ++d) {
            cells[i].low[2 + d] = cells[order[i]].low[d];
            cells[i].width[2 + d] = cells[order[i]].width[d];
        }
    }
    return cells;
}

std::vector<FixedPoint> gridPoints(uint32_t count, uint32_t seed) {
    const std::vector<glm::dvec2> offsets = sampleOffsets(static_cast<int>(count));
    const std::vector<uint32_t> order = shuffled(count, seed);
    std::vector<FixedPoint> points;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::dvec2 film = offsets[i], lens = offsets[order[i]];
        points.push_back({fixed(film.x), fixed(film.y), fixed(lens.x), fixed(lens.y)});
    }
    return points;
}

}  // namespace glint
