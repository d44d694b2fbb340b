#include "render/settings.h"

namespace glint::render {

Region wholeOrGiven(const RenderSettings& settings) {
    const Region& r = settings.region;
    if (r.width() > 0 && r.height() > 0) return r;
    return {0, 0, settings.width, settings.height};
}

PackedSamples samplesOf(const RenderSettings& settings) {
    return settings.samples ? *settings.samples : PackedSamples::fixed(settings.sampleOffsets);
}

TraceModes modesOf(const RenderSettings& settings, const PackedSamples& samples) {
    TraceModes modes;
    modes.cost = settings.cost;
    modes.aovs = settings.data || settings.cost;
    modes.shadowless = !settings.shadows;
    modes.ledger = settings.ledger;
    modes.tally = settings.tally;
    modes.scattered = samples.scattered();
    modes.adaptive = samples.threshold.has_value();
    return modes;
}

}  // namespace glint::render
