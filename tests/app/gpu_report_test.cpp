// `glint report` from end to end, on a scene of few pixels.
#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "app/rendering.h"
#include "core/error.h"
#include "report/run.h"
#include "support.h"

namespace glint::app::test::gpu_report_test {
class GpuReport : public FolderTest {
  protected:
    void SetUp() override {
        // No mirrors and no triangles: few configurations.
        writeText("a.json", sceneText(16, 12, R"("background": 0.5, "ambient": 0.1,
  "lights": [{"type": "point", "position": [1, 6, 4], "intensity": 0.8}],
  "materials": {"red": {"diffuse": [0.8, 0.1, 0.1]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red"}])"));
    }
    // One kind of pipeline, as compiling takes most of the time; a budget that no machine exceeds.
    inline static const Words kReport = "report a.json -o out --only lowDiscrepancy";
    inline static const Words kSmall = kReport + "--size 16 --repeats 2 --truth-spp 64 --budget 600";

    static Ran report(const Words& more = {}) { return runGlint(kSmall, more); }
    static report::Report runReport(const gpu::Device& device, const report::Options& options) {
        SceneOptions scene;
        scene.scene = "a.json";
        std::ostringstream warnings;
        std::vector<report::Subject> subjects;
        subjects.push_back({"a.json", "", loadAndPack(scene, warnings)});
        return report::run(device, std::move(subjects), std::nullopt, options);
    }
    static nlohmann::json readJson() {
        const auto bytes = readBytes("out/report.json");
        return nlohmann::json::parse(bytes.begin(), bytes.end());
    }
};

TEST_F(GpuReport, MeasuresOnceAndNeverAgain) {
    const Ran ran = report();
    ASSERT_EQ(ran.code, 0) << ran.err;
    const nlohmann::json first = readJson();
    const nlohmann::json& scene = first["scenes"][0];
    EXPECT_EQ(scene["width"], 16);
    EXPECT_EQ(scene["height"], 12);
    EXPECT_EQ(scene["measured"].size(), 6u) << "1, 4, 16, 64, 256 and 1024 samples";
    for (const nlohmann::json& c : scene["measured"]) {
        EXPECT_GT(c["seconds"][0].get<double>(), 0) << c["key"];
        EXPECT_GE(c["rays"].get<uint64_t>(), 192u * c["spp"].get<uint64_t>()) << c["key"];
        EXPECT_EQ(c["total"]["pixels"], 192) << c["key"];
        EXPECT_EQ(c["arithmetic"].is_null(), c["spp"] > 4) << c["key"];
        EXPECT_EQ(c["seconds"].size(), 2u);
        EXPECT_EQ(c["samples"], c["spp"]);
        // A sphere and a light by the default methods: what is left against double is rounding, a few units
        // of 2^-24 in colours below 1.
        if (c["spp"] == 1 && c["family"] == "lowDiscrepancy") {
            EXPECT_LT(c["arithmetic"]["samePath"]["max"].get<double>(), 1e-5);
            EXPECT_GT(c["arithmetic"]["samePath"]["max"].get<double>(), 0);
        }
    }
    const Ran again = report();
    EXPECT_EQ(again.code, 0);
    EXPECT_EQ(again.out, ran.out) << "times to the last digit: nothing was run again";
    EXPECT_EQ(readJson(), first);
    EXPECT_TRUE(std::filesystem::exists("out/report.html"));
    EXPECT_TRUE(std::filesystem::exists("out/report.csv"));
    EXPECT_TRUE(std::filesystem::exists("out/a.precision.svg"));

    writeText("a.json", sceneText(16, 12, "\"background\": 0.25"));
    EXPECT_EQ(report().code, 0);
    EXPECT_NE(readJson()["scenes"][0], scene) << "another scene under the same name";
}

// More runs are added to those of an earlier report.
TEST_F(GpuReport, MoreRepeatsContinue) {
    ASSERT_EQ(report().code, 0);
    const nlohmann::json before = readJson();
    ASSERT_EQ(runGlint(kReport + "--size 16 --repeats 3 --truth-spp 64 --budget 600").code, 0);
    const nlohmann::json after = readJson();
    for (size_t i = 0; i < 6; ++i) {
        const nlohmann::json &a = before["scenes"][0]["measured"][i], &b = after["scenes"][0]["measured"][i];
        EXPECT_EQ(b["key"], a["key"]);
        ASSERT_EQ(b["seconds"].size(), 3u);
        EXPECT_EQ(b["seconds"][1], a["seconds"][1]);
    }
}

// The converged picture is no better than the pictures judged by it, whose errors are right all the same: its
// own, estimated from its two halves of a sample each, is independent of theirs and taken out. A picture of
// one sample then has sqrt(2) times the error of the mean of two: of 8 runs and the edges of a hundred
// spheres within a tenth. Noise that pictures shared with the converged one gave 0.85.
TEST_F(GpuReport, TheConvergedPicturesErrorIsTakenOut) {
    std::string spheres;
    for (int i = 0; i < 100; ++i)
        spheres += (i ? ",\n" : "") +
                   std::string(R"({"type": "sphere", "radius": 0.2, "material": "red", )") +
                   R"("center": [)" + std::to_string(i % 10 * 0.45 - 2) + ", " +
                   std::to_string(i / 10 * 0.43 - 2) + ", 0]}";
    writeText("a.json", sceneText(96, 96,
                                  R"("background": 0.5, "ambient": 0.1,
  "materials": {"red": {"diffuse": [0.8, 0.1, 0.1]}}, "objects": [)" +
                                      spheres + "]"));
    const Ran ran = runGlint(kReport + "--size 96 --repeats 8 --truth-spp 2 --budget 600");
    ASSERT_EQ(ran.code, 0) << ran.err;
    const nlohmann::json scene = readJson()["scenes"][0];
    const double own = scene["truthError"];
    EXPECT_GT(own, 0);
    EXPECT_EQ(scene["truthSamples"], 2);
    bool found = false;
    for (const nlohmann::json& c : scene["measured"]) {
        double squares = 0;
        for (const double rmse : c["rmse"]) squares += rmse * rmse / 8;
        const double error = c["error"];
        EXPECT_NEAR(error * error, std::max(squares - own * own, 0.0), 1e-9) << c["key"];
        EXPECT_EQ(c["hidden"], squares < 2 * own * own) << c["key"];
        if (c["spp"] != 1 || c["family"] != "lowDiscrepancy") continue;
        found = true;
        EXPECT_NEAR(error / own, std::numbers::sqrt2, 0.1 * std::numbers::sqrt2);
    }
    EXPECT_TRUE(found);
}

// The scene's own file is the same: it is the mesh that is another one.
TEST_F(GpuReport, AnotherMeshStartsOver) {
    writeText("a.json", sceneText(16, 12, R"("background": 0.5, "meshes": {"m": {"file": "m.obj"}},
  "materials": {"red": {"diffuse": [0.8, 0.1, 0.1]}},
  "objects": [{"type": "mesh", "mesh": "m", "material": "red"}])"));
    writeText("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    ASSERT_EQ(report().code, 0);
    EXPECT_EQ(readJson()["scenes"][0]["measured"].size(), 6u);
    writeText("m.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    const nlohmann::json before = readJson();
    ASSERT_EQ(report().code, 0);
    EXPECT_NE(readJson()["scenes"][0]["hash"], before["scenes"][0]["hash"]);
    EXPECT_NE(readJson()["scenes"][0]["measured"][0]["rmse"], before["scenes"][0]["measured"][0]["rmse"]);
}

TEST_F(GpuReport, KeepsScenesThatAreNotNamed) {
    ASSERT_EQ(report().code, 0);
    writeText("b.json", sceneText(16, 12, "\"background\": 0.25"));
    const Words args = "report b.json -o out --size 16 --repeats 2 --truth-spp";
    expectError(args + "64 --only depth", 1,
                "b.json: nothing was measured: no setting of --only applies to this scene");
    ASSERT_EQ(runGlint(args + "64 --only grid").code, 0);
    const nlohmann::json both = readJson();
    ASSERT_EQ(both["scenes"].size(), 2u);
    EXPECT_EQ(both["scenes"][0]["name"], "b");
    EXPECT_EQ(both["scenes"][1]["name"], "a");
    EXPECT_EQ(both["scenes"][1]["measured"].size(), 6u);
    const Ran another = runGlint(args + "32 --only grid");
    ASSERT_EQ(another.code, 0);
    EXPECT_HAS(another.err, "scenes that are not named are dropped");
    EXPECT_EQ(readJson()["scenes"].size(), 1u);
}

// Measured as a file would be whose own camera that is, and kept beside the report of the scene's own.
TEST_F(GpuReport, AnotherCameraIsAnotherReport) {
    const std::string rest =
        R"("background": 0.5, "ambient": 0.1, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}])";
    const std::string near = R"({"eye": [0, 0, 3]})";
    const std::string image = R"({"image": {"width": 16, "height": 12}, )";
    writeText("a.json",
              image + R"("camera": {"eye": [0, 0, 5]}, "cameras": {"near": )" + near + "}, " + rest + "}");
    writeText("b.json", image + R"("camera": )" + near + ", " + rest + "}");
    ASSERT_EQ(report().code, 0);
    const Ran chosen = report({"b.json"});
    ASSERT_EQ(chosen.code, 0) << chosen.err;
    const Ran ran = report("--camera near");
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_HAS(ran.out, "\ncamera \"near\", 16 x 12 pixels");
    const nlohmann::json json = readJson();
    const auto errors = [&](size_t scene) {
        std::vector<double> list;
        for (const nlohmann::json& c : json["scenes"][scene]["measured"]) list.push_back(c["total"]["rmse"]);
        return list;
    };
    ASSERT_EQ(json["scenes"].size(), 3u);
    EXPECT_EQ(json["scenes"][0]["camera"], "near");
    size_t own = 1, other = 2;
    if (json["scenes"][own]["path"] != "a.json") std::swap(own, other);
    EXPECT_EQ(json["scenes"][own]["camera"], "");
    EXPECT_EQ(json["scenes"][other]["path"], "b.json");
    const std::vector<double> chosenErrors = errors(0), namedErrors = errors(other), ownErrors = errors(own);
    EXPECT_EQ(namedErrors.size(), 6u);
    EXPECT_EQ(chosenErrors, namedErrors);
    EXPECT_NE(chosenErrors, ownErrors);
    expectError(kSmall + "--camera far", 2, "a.json: no camera \"far\" (there are \"near\")");
}

// No machine renders 12 million pixels in double precision in time.
TEST_F(GpuReport, ThatNothingWasMeasuredIsAnError) {
    expectError(kReport + "--size 4096 --budget 1", 1,
                "a.json: nothing was measured: use a larger --budget or a smaller --size");
    EXPECT_FALSE(std::filesystem::exists("out/report.html"));
}

// With a clock that each step moves by 1000 seconds: settings are measured in order of importance, further
// runs follow when each setting has one, and all of the time is used.
TEST_F(GpuReport, ABudgetIsUsedInOrderOfImportance) {
    std::filesystem::create_directory("out");
    const gpu::Device device;
    const auto runsWithin = [&](double seconds) {
        report::Options options;
        options.folder = "out";
        options.width = 16;
        options.repeats = 3;
        options.truthSamples = 2;
        options.only = {"grid", "jittered"};
        std::atomic<int> steps{0};
        options.progress = [&](double) { ++steps; };
        options.secondsLeft = [&] { return seconds - 1000 * steps; };
        const report::Report report = runReport(device, options);
        std::vector<size_t> runs;
        for (const report::Measured& m : report.scenes[0].measured) runs.push_back(m.seconds.size());
        EXPECT_EQ(runs.size() + report.scenes[0].leftOut.size(), 12u);
        return runs;
    };
    EXPECT_EQ(runsWithin(6500), std::vector<size_t>(6, 1));
    EXPECT_EQ(runsWithin(18500), (std::vector<size_t>{2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1}));
    EXPECT_EQ(runsWithin(1e9), std::vector<size_t>(12, 3));
}

TEST_F(GpuReport, ImagesThatDoNotFitAreRefused) {
    std::filesystem::create_directory("out");
    report::Options options;
    options.folder = "out";
    options.memory = [] { return uint64_t{1}; };
    EXPECT_HAS(errorOf(ErrorKind::Failed, [&] { runReport(gpu::Device(), options); }), "the report takes ");
}

TEST_F(GpuReport, RefusesAFolderThatHoldsSomethingElse) {
    std::filesystem::create_directory("out");
    writeText("out/report.json", "[]");
    expectError(kSmall, 1,
                "out/report.json: not a report of this version; give another folder, or remove it");
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "out"}));
}

}  // namespace glint::app::test::gpu_report_test
