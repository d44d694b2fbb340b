#include "trace/request.h"

#include <algorithm>
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

Region regionOf(const Request& request) {
    const Region& r = request.region;
    if (r.x0 == 0 && r.y0 == 0 && r.x1 == 0 && r.y1 == 0) return {0, 0, request.width, request.height};
    Region cut = {std::clamp(r.x0, 0, request.width), std::clamp(r.y0, 0, request.height), 0, 0};
    cut.x1 = std::clamp(r.x1, cut.x0, request.width);
    cut.y1 = std::clamp(r.y1, cut.y0, request.height);
    return cut;
}

uint64_t cameraRaysOf(const Request& request) {
    return regionOf(request).pixels() * request.samples.count();
}

Picture blankPicture(const Request& request) {
    Picture picture;
    picture.region = regionOf(request);
    const uint64_t pixels = picture.region.pixels();
    picture.color = Image(picture.region.width(), picture.region.height(), 4);
    picture.done.assign(pixels, 0);
    picture.samplesPerPixel = request.samples.count();
    if (request.samples.threshold) picture.samples.assign(pixels, 0);
    if (request.wantsData()) picture.data.resize(pixels);
    if (request.exact) picture.exact.resize(pixels);
    return picture;
}

}  // namespace glint
