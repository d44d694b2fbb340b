// `glint bench`: what is made of the times.
#include <nlohmann/json.hpp>

#include "bench/write.h"
#include "support/support.h"

namespace glint::bench::test::bench_test {
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
    EXPECT_STARTS(table,
                  "a.json\n  40 x 30, 1 sample, maxDepth 0, 0 lights, 0 primitives\n"
                  "  thing, its driver, packets, texel buffers, commit abc\n");
    EXPECT_HAS(table,
               "\n  rays                      number  tests/ray    Mrays/s  quartiles                    ms\n"
               "  primary                     1200       25.0      0.600     0.300 .. 1.200          2.00\n"
               "  shadow                       600        0.0      0.600     0.600 .. 0.600          1.00\n");
    EXPECT_HAS(table, "2.00 million triangles/s");
}

TEST(Bench, WalksHaveALineEach) {
    bench::Result r = someResult(), walk = someResult();
    walk.traversal = "lane";
    walk.picture = "0123";
    walk.upload = 0.5;
    walk.deviceBytes = 3 << 20;
    r.walks = {walk, walk};
    const std::string table = bench::table(r, kProgram);
    const std::string line =
        "  lane          0.600     0.600     0.100         -     0.300      7.00    500.00       3.0  0123\n";
    EXPECT_ENDS(table, "MiB  image\n" + line + line);
    const nlohmann::json json = nlohmann::json::parse(bench::json({r}, kProgram))["scenes"][0]["walks"];
    ASSERT_EQ(json.size(), 2u);
    EXPECT_EQ(json[1]["traversal"], "lane");
    EXPECT_DOUBLE_EQ(json[1]["perSecond"]["mirrored"]["median"].get<double>(), 100'000);
    EXPECT_FALSE(json[1]["perSecond"].contains("refracted"));
}

}  // namespace glint::bench::test::bench_test
