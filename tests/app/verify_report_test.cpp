// The words of `glint verify`, from reports made by hand.
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/verify_command.h"
#include "support.h"

namespace glint::app::test::verify_report_test {

std::string reportText(const verify::Report& report, bool manySamples = false) {
    std::ostringstream out;
    printReport("a.json", report, manySamples, out);
    return out.str();
}

verify::Report cleanReport() {
    verify::Report report;
    report.pixels = 1000;
    report.rmse = 1e-7;
    report.rmseSamePath = 1e-7;
    report.maxSamePath = 2.5e-6;
    report.p99 = 3e-6;
    report.sensitivity.kappa = 32;
    report.sensitivity.tried = 1000;
    report.sensitivity.changedWidely = 16;
    return report;
}

// 16 pixels of 1000 at 32 units: no more than 31.4 on average, one unit 32 times fewer, the device twice as
// many: a mean of 1.96, which 8 exceed with a chance of 3e-4.
const char* const kCleanLines =
    "    sensitivity: 0 of 1000 pixels change when rays move by 2^-24, 16 by 32 times that, 0 by the order "
    "of "
    "surfaces in one place\n"
    "    RMSE 1e-07; where the paths agree: RMSE 1e-07, max 2.5e-06\n"
    "    kappa 32 (non-stiff): expected fp32 error 1.9e-06, measured 3e-06 (99th percentile)\n";

TEST(VerifyReport, Ok) {
    EXPECT_EQ(reportText(cleanReport()),
              std::string("a.json: ok\n    1000 pixels; beyond their predicted error: 0 edge, 0 rounding, 0 "
                          "undecided (at most 8), 0 unexplained\n") +
                  kCleanLines);
}

// A change of the clean report, the verdict's start, and a line that explains it.
struct Verdict {
    void (*change)(verify::Report&);
    const char *verdict, *line;
};

TEST(VerifyReport, VerdictsNameTheirReason) {
    const Verdict cases[] = {
        {[](verify::Report& r) { r.edges = 5, r.roundings = 3; }, "ok\n",
         "beyond their predicted error: 5 edge, 3 rounding, 0 undecided (at most 8)"},
        {[](verify::Report& r) { r.edges = 5, r.roundings = 4; },
         "FAILED: too many pixels differ, though rounding explains each: the method loses digits", ""},
        // The limit rises with the scene's sensitivity.
        {[](verify::Report& r) { r.edges = 9, r.sensitivity.open = 50; }, "ok\n", ""},
        {[](verify::Report& r) { r.filmDiffers = 7; }, "FAILED: the image is not the mean of its samples\n",
         "\n    7 pixels are not the mean of the samples that they need\n"},
        {[](verify::Report& r) { r.lossesDiffer = true; },
         "FAILED: device and reference leave out different branches\n", "\n    other branches are left out"},
        {[](verify::Report& r) { r.unexplained = r.allowedUnexplained = 2; },
         "ok: 2 unexplained, 2 allowed\n", ""},
        {[](verify::Report& r) { r.unexplained = 3, r.allowedUnexplained = 2; },
         "FAILED: unexplained pixels\n", ""}};
    for (const Verdict& c : cases) {
        verify::Report report = cleanReport();
        c.change(report);
        EXPECT_STARTS(reportText(report), std::string("a.json: ") + c.verdict) << c.verdict;
        EXPECT_HAS(reportText(report), c.line);
        EXPECT_EQ(reportJson(report)["differing"], report.explained() + report.unexplained);
    }
}

TEST(VerifyReport, UnexplainedPixelShowsBothSides) {
    verify::Report report = cleanReport();
    report.unexplained = 1;
    verify::DifferingPixel pixel;
    pixel.x = 12;
    pixel.y = 34;
    pixel.difference = 0.5;
    pixel.quantities = {"alpha", "path"};
    pixel.deviceColor = {0.25f, 0.5f, 0.75f};
    pixel.device.object = 3;
    pixel.device.primitive = 7;
    pixel.device.depth = 2.5;
    pixel.device.bounces = 2;
    pixel.device.pathHash = 0xabc;
    pixel.reference.color = {0.25, 0, 0.75};
    pixel.reference.pathHash = 0xdef;
    report.worst.push_back(pixel);
    EXPECT_EQ(reportText(report),
              "a.json: FAILED: unexplained pixels\n"
              "    1000 pixels; beyond their predicted error: 0 edge, 0 rounding, 0 undecided (at most 8), 1 "
              "unexplained\n" +
                  std::string(kCleanLines) +
                  "    pixel 12,34: difference 0.5, unexplained (alpha, path)\n"
                  "      device     color (0.25 0.5 0.75)  object 3 primitive 7 t 2.5  bounces "
                  "2 path 00000abc\n"
                  "      reference  color (0.25 0 0.75)  miss  bounces 0 path 00000def\n");
    EXPECT_EQ(reportJson(report)["differingPixels"][0]["quantities"], nlohmann::json({"alpha", "path"}));
}

TEST(VerifyReport, ExplainedPixelNamesJitterAndSample) {
    verify::Report report = cleanReport();
    report.edges = 1;
    verify::DifferingPixel pixel;
    pixel.reason = verify::Reason::Edge;
    pixel.ulps = 2;
    pixel.openDecisions = 3;
    pixel.sample = 3;
    pixel.difference = 1;
    pixel.reference.hit = reference::Hit{};
    pixel.reference.hit->t = 4;
    pixel.reference.surface = reference::Surface{};
    report.worst.push_back(pixel);
    const std::string text = reportText(report, true);
    EXPECT_HAS(
        text,
        "    pixel 0,0 sample 3: difference 1, edge (3 open decisions, rays moved by at most 2 x 2^-24)\n");
    EXPECT_HAS(text, "reference  color (0 0 0)  object 0 primitive 0 t 4  bounces");
}

TEST(VerifyReport, RoundingOfTheSceneHasFiguresOfItsOwn) {
    verify::Report report = cleanReport();
    report.representation = verify::Representation{250, 3, 0, 1e-8, 2e-8, 3e-8, {}};
    const char* const kLine =
        "    rounding the scene: 250 pixels of the reference, RMSE 1e-08, 99th percentile 2e-08, max "
        "3e-08; beyond what moved numbers predict: 3 explained, 0 unexplained\n";
    EXPECT_STARTS(reportText(report), "a.json: ok\n");
    EXPECT_ENDS(reportText(report), kLine);
    const nlohmann::json json = reportJson(report);
    EXPECT_EQ(json["representation"]["rmse"], 1e-8);
    EXPECT_EQ(json["arithmetic"]["rmse"], 1e-7);
    EXPECT_EQ(json["passed"], true);
    report.representation->unexplained = 1;
    verify::RepresentedPixel pixel;
    pixel.x = 4;
    pixel.truth.color = {0.5, 0, 0};
    report.representation->worst.push_back(pixel);
    EXPECT_STARTS(reportText(report), "a.json: FAILED: the packed scene differs from the scene");
    EXPECT_HAS(reportText(report), "pixel 4,0 sample 0: difference 0 by packing, unexplained");
    EXPECT_HAS(reportText(report), "read       color (0.5 0 0)  miss");
    EXPECT_EQ(reportJson(report)["passed"], false);
}

TEST(VerifyReport, WithoutPixels) {
    EXPECT_HAS(reportText({}), "0 pixels; beyond their predicted error");
}

// The files that `glint verify` writes for other programs, from results made by hand.

std::vector<SceneResult> someResults() {
    return {{.scene = "a.json", .message = "ok", .details = "a.json: ok\n", .seconds = 0.5},
            {.scene = "b<\x01>.json",
             .status = SceneStatus::Failed,
             .message = "FAILED: \"x\" & y",
             .details = "line\nline"},
            {.scene = "c.json", .status = SceneStatus::Error, .message = "c.json: no", .seconds = 1},
            {.scene = "d.schema.json", .status = SceneStatus::Skipped, .message = "a schema"}};
}

TEST(VerifyFiles, JUnitHasOneTestCaseAScene) {
    EXPECT_EQ(junitText(someResults()),
              "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<testsuite name=\"glint verify\" tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\" "
              "time=\"1.500\">\n"
              "  <testcase classname=\"glint.verify\" name=\"a.json\" time=\"0.500\"></testcase>\n"
              "  <testcase classname=\"glint.verify\" name=\"b&lt;?&gt;.json\" time=\"0.000\">\n"
              "    <failure message=\"FAILED: &quot;x&quot; &amp; y\">line\n"
              "line</failure>\n"
              "  </testcase>\n"
              "  <testcase classname=\"glint.verify\" name=\"c.json\" time=\"1.000\">\n"
              "    <error message=\"c.json: no\"></error>\n"
              "  </testcase>\n"
              "  <testcase classname=\"glint.verify\" name=\"d.schema.json\" time=\"0.000\">\n"
              "    <skipped message=\"a schema\"></skipped>\n"
              "  </testcase>\n"
              "</testsuite>\n");
}

TEST(VerifyFiles, JsonHasAVersionAndASummary) {
    const nlohmann::json json = nlohmann::json::parse(jsonText(someResults(), "Fake GPU", "1.2"));
    EXPECT_EQ(json["format"], "glint.verify");
    EXPECT_EQ(json["version"], kVerifyJsonVersion);
    EXPECT_EQ(json["device"], "Fake GPU");
    EXPECT_EQ(json["summary"], (nlohmann::json{{"passed", 1}, {"failed", 1}, {"error", 1}, {"skipped", 1}}));
    EXPECT_EQ(json["scenes"][2]["status"], "error");
    EXPECT_EQ(json["scenes"][2]["verdict"], "c.json: no");
    EXPECT_EQ(json["scenes"][2]["seconds"], 1);
}

TEST(VerifyFiles, BytesThatAreNotUtf8AreReplaced) {
    std::vector<SceneResult> results = someResults();
    results[0].scene = "\xff.json";
    EXPECT_TRUE(nlohmann::json::accept(jsonText(results, "", "")));
    EXPECT_HAS(junitText(results), "name=\"?.json\"");
}

}  // namespace glint::app::test::verify_report_test
