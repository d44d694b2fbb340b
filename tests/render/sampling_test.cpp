// Samplers, filters, adaptive sampling and the lens on the device.
#include <algorithm>

#include "core/device_layout.h"
#include "pack/pack_samples.h"
#include "reference/sampling.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::sampling_test {
class Sampling : public RenderTest {};

Request settingsOf(const Case& c, const ImageSettings& image) {
    auto settings = sized<Request>(c);
    settings.samples = packSamples(image, c.camera);
    return settings;
}

ImageSettings imageOf(Sampler sampler, Filter filter, double radius, int spp) {
    return {.samplesPerPixel = spp, .sampler = sampler, .filter = filter, .filterRadius = radius, .seed = 3};
}

TEST_F(Sampling, VerifyExplainsEverySamplerAndFilter) {
    const std::pair<Sampler, Filter> choices[] = {{Sampler::Grid, Filter::Box},
                                                  {Sampler::Jittered, Filter::Tent},
                                                  {Sampler::LowDiscrepancy, Filter::Gaussian},
                                                  {Sampler::LowDiscrepancy, Filter::Mitchell}};
    for (const char* name : {"sampling", "lens"}) {
        const Case c = fileCase(name, 48, 36);
        Renderer renderer(device(), c.packed);
        for (const auto& [sampler, filter] : choices) {
            verify::Options options;
            options.samples = packSamples(imageOf(sampler, filter, 1.25, 4), c.camera);
            const verify::Report report = verified(renderer, c, options);
            EXPECT_EQ(report.unexplained, 0u) << name;
            EXPECT_EQ(report.pixels, 4u * 48 * 36);
        }
    }
}

// The plain grid, through the table of samples and the box filter, is the grid of push constants.
TEST_F(Sampling, GridThroughTheTableIsTheGrid) {
    const Case c = fileCase("sampling", 64, 48);
    Renderer renderer(device(), c.packed);
    Request plain = settingsOf(c, imageOf(Sampler::Grid, Filter::Box, 0.5, 4));
    ASSERT_FALSE(plain.samples.scattered());
    Request table = plain;
    table.samples = packSamples(imageOf(Sampler::Grid, Filter::Box, 0.5, 4), fileCase("lens", 1, 1).camera);
    ASSERT_TRUE(table.samples.scattered());
    const Picture a = renderer.render(plain), b = renderer.render(table);
    EXPECT_TRUE(sameBits(a, b));
}

TEST_F(Sampling, SlicesCropsAndOrderChangeNothing) {
    const Case c = fileCase("lens", 64, 48);
    for (const bool adaptive : {false, true}) {
        ImageSettings image = imageOf(Sampler::LowDiscrepancy, Filter::Tent, 1, 4);
        if (adaptive) image.adaptive = AdaptiveSampling{16, 0.1};
        const Request settings = settingsOf(c, image);
        Renderer whole(device(), c.packed);
        Renderer sliced(device(), c.packed, {.maxSlicePixels = 1024});
        const Picture a = whole.render(settings);
        EXPECT_TRUE(sameBits(a, sliced.render(settings)));
        Request crop = settings;
        crop.region = {13, 9, 40, 33};
        const Picture part = whole.render(crop);
        for (int y = 9; y < 33; ++y)
            for (int x = 13; x < 40; ++x)
                for (int channel = 0; channel < 4; ++channel)
                    ASSERT_EQ(part.color.at(x - 13, y - 9, channel), a.color.at(x, y, channel));
        image.seed = 4;
        EXPECT_FALSE(sameBits(a, whole.render(settingsOf(c, image))));
    }
}

// No pixel with any contrast reaches this threshold: pixels take all samples, or have a single colour. Sums
// are added up sample by sample, hence the tolerance: 16 roundings of 2^-24 of the brightest samples, 18.
TEST_F(Sampling, AdaptiveIsUniformWhereAllIsFlagged) {
    const Case c = fileCase("lens", 64, 48);
    Renderer renderer(device(), c.packed);
    ImageSettings image = imageOf(Sampler::LowDiscrepancy, Filter::Box, 0.5, 4);
    image.adaptive = AdaptiveSampling{16, 1e-9};
    const Picture adaptive = renderer.render(settingsOf(c, image));
    image.adaptive.reset();
    image.samplesPerPixel = 16;
    const Picture uniform = renderer.render(settingsOf(c, image));
    size_t flagged = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const uint32_t taken = adaptive.samples[y * 64 + x];
            ASSERT_TRUE(taken % 4 == 0 && taken >= 4 && taken <= 16);
            if (taken < 16) continue;
            ++flagged;
            for (int channel = 0; channel < 4; ++channel)
                EXPECT_NEAR(adaptive.color.at(x, y, channel), uniform.color.at(x, y, channel),
                            16 * 18 * 0x1p-24);
        }
    EXPECT_GT(flagged, 0u);
    EXPECT_LT(flagged, adaptive.samples.size());  // the floor has one colour
}

// From the device's own samples, drawn one by one, the reference decides after every round whether a pixel
// goes on. The device decides the same at usual thresholds, except if its fp32 sums may err by more than the
// margin (verify/film.cpp).
TEST_F(Sampling, EveryRoundIsDecidedAsTheReferenceWould) {
    constexpr uint32_t kRound = 4, kMost = 64;
    size_t doubtful = 0, late = 0;
    for (const char* name : {"sampling", "lens"}) {
        const Case c = fileCase(name, 48, 36);
        Renderer renderer(device(), c.packed);
        for (const double threshold : {0.02, 0.05, 0.2}) {
            ImageSettings image = imageOf(Sampler::LowDiscrepancy, Filter::Box, 0.5, kRound);
            image.adaptive = AdaptiveSampling{kMost, threshold};
            Request request = settingsOf(c, image);
            const PackedSamples all = request.samples;
            const Picture adaptive = renderer.render(request);
            std::vector<std::vector<glm::dvec3>> colors(adaptive.samples.size());
            for (uint32_t i = 0; i < kMost; ++i) {
                request.samples = all.only(i);
                const Picture one = renderer.render(request);
                for (size_t at = 0; at < colors.size(); ++at) {
                    const float* pixel = &one.color.pixels[4 * at];
                    colors[at].emplace_back(pixel[0], pixel[1], pixel[2]);
                }
            }
            for (size_t at = 0; at < colors.size(); ++at) {
                const uint32_t taken = adaptive.samples[at];
                late += taken > 2 * kRound && taken < kMost ? 1 : 0;
                std::vector<glm::dvec3> sofar;
                double greatest = 0;
                for (uint32_t round = kRound; round <= std::min(taken, kMost - kRound); round += kRound) {
                    for (uint32_t i = round - kRound; i < round; ++i) {
                        sofar.push_back(colors[at][i]);
                        greatest = std::max({greatest, sofar.back().x, sofar.back().y, sofar.back().z});
                    }
                    const double slack =
                        8 * 0x1p-24 * round * (1 + greatest / (threshold * shared::kDarkestMean));
                    const bool goesOn = round < taken;
                    const bool may = reference::needsMore(sofar, threshold * (1 + (goesOn ? -slack : slack)));
                    EXPECT_EQ(may, goesOn)
                        << name << ' ' << threshold << ", pixel " << at << ", after " << round;
                    doubtful += reference::needsMore(sofar, threshold) == goesOn ? 0 : 1;
                }
            }
        }
    }
    EXPECT_GT(late, 100u) << "nothing is decided after the second round";
    EXPECT_LT(doubtful, 10u);
}

// 512 samples of a small picture: no submission holds more than one sample's bounce.
TEST_F(Sampling, ManySamplesAreManySubmissions) {
    const Case c = fileCase("lens", 16, 16);
    Renderer renderer(device(), c.packed);
    renderer.render(settingsOf(c, imageOf(Sampler::LowDiscrepancy, Filter::Box, 0.5, 512)));
    EXPECT_GE(renderer.times().submissions, 512u);
    Request stopped = settingsOf(c, imageOf(Sampler::LowDiscrepancy, Filter::Box, 0.5, 512));
    const uint64_t before = renderer.times().submissions;
    stopped.cancelled = [] { return true; };
    EXPECT_FALSE(renderer.render(stopped).complete);
    EXPECT_LE(renderer.times().submissions, before + 2);
}

}  // namespace glint::render::test::sampling_test
