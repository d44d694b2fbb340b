// `glint bench`: what is made of the times, and the reference on the host, which needs no device.
#include <nlohmann/json.hpp>

#include "app/options.h"
#include "bench/write.h"
#include "core/error.h"
#include "support.h"

namespace glint::app::test::bench_test {
namespace {

const bench::Program kProgram = {"1.2", "abc"};

bench::Result someResult() {
    bench::Result r;
    r.scene = "a.json";
    r.device = "thing";
    r.driver = "its driver";
    r.traversal = "packet";
    r.access = "texel";
    r.width = 40;
    r.height = 30;
    r.triangles = 500'000;
    r.build = 0.25;
    r.rays = {1200, 600, 300, 0};
    r.primary = {0.001, 0.002, 0.004};
    r.shadow = {0.001, 0.001, 0.001};
    r.secondary = {0.003, 0.003, 0.003};
    r.trace = {0.007, 0.007, 0.007};
    r.counted[0] = {10, 250};
    r.counted[2] = {2, 30};
    return r;
}

const bench::Rate* find(const std::vector<bench::Rate>& rates, const std::string& key) {
    for (const bench::Rate& rate : rates)
        if (rate.key == key) return &rate;
    return nullptr;
}

TEST(Bench, OneKindOfBouncedRaysHasTheirDispatchesForItself) {
    const std::vector<bench::Rate> rates = ratesOf(someResult());
    EXPECT_EQ(find(rates, "mirrored")->seconds.median, 0.003);
    EXPECT_EQ(find(rates, "refracted")->seconds.median, 0);
    EXPECT_EQ(find(rates, "mirroredAndRefracted"), nullptr);
    EXPECT_EQ(find(rates, "all")->rays, 2100u);
    EXPECT_EQ(find(rates, "primary")->testsPerRay, 25);
    EXPECT_EQ(find(rates, "all")->testsPerRay, 280.0 / 12);
}

TEST(Bench, TwoKindsHaveARateTogetherAndOneEach) {
    bench::Result r = someResult();
    r.rays.refracted = 100;
    r.mirrored = {0.002, 0.002, 0.002};
    r.refracted = {0.001, 0.001, 0.001};
    const std::vector<bench::Rate> rates = ratesOf(r);
    EXPECT_EQ(find(rates, "mirrored")->seconds.median, 0.002);
    EXPECT_EQ(find(rates, "refracted")->seconds.median, 0.001);
    EXPECT_EQ(find(rates, "mirroredAndRefracted")->rays, 400u);
    EXPECT_EQ(find(rates, "mirroredAndRefracted")->seconds.median, 0.003);
}

TEST(Bench, JsonHoldsRatesWhoseQuartilesAreTheOtherWayRound) {
    const nlohmann::json json = nlohmann::json::parse(bench::json({someResult(), someResult()}, kProgram));
    EXPECT_EQ(json["version"], "1.2");
    EXPECT_EQ(json["commit"], "abc");
    ASSERT_EQ(json["scenes"].size(), 2u);
    const nlohmann::json& scene = json["scenes"][1];
    const nlohmann::json& primary = scene["rays"]["primary"];
    EXPECT_EQ(primary["number"], 1200);
    EXPECT_DOUBLE_EQ(primary["perSecond"]["median"].get<double>(), 600'000);
    EXPECT_DOUBLE_EQ(primary["perSecond"]["q1"].get<double>(), 300'000) << "from the third quartile of time";
    EXPECT_DOUBLE_EQ(primary["perSecond"]["q3"].get<double>(), 1'200'000);
    EXPECT_FALSE(scene["rays"]["refracted"].contains("perSecond")) << "none was cast";
    EXPECT_DOUBLE_EQ(scene["build"]["trianglesPerSecond"].get<double>(), 2e6);
}

TEST(Bench, TableAlignsItsColumns) {
    const std::string table = bench::table(someResult(), kProgram);
    EXPECT_TRUE(
        table.starts_with("a.json\n  40 x 30, 1 sample, maxDepth 0, 0 lights, 0 primitives\n"
                          "  thing, its driver, packets, texel buffers, commit abc\n"))
        << table;
    EXPECT_NE(table.find("\n  rays                      number  tests/ray    Mrays/s  quartiles"
                         "                    ms\n"
                         "  primary                     1200       25.0      0.600     0.300 .. 1.200"
                         "          2.00\n"
                         "  shadow                       600        0.0      0.600     0.600 .. 0.600"
                         "          1.00\n"),
              std::string::npos)
        << table;
    EXPECT_NE(table.find("2.00 million triangles/s"), std::string::npos) << table;
}

TEST(Bench, WalksHaveALineEach) {
    bench::Result r = someResult(), walk = someResult();
    walk.traversal = "cwbvh";
    walk.stack = "shared";
    walk.picture = "0123";
    walk.upload = 0.5;
    walk.deviceBytes = 3 << 20;
    r.walks = {walk, walk};
    const std::string table = bench::table(r, kProgram);
    const std::string line =
        "  cwbvh     shared       0.600     0.600     0.100         -     0.300      7.00    500.00       "
        "3.0  0123\n";
    EXPECT_TRUE(table.ends_with("MiB  picture\n" + line + line)) << table;
    const nlohmann::json json = nlohmann::json::parse(bench::json({r}, kProgram))["scenes"][0]["walks"];
    ASSERT_EQ(json.size(), 2u);
    EXPECT_EQ(json[1]["traversal"], "cwbvh");
    EXPECT_DOUBLE_EQ(json[1]["perSecond"]["mirrored"]["median"].get<double>(), 100'000);
    EXPECT_FALSE(json[1]["perSecond"].contains("refracted"));
}

TEST(Bench, NamesOfFeaturesAreThoseOfInfo) {
    SceneFeatures features;
    features.quadrics = features.alphaMask = true;
    EXPECT_EQ(parseFeatures("quadrics, alphaMask"), features);
    EXPECT_THROW(parseFeatures("triangels"), Error);
}

class BenchOnHost : public FolderTest {};

TEST_F(BenchOnHost, CountsEveryRayOfThePicture) {
    // The eye looks at a disc that fills the picture; the light is on the eye's side and nothing in between.
    writeText("a.json", sceneText(16, 12, R"("maxDepth": 0,
  "lights": [{"type": "point", "position": [0, 0, 4], "intensity": 1},
             {"type": "point", "position": [0, 0, -4], "intensity": 1}],
  "materials": {"m": {"diffuse": 0.5}},
  "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"}])"));
    const Ran ran = runGlint(
        {"bench", "a.json", "a.json", "--backend", "cpu", "--repeat", "2", "--spp", "4", "--stats", "json"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const nlohmann::json json = nlohmann::json::parse(ran.out);
    EXPECT_EQ(json["version"], GLINT_VERSION);
    EXPECT_FALSE(json["commit"].get<std::string>().empty());
    ASSERT_EQ(json["scenes"].size(), 2u);
    for (const nlohmann::json& scene : json["scenes"]) {
        EXPECT_EQ(scene["backend"], "cpu");
        EXPECT_EQ(scene["rays"]["primary"]["number"], 16 * 12 * 4);
        EXPECT_EQ(scene["rays"]["shadow"]["number"], 16 * 12 * 4) << "the light behind the plane casts none";
        EXPECT_EQ(scene["rays"]["all"]["number"], 2 * 16 * 12 * 4);
        EXPECT_EQ(scene["rays"]["all"]["testsPerRay"], 1) << "the plane; whose own rays test it too";
        EXPECT_GT(scene["rays"]["all"]["perSecond"]["median"].get<double>(), 0);
        EXPECT_GE(scene["seconds"]["trace"]["q3"], scene["seconds"]["trace"]["q1"]);
        EXPECT_GT(scene["bytes"]["hostPeak"].get<double>(), 1e6);
    }
    EXPECT_EQ(json["scenes"][0]["picture"], json["scenes"][1]["picture"]);
    EXPECT_EQ(names(), std::set<std::string>{"a.json"}) << "nothing is written";
}

TEST_F(BenchOnHost, SceneAtFault) {
    const Ran ran = runGlint({"bench", "no.json", "--backend", "cpu"});
    EXPECT_EQ(ran.code, 3);
    EXPECT_EQ(ran.err, "glint: no.json: no such file\n");
    EXPECT_EQ(ran.out, "");
}

}  // namespace
}  // namespace glint::app::test::bench_test
