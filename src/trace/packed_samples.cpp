#include "trace/packed_samples.h"

#include <utility>

namespace glint {

uint32_t PackedSamples::count() const {
    return static_cast<uint32_t>(scattered() ? rows.size() - shared::kFirstSample : offsets.size());
}

PackedSamples PackedSamples::only(uint32_t index) const {
    PackedSamples one;
    if (scattered()) {
        one.rows.assign(rows.begin(), rows.begin() + shared::kFirstSample);
        one.rows.push_back(rows[shared::kFirstSample + index]);
    } else {
        one.offsets = {offsets[index]};
    }
    return one;
}

PackedSamples PackedSamples::fixed(std::vector<glm::dvec2> offsets) {
    PackedSamples samples;
    samples.round = static_cast<uint32_t>(offsets.size());
    samples.offsets = std::move(offsets);
    return samples;
}

}  // namespace glint
