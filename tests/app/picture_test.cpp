// The reference's pictures, made band by band.
#include <algorithm>
#include <atomic>

#include "import/load.h"
#include "reference/render.h"
#include "support.h"
#include "verify/reference_picture.h"

namespace glint::app::test {
namespace {

class ReferencePicture : public ::testing::Test {
  protected:
    // 20000 pixels a row make bands of a few rows.
    ReferencePicture() {
        scene_ = parseScene(sceneText(20000, 90, R"("background": 0.5, "ambient": 1,
            "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 3}])"),
                            "a.json", ".");
        packed_ = packScene(scene_);
        settings_.width = 20000;
        settings_.height = 90;
        settings_.region = {9900, 0, 10060, 90};
        settings_.data = true;
        camera_ = packCamera(scene_.camera, 20000, 90, packed_.origin);
    }
    Scene scene_;
    PackedScene packed_;
    shared::Camera camera_;
    render::RenderSettings settings_;
};

TEST_F(ReferencePicture, BandsMakeTheSamePictureAsOnePiece) {
    settings_.region = {0, 20, 20000, 62};  // several bands
    settings_.sampleOffsets = {{0.25, 0.5}, {0.75, 0.5}};
    const Picture picture = verify::renderReference(packed_, camera_, settings_);
    reference::RenderOptions options;
    options.y0 = 20;
    options.y1 = 62;
    options.sampleOffsets = settings_.sampleOffsets;
    const reference::RenderResult whole = reference::render(packed_, camera_, 20000, 90, options);
    ASSERT_EQ(picture.data.size(), whole.pixels.size());
    EXPECT_TRUE(picture.complete);
    size_t different = 0;
    for (size_t i = 0; i < whole.pixels.size(); ++i) {
        const bool same = picture.color.pixels[i * 4] == static_cast<float>(whole.pixels[i].color.x) &&
                          picture.color.pixels[i * 4 + 3] == static_cast<float>(whole.pixels[i].alpha) &&
                          picture.done[i] == 1 && picture.data[i].depth == whole.pixels[i].depth &&
                          picture.data[i].pathHash == whole.pixels[i].pathHash;
        different += same ? 0 : 1;
    }
    EXPECT_EQ(different, 0u);
}

TEST_F(ReferencePicture, ProgressRisesToOne) {
    settings_.region = {0, 0, 20000, 90};
    double last = 0;
    bool rises = true;
    settings_.progress = [&](double fraction) {
        rises = rises && fraction >= last;
        last = fraction;
    };
    verify::renderReference(packed_, camera_, settings_);
    EXPECT_TRUE(rises);
    EXPECT_EQ(last, 1.0);
}

TEST_F(ReferencePicture, CancelledKeepsTheFinishedRows) {
    settings_.region = {0, 0, 20000, 90};
    std::atomic<bool> stop{false};
    settings_.progress = [&](double fraction) { stop = stop || fraction >= 0.4; };
    settings_.cancelled = [&] { return stop.load(); };
    const Picture picture = verify::renderReference(packed_, camera_, settings_);
    EXPECT_FALSE(picture.complete);
    const auto done = static_cast<size_t>(std::count(picture.done.begin(), picture.done.end(), 1));
    EXPECT_GE(done, picture.done.size() * 2 / 5);
    EXPECT_LT(done, picture.done.size());
    EXPECT_EQ(done % 20000, 0u) << "whole rows";
    size_t wrong = 0;
    for (size_t i = 0; i < picture.done.size(); ++i) {
        const bool filled = picture.color.pixels[i * 4] != 0;  // background and sphere are both bright
        wrong += filled == (picture.done[i] == 1) ? 0 : 1;
    }
    EXPECT_EQ(wrong, 0u);
}

TEST_F(ReferencePicture, NoDataUnlessAskedFor) {
    settings_.data = false;
    EXPECT_TRUE(verify::renderReference(packed_, camera_, settings_).data.empty());
    settings_.cost = true;
    EXPECT_FALSE(verify::renderReference(packed_, camera_, settings_).data.empty());
}

}  // namespace
}  // namespace glint::app::test
