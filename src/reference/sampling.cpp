#include "reference/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/device_layout.h"
#include "core/vectors.h"

namespace glint::reference {

namespace {

using Words = std::array<uint32_t, 4>;
using Pair = std::array<uint32_t, 2>;

// M. Jarzynski, M. Olano, JCGT 9(3), 2020: a linear congruential step of each word (Numerical Recipes'
// constants), two rounds in which each word takes in the product of two others, a shift between them.
Words pcg4d(Words w) {
    for (uint32_t& word : w) word = word * 1664525u + 1013904223u;
    const auto mix = [&w] {
        constexpr int kFactors[4][2] = {{1, 3}, {2, 0}, {0, 1}, {1, 2}};
        for (int i = 0; i < 4; ++i) w[i] += w[kFactors[i][0]] * w[kFactors[i][1]];
    };
    mix();
    for (uint32_t& word : w) word ^= word >> 16;
    mix();
    return w;
}

// Words whose low bits are as good as their high ones, for owenScrambled.
Words evenWords(const Words& of) {
    Words words = pcg4d(of);
    for (uint32_t& word : words) word ^= word / 65536;
    return words;
}

uint32_t bitfieldReverse(uint32_t bits) {
    uint32_t result = 0;
    for (int i = 0; i < 32; ++i) result |= ((bits >> i) & 1u) << (31 - i);
    return result;
}

// B. Burley, JCGT 9(4), 2020.
uint32_t owenScrambled(uint32_t x, uint32_t seed) {
    uint32_t bits = bitfieldReverse(x);
    bits ^= bits * 0x3d20adeau;
    bits = (bits + seed) * ((seed >> 16) | 1u);
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bitfieldReverse(bits);
}

// 12 bits of the place lead from a cell's first distance to its last one; what is left of them is cut off.
double filmOffset(const PackedSamples& samples, uint32_t table, uint32_t place) {
    const auto* words = reinterpret_cast<const int32_t*>(samples.rows.data());
    const int32_t* ends = words + table * 4 * shared::kFilterRows + 2 * (place >> shared::kFilterCellShift);
    const int64_t part = place / 1024 % 4096;
    const int64_t distance = ends[0] + (int64_t{ends[1]} - ends[0]) * part / 4096;
    return 0.5 + std::ldexp(static_cast<double>(distance), -static_cast<int>(shared::kFilterBits));
}

double lensCoordinate(uint32_t place) {
    return std::ldexp(static_cast<double>(place >> 8), -24);
}

}  // namespace

Pair samplePair(const shared::Sample& s, uint32_t pair, uint32_t x, uint32_t y) {
    const size_t first = 2 * pair;
    const Words places = {s.x, s.y, s.lensX, s.lensY},
                widths = {s.widthX, s.widthY, s.widthLensX, s.widthLensY};
    Pair at = {places[first], places[first + 1]};
    if (s.scatter == shared::kScatterNone) return at;
    if (s.scatter == shared::kScatterOwen) {
        const Words seeds = evenWords({x, y, s.key, s.seed});
        return {owenScrambled(at[0], seeds[first]), owenScrambled(at[1], seeds[first + 1])};
    }
    const Words random = pcg4d({x, y, s.key, s.seed});
    const Words shift = pcg4d({x, y, shared::kLensKey, s.seed});
    for (size_t i = 0; i < 2; ++i) {
        at[i] += static_cast<uint32_t>(uint64_t{random[first + i]} * widths[first + i] / (uint64_t{1} << 32));
        if (pair == shared::kPairLens) at[i] += shift[first + i];
    }
    return at;
}

FilmSample filmSample(const PackedSamples& samples, uint32_t index, uint32_t x, uint32_t y) {
    if (!samples.scattered()) return {samples.offsets[index], glm::dvec2(0), 1};
    const shared::Sample& s = samples.rows[shared::kFirstSample + index];
    const Pair film = samplePair(s, shared::kPairFilm, x, y);
    const Pair lens = samplePair(s, shared::kPairLens, x, y);
    FilmSample result;
    result.offset = {filmOffset(samples, s.tableX, film[0]), filmOffset(samples, s.tableY, film[1])};
    result.lens = concentricDisc(lensCoordinate(lens[0]), lensCoordinate(lens[1]));
    result.weight = s.weight.x;
    return result;
}

// Camera rays: docs/reference/shading.md.
Ray Tracer::cameraRay(const rows::Camera& camera, double x, double y, const glm::dvec2& lens) const {
    // From the middle of the film.
    const double right = x - camera.halfWidth, down = y - camera.halfHeight;
    const auto reach = [&](const glm::dvec3& middle, const glm::dvec3& stepX, const glm::dvec3& stepY) {
        return greatestMagnitude(glm::abs(middle) + glm::abs(right * stepX) + glm::abs(down * stepY));
    };
    const glm::dvec3 direction = camera.center + right * camera.stepX + down * camera.stepY;
    Ray ray;
    ray.origin = camera.eye + right * camera.originStepX + down * camera.originStepY;
    ray.direction = glm::normalize(direction);
    ray.originScale = reach(camera.eye, camera.originStepX, camera.originStepY);
    ray.directionScale =
        std::max(1.0, reach(camera.center, camera.stepX, camera.stepY) / glm::length(direction));
    if (camera.inverseFocus != 0) {
        const glm::dvec3 aside = lens.x * camera.lensX + lens.y * camera.lensY;
        const double focus = 1 / camera.inverseFocus;
        const glm::dvec3 pinhole = ray.origin;
        ray.origin += aside;
        ray.direction = glm::normalize(pinhole + focus * direction - ray.origin);
        // Twice a pinhole's roundings: those of the lens point and its way to the focus.
        const double radius = glm::length(camera.lensX);
        ray.originScale = 2 * (ray.originScale + radius);
        const double reached = glm::length(direction - aside / focus);
        ray.directionScale =
            2 * std::max(1.0, (reach(camera.center, camera.stepX, camera.stepY) + radius / focus) / reached);
    }
    ray.tMin = camera.nearT;
    if (camera.farT < shared::kInfinity) ray.tMax = camera.farT;
    return ray;
}

PixelSample pixelSample(const Tracer& tracer, const rows::Camera& camera, const PackedSamples& samples,
                        uint32_t index, int x, int y) {
    const FilmSample s = filmSample(samples, index, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
    return {s.weight, tracer.cameraRay(camera, x + s.offset.x, y + s.offset.y, s.lens)};
}

// Squares about the centre become circles; the four triangles that the diagonals cut them into go each to a
// quarter of the disc, with the angle from the triangle's middle in proportion to the way along the side.
glm::dvec2 concentricDisc(double a, double b) {
    const double x = 2 * a - 1, y = 2 * b - 1;
    const double radius = std::max(std::abs(x), std::abs(y));
    if (radius == 0) return glm::dvec2(0);
    constexpr double kEighth = std::numbers::pi / 4;
    double angle;
    if (x > std::abs(y))
        angle = kEighth * (y / x);
    else if (-x > std::abs(y))
        angle = kEighth * (4 + y / x);
    else if (y > 0)
        angle = kEighth * (2 - x / y);
    else
        angle = kEighth * (6 - x / y);
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

bool needsMore(const std::vector<glm::dvec3>& colors, double threshold) {
    const auto n = static_cast<double>(colors.size());
    if (colors.size() < 2) return false;
    glm::dvec3 mean(0), squares(0);
    for (const glm::dvec3& c : colors) mean += c / n;
    for (const glm::dvec3& c : colors) squares += (c - mean) * (c - mean);
    for (int c = 0; c < 3; ++c) {
        const double standardError = std::sqrt(squares[c] / (n * (n - 1)));
        if (standardError > threshold * std::max(mean[c], static_cast<double>(shared::kDarkestMean)))
            return true;
    }
    return false;
}

}  // namespace glint::reference
