// `glint render --error` on the host.
#include <ImfDoubleAttribute.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>

#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::error_target_test {
class ErrorTarget : public SmallSceneTest {
  protected:
    static Ran render(const Words& options) { return runGlint(kRender, options); }

    inline static const Words kRender = "render a.json --backend cpu --size 32x24";
};

TEST_F(ErrorTarget, IsReachedAndTold) {
    const nlohmann::json stats = jsonOf(kRender + "--error 0.02 --within-depth --stats json -q");
    const nlohmann::json& error = stats.at("error");
    EXPECT_EQ(error.at("stopped"), "reached");
    EXPECT_LE(error.at("bound").get<double>(), 0.02);
    EXPECT_GT(error.at("sampling").get<double>(), 0);
    EXPECT_GT(error.at("rounding").get<double>(), 0);
    EXPECT_EQ(stats.at("samplesTaken").at("min"), error.at("samplesPerPixel"));
    const Ran again = render("--error 0.02 --within-depth -q -o again.png");
    EXPECT_EQ(readBytes("a.png"), readBytes("again.png"));
}

// As attributes that --stats has too. An EXR without --error has none: its bytes are those of any other way
// to draw it.
TEST_F(ErrorTarget, IsInTheHeaderOfAnExr) {
    const nlohmann::json stats = jsonOf(kRender + "--error 0.02 --within-depth --stats json -q -o a.exr");
    const auto header = [](const std::string& file) {
        Imf::InputFile exr(file.c_str());
        return exr.header();
    };
    const Imf::Header told = header("a.exr");
    for (const char* key : {"asked", "bound", "sampling", "rounding", "confidence", "samplesPerPixel"})
        EXPECT_EQ(
            told.typedAttribute<Imf::DoubleAttribute>((std::string("glint.error.") + key).c_str()).value(),
            stats.at("error").at(key).get<double>())
            << key;
    EXPECT_EQ(told.typedAttribute<Imf::DoubleAttribute>("glint.error.reached").value(), 1);
    EXPECT_EQ(told.typedAttribute<Imf::StringAttribute>("glint.error.stopped").value(), "reached");
    ASSERT_EQ(render("-q -o b.exr").code, 0);
    EXPECT_EQ(header("b.exr").findTypedAttribute<Imf::DoubleAttribute>("glint.error.asked"), nullptr);
}

TEST_F(ErrorTarget, SummaryNamesTheParts) {
    const Ran ran = render("--error 0.02 --within-depth");
    EXPECT_HAS(ran.out, "error (rmse): at most 0.0");
    EXPECT_HAS(ran.out, "(not counted)");
}

// Rounded to 1 it would be a certainty, which no sample gives.
TEST_F(ErrorTarget, SummaryDoesNotRoundTheConfidence) {
    for (const std::string confidence : {"0.95", "0.999999999"}) {
        const Ran ran = render({"--error", "0.5", "--within-depth", "--confidence", confidence});
        EXPECT_HAS(ran.out, " with confidence " + confidence + "; ");
    }
}

// The scene has a sample for each pixel, which is too few for the filter, and --spp is not for --error.
TEST_F(ErrorTarget, FiltersTakeTheSamplesThatTheyNeed) {
    const nlohmann::json stats =
        jsonOf(kRender + "--error 0.1 --within-depth --filter mitchell --stats json");
    EXPECT_GE(stats["error"]["samplesPerPixel"], 8) << "two replicates of 4";
}

// Two replicates of one pixel with an error have no quantile.
TEST_F(ErrorTarget, TooFewPixelsHaveNoBound) {
    expectError(kRender + "--error 0.01 --crop 16,12,17,13", 2,
                "--error cannot bound the error of a single pixel: use a larger --crop");
    writeText("a.json", sceneText(2, 1, R"("background": 0.5, "ambient": 1,
        "objects": [{"type": "sphere", "center": [3, 0, 0], "radius": 2}])"));
    const Ran two = runGlint("render a.json --backend cpu --error 0.0001 --max-spp 64");
    EXPECT_EQ(two.code, 0);
    EXPECT_HAS(two.err,
               "target 0.0001 not reached: the error has no bound after 64 samples per pixel (--max-spp); "
               "too few pixels");
}

// A highlight that all samples may have missed counts up to full scale and is told beyond it.
TEST_F(ErrorTarget, UnseenHighlightsAreTold) {
    // Nothing but sky.
    const auto argsFor = [](const std::string& sky) {
        writeText("a.json", sceneText(32, 24, R"("background": )" + sky + R"(, "objects": [
                      {"type": "sphere", "center": [0, 1000, 0], "radius": 1}])"));
        return Words("render a.json --backend cpu --error 0.5");
    };
    const std::string note = "not counted: a highlight as bright as the scene allows";
    EXPECT_LACKS(runGlint(argsFor("0.5")).out, note);
    EXPECT_HAS(runGlint(argsFor("500")).out, note);
    const auto unseen = [&](const std::string& sky) {
        return jsonOf(argsFor(sky) + "--stats json -q")["error"]["unseen"].get<double>();
    };
    EXPECT_NEAR(unseen("500") / unseen("5"), 100, 0.01);
}

TEST_F(ErrorTarget, LayersHoldSamplesAndErrors) {
    const Ran ran = render("--error 0.05 --within-depth --aov color,error,samples -o a.pfm -q");
    ASSERT_EQ(ran.code, 0) << ran.err;
    const Image errors = readImage("a.error.pfm"), samples = readImage("a.samples.pfm");
    bool differs = false;
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 32; ++x) {
            EXPECT_GE(errors.at(x, y, 0), 0);
            EXPECT_EQ(samples.at(x, y, 0), samples.at(0, 0, 0));
            differs = differs || errors.at(x, y, 0) > 0;
        }
    }
    EXPECT_TRUE(differs);
}

TEST_F(ErrorTarget, AMissedTargetIsSaidAndStrictFails) {
    const Words few = "--error 0.0001 --max-spp 8 --within-depth";
    const Ran lenient = render(few);
    EXPECT_EQ(lenient.code, 0);
    EXPECT_HAS(lenient.err, "after 8 samples per pixel (--max-spp)");
    EXPECT_EQ(render(few + "--strict").code, 5);
    EXPECT_TRUE(std::filesystem::exists("a.png"));
}

TEST_F(ErrorTarget, OptionsThatContradictAreRefused) {
    for (const std::string options :
         {"--error 0.01 --confidence 1", "--error 0.01 --confidence 0.4", "--error 0.01 --sampler grid",
          "--error 0.01 --measure rmse", "--error 0.01 --max-seconds 0", "--confidence 0.9", "--max-spp 9",
          "--max-seconds 9", "--within-depth", "--strict", "--aov error"}) {
        const Ran ran = render(options.c_str());
        EXPECT_EQ(ran.code, 2) << options;
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        EXPECT_FALSE(std::filesystem::exists("a.png"));
    }
}

// Two mirrors that face each other.
TEST_F(ErrorTarget, ErrorsThatNoSampleMendsAreRefused) {
    writeText("a.json", sceneText(32, 24, R"(
        "maxDepth": 2,
        "materials": {"m": {"mirror": [0.5, 0.5, 0.5], "diffuse": [0.5, 0.5, 0.5]}},
        "lights": [{"type": "point", "position": [0, 0, 1]}],
        "objects": [{"type": "plane", "point": [0, 0, -3], "normal": [0, 0, 1], "material": "m"},
                    {"type": "plane", "point": [0, 0, 7], "normal": [0, 0, -1], "material": "m"}])"));
    const Ran ran = render("--error 0.001");
    EXPECT_EQ(ran.code, 2);
    EXPECT_HAS(ran.err, "beyond maxDepth may add");
    EXPECT_HAS(ran.err, "would do; --within-depth");
    expectError(kRender + "--error 0.001 --max-depth 0", 2,
                "--error cannot bound reflections at maxDepth 0: use --max-depth 1 or --within-depth");
    // Two images of 4 samples, the fewest of this filter.
    expectError(kRender + "--error 0.5 --max-spp 7 --filter mitchell", 2,
                "an error with this filter needs at least 8 samples per pixel, and at most 7 are allowed");
}

}  // namespace glint::app::test::error_target_test
