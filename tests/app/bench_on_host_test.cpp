// `glint bench` by the reference on the host, which needs no device.
#include "app/options.h"
#include "core/error.h"
#include "support.h"

namespace glint::app::test::bench_on_host_test {
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
    const nlohmann::json json = jsonOf("bench a.json a.json --backend cpu --repeat 2 --spp 4 --stats json");
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
    expectError("bench no.json --backend cpu", 3, "no.json: no such file");
}

}  // namespace glint::app::test::bench_on_host_test
