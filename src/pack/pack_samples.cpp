#include "pack/pack_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "pack/filter_table.h"
#include "pack/sample_points.h"
#include "scene/limits.h"
#include "scene/sampling.h"

namespace glint {

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

// The finalizer of MurmurHash3 (A. Appleby 2011), a bijection in which each bit of the seed turns each bit of
// the result over with probability 1/2; 0 stays 0. Words of pcg4d's results keep their low bits whatever the
// high bits of its arguments are: places that two seeds 2^30 apart scatter would correlate.
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
    // Sequences go on from round to round. The cells of jittered samples are made anew, their random numbers
    // come from the sample's number in the picture.
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

PackedSamples packSamples(const ImageSettings& image, bool lens) {
    const bool everywhere = samplerOf(image) == Sampler::Grid && image.filter == Filter::Box &&
                            image.filterRadius == 0.5 && !lens && !image.adaptive;
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
    ImageSettings image;
    SampleMaker maker;
    explicit State(const ImageSettings& settings) : image(settings), maker(image) {}
};

SampleSequence::SampleSequence(const ImageSettings& image) {
    if (image.sampler == Sampler::Grid) throw std::invalid_argument("a grid cannot be gone on with");
    ImageSettings settings = image;
    if (settings.sampler == Sampler::Auto) settings.sampler = Sampler::LowDiscrepancy;
    state_ = std::make_unique<State>(settings);
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

Request requestOf(const ImageSettings& image, bool lens) {
    Request request;
    request.image = image;
    request.width = image.width;
    request.height = image.height;
    request.samples = packSamples(image, lens);
    return request;
}

}  // namespace glint
