#include "pack/pack_samples.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "scene/limits.h"
#include "scene/sampling.h"

namespace glint {

namespace {

// ---- Filters

// Steps of the sums below: a multiple of 4, so that the zeros of Mitchell's filter lie between two steps.
constexpr int kSteps = 1 << 16;

double mitchell(double x) {
    const double b = 1.0 / 3, c = 1.0 / 3;
    x = std::abs(x);
    if (x >= 2) return 0;
    if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
    return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) /
           6;
}

uint32_t fixedDistance(double distance) {
    return static_cast<uint32_t>(
        static_cast<int32_t>(std::lround(std::ldexp(distance, shared::kFilterBits))));
}

// The inverse of the sums of `density`, whose steps fill [-radius, radius]. Where the density is 0 between
// two parts, the sum is the same all along: a cell that ends there ends before the gap, one that begins there
// begins behind it.
std::vector<uint32_t> invert(const std::vector<double>& density, double radius) {
    std::vector<double> sums(density.size() + 1, 0.0);
    for (size_t i = 0; i < density.size(); ++i) sums[i + 1] = sums[i] + density[i];
    const double mass = sums.back(), rounding = 1e-12 * mass;
    const auto place = [&](std::vector<double>::const_iterator end, double wanted) {
        const size_t step =
            std::clamp<size_t>(static_cast<size_t>(end - sums.begin()), 1, density.size()) - 1;
        const double within = std::clamp((wanted - sums[step]) / std::max(density[step], 1e-300), 0.0, 1.0);
        return fixedDistance(radius * (2 * (static_cast<double>(step) + within) / kSteps - 1));
    };
    std::vector<uint32_t> cells;
    cells.reserve(2 * shared::kFilterCells);
    for (uint32_t i = 0; i < shared::kFilterCells; ++i) {
        const double first = mass * i / shared::kFilterCells, last = mass * (i + 1) / shared::kFilterCells;
        cells.push_back(place(std::upper_bound(sums.begin(), sums.end(), first + rounding), first));
        cells.push_back(place(std::lower_bound(sums.begin(), sums.end(), last - rounding), last));
    }
    return cells;
}

// ---- Points

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

double filterValue(Filter filter, double x, double radius) {
    if (std::abs(x) > radius) return 0;
    const double relative = x / radius;
    switch (filter) {
        case Filter::Box:
            return 1;
        case Filter::Tent:
            return 1 - std::abs(relative);
        case Filter::Gaussian:
            return std::exp(-4.5 * relative * relative) - std::exp(-4.5);
        case Filter::Mitchell:
            return mitchell(2 * relative);
    }
    return 0;
}

FilterParts filterParts(Filter filter, double radius) {
    std::vector<double> positive(kSteps), negative(kSteps);
    double positiveMass = 0, negativeMass = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double value = filterValue(filter, radius * (2 * (i + 0.5) / kSteps - 1), radius);
        positive[i] = std::max(value, 0.0);
        negative[i] = std::max(-value, 0.0);
        positiveMass += positive[i];
        negativeMass += negative[i];
    }
    FilterParts parts;
    const double whole = positiveMass - negativeMass;
    parts.positive = {positiveMass / whole, invert(positive, radius)};
    parts.negative.mass = negativeMass / whole;
    parts.negative.cells.assign(2 * shared::kFilterCells, 0u);
    if (negativeMass > 0) parts.negative.cells = invert(negative, radius);
    return parts;
}

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

namespace {

// Samples whose x and y are drawn from the positive (0) or the negative (1) part of the filter.
struct SampleClass {
    uint32_t tableX = 0, tableY = 0;
    double mass = 1;  // of the filter over these, as a share of its integral
    uint32_t count = 0;
};

// A filter that is never negative has one class. Mitchell's has four, whose samples are counted out by the
// integral of |filter|, one at least of each class that weighs more than a thousandth of the positive one.
std::vector<SampleClass> classesOf(const FilterParts& parts, uint32_t count) {
    const double p = parts.positive.mass, n = parts.negative.mass;
    if (n == 0) return {{0, 0, 1, count}};
    std::vector<SampleClass> classes = {{0, 0, p * p}, {1, 0, n * p}, {0, 1, p * n}, {1, 1, n * n}};
    const double all = (p + n) * (p + n);
    uint32_t left = count;
    for (size_t i = 1; i < classes.size(); ++i) {
        const auto share = static_cast<uint32_t>(std::lround(count * classes[i].mass / all));
        classes[i].count = std::min(std::max(share, i < 3 ? 1u : 0u), left - 1);
        left -= classes[i].count;
    }
    classes[0].count = left;
    return classes;
}

// The finalizer of MurmurHash3 (A. Appleby 2011), a bijection in which each bit of the seed flips each bit of
// the result with probability 1/2; 0 stays 0. Without it, places scattered by two seeds 2^30 apart would
// correlate: the low bits of pcg4d's results do not depend on the high bits of its arguments.
uint32_t mixed(uint32_t seed) {
    seed = (seed ^ (seed >> 16)) * 0x85ebca6bu;
    seed = (seed ^ (seed >> 13)) * 0xc2b2ae35u;
    return seed ^ (seed >> 16);
}

double sign(const SampleClass& c) {
    return c.tableX == c.tableY ? 1.0 : -1.0;
}

shared::Sample sampleOf(const FixedPoint& place, const SampleClass& c, double weight, uint32_t seed) {
    shared::Sample s;
    s.x = place[0];
    s.y = place[1];
    s.lensX = place[2];
    s.lensY = place[3];
    s.tableX = c.tableX;
    s.tableY = c.tableY;
    s.weight = glm::vec3(static_cast<float>(weight));
    s.seed = seed;
    return s;
}

class SampleMaker {
  public:
    explicit SampleMaker(const ImageSettings& image)
        : seed_(mixed(image.seed)),
          sampler_(samplerOf(image)),
          parts_(filterParts(image.filter, image.filterRadius)) {}

    void addTables(std::vector<shared::Sample>& rows) const {
        static_assert(sizeof(shared::Sample) * shared::kFirstSample == 2 * 16 * shared::kFilterRows);
        static_assert(16 * shared::kFilterRows == 4 * 2 * shared::kFilterCells);
        rows.resize(shared::kFirstSample);
        auto* bytes = reinterpret_cast<std::byte*>(rows.data());
        const size_t size = 16 * shared::kFilterRows;
        std::memcpy(bytes, parts_.positive.cells.data(), size);
        std::memcpy(bytes + size, parts_.negative.cells.data(), size);
    }

    // `count` samples whose weights sum to their number.
    void addRound(uint32_t count, std::vector<shared::Sample>& rows) {
        const std::vector<SampleClass> classes = classesOf(parts_, count);
        double kept = 0;
        for (const SampleClass& c : classes) kept += c.count > 0 ? sign(c) * c.mass : 0.0;
        for (size_t i = 0; i < classes.size(); ++i) {
            const double weight = sign(classes[i]) * classes[i].mass / kept * count / classes[i].count;
            if (classes[i].count > 0) addClass(i, classes[i], weight, rows);
        }
    }

  private:
    // Sequences continue from round to round. The cells of jittered samples are made again for each round;
    // their random numbers come from the sample's number in the image.
    void addClass(size_t number, const SampleClass& c, double weight, std::vector<shared::Sample>& rows) {
        const auto add = [&](const FixedPoint& place, uint32_t scatter, uint32_t key,
                             const FixedPoint& width) {
            shared::Sample s = sampleOf(place, c, weight, seed_);
            s.scatter = scatter;
            s.key = key;
            s.widthX = width[0];
            s.widthY = width[1];
            s.widthLensX = width[2];
            s.widthLensY = width[3];
            rows.push_back(s);
        };
        const auto key = static_cast<uint32_t>(number);
        const uint32_t order = seed_ + 4 * round_++ + key;
        if (sampler_ == Sampler::Grid) {
            for (const FixedPoint& p : gridPoints(c.count, key)) add(p, shared::kScatterNone, key, {});
        } else if (sampler_ == Sampler::Jittered) {
            for (const FixedCell& cell : stratifiedCells(c.count, order))
                add(cell.low, shared::kScatterJitter, taken_++, cell.width);
        } else {
            for (uint32_t i = 0; i < c.count; ++i)
                add(sobolPoint(next_[number]++), shared::kScatterOwen, key, {});
        }
    }

    uint32_t seed_;
    Sampler sampler_;
    FilterParts parts_;
    std::array<uint32_t, 4> next_{};  // of each class's sequence
    uint32_t taken_ = 0, round_ = 0;
};

}  // namespace

PackedSamples packSamples(const ImageSettings& image, const Camera& camera) {
    const bool everywhere = samplerOf(image) == Sampler::Grid && image.filter == Filter::Box &&
                            image.filterRadius == 0.5 && !hasLens(camera) && !image.adaptive;
    if (everywhere) return PackedSamples::fixed(sampleOffsets(image.samplesPerPixel));
    PackedSamples samples;
    samples.round = static_cast<uint32_t>(image.samplesPerPixel);
    SampleMaker maker(image);
    maker.addTables(samples.rows);
    uint32_t rounds = 1;
    if (image.adaptive) {
        rounds = std::max(1u, static_cast<uint32_t>(image.adaptive->maxSamples) / samples.round);
        samples.threshold = static_cast<float>(image.adaptive->threshold);
    }
    for (uint32_t i = 0; i < rounds; ++i) maker.addRound(samples.round, samples.rows);
    return samples;
}

struct SampleSequence::State {
    SampleMaker maker;
};

SampleSequence::SampleSequence(const ImageSettings& image) {
    if (image.sampler == Sampler::Grid)
        throw std::invalid_argument("SampleSequence: the grid sampler has no further samples");
    ImageSettings settings = image;
    if (settings.sampler == Sampler::Auto) settings.sampler = Sampler::LowDiscrepancy;
    state_ = std::make_unique<State>(State{SampleMaker(settings)});
}
SampleSequence::~SampleSequence() = default;
SampleSequence::SampleSequence(SampleSequence&&) noexcept = default;
SampleSequence& SampleSequence::operator=(SampleSequence&&) noexcept = default;

PackedSamples SampleSequence::next(uint32_t count) {
    PackedSamples samples;
    samples.round = count;
    state_->maker.addTables(samples.rows);
    state_->maker.addRound(count, samples.rows);
    return samples;
}

uint32_t leastSamples(Filter filter) {
    return filter == Filter::Mitchell ? static_cast<uint32_t>(kMinMitchellSamples) : 1;
}

Request requestOf(const ImageSettings& image, const Camera& camera) {
    Request request;
    static_cast<ImageSettings&>(request) = image;
    request.camera = camera;
    request.samples = packSamples(image, camera);
    return request;
}

}  // namespace glint
