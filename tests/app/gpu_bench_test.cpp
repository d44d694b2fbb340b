// `glint bench` on a device: counts against the reference's, and what a pipeline with more code draws.
#include <set>

#include "support.h"
#include "support/environment.h"

namespace glint::app::test::gpu_bench_test {
nlohmann::json bench(const Words& more) {
    return jsonOf("bench a.json --repeat 2 --stats json" + more)["scenes"][0];
}

class GpuBench : public FolderTest {
    // What compiling takes cold is not the matter here.
    const glint::test::ScopedEnvironment cache_{"MESA_SHADER_CACHE_DISABLE", "false"};
};

// A glass sphere before a mirror, over a plane: every class of rays.
TEST_F(GpuBench, CountsTheReferencesRays) {
    writeText("a.json", sceneText(64, 48, R"("maxDepth": 4, "background": 0.5,
  "lights": [{"type": "point", "position": [1, 6, 4], "intensity": 0.8},
             {"type": "directional", "direction": [-1, -1, -1], "intensity": 0.3}],
  "materials": {"glass": {"transmission": 1, "ior": 1.5}, "chrome": {"diffuse": 0.1, "mirror": 0.9}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "glass"},
              {"type": "sphere", "center": [-2, 0, -1], "radius": 1, "material": "chrome"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "chrome"}])"));
    const nlohmann::json device = bench({}), host = bench("--backend cpu");
    EXPECT_EQ(device["rays"]["primary"]["number"], 64 * 48);
    double sum = 0;
    for (const char* key : {"primary", "shadow", "mirrored", "refracted"}) {
        const double n = device["rays"][key]["number"], expected = host["rays"][key]["number"];
        sum += n;
        EXPECT_GT(n, 500) << key;
        // Rounding may turn single paths at silhouettes and at the edge of total reflection.
        EXPECT_NEAR(n, expected, 0.005 * expected) << key;
    }
    EXPECT_EQ(device["rays"]["all"]["number"], sum);
    EXPECT_EQ(device["rays"]["mirroredAndRefracted"]["number"].get<double>(),
              device["rays"]["mirrored"]["number"].get<double>() +
                  device["rays"]["refracted"]["number"].get<double>());
    for (const char* key : {"primary", "shadow", "mirrored", "refracted", "mirroredAndRefracted", "all"})
        EXPECT_GT(device["rays"][key]["perSecond"]["median"].get<double>(), 0) << key;
    double parts = 0;
    for (const char* key : {"primary", "shadow", "mirroredAndRefracted"})
        parts += device["rays"][key]["seconds"]["median"].get<double>();
    for (const char* key : {"generate", "shade"}) parts += device["seconds"][key]["median"].get<double>();
    // Two pictures: the median of sums is the sum of medians; the rest is the submissions' own time.
    EXPECT_LE(parts, device["seconds"]["trace"]["median"].get<double>() * (1 + 1e-9));
    EXPECT_GT(device["seconds"]["compile"].get<double>(), 0);
    EXPECT_GT(device["bytes"]["device"].get<double>(), 64 * 48 * 16);
}

// A mirror ball in the middle of 64 x 48 pixels of sky.
void writeMirrorBall() {
    writeText("a.json", sceneText(64, 48, R"("maxDepth": 3,
  "lights": [{"type": "point", "position": [1, 6, 4], "intensity": 0.8}],
  "materials": {"chrome": {"diffuse": 0.1, "mirror": 0.9}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 0.3, "material": "chrome"}])"));
}

// Later bounces need fewer invocations than pixels. Steps have no times of their own in one kernel.
TEST_F(GpuBench, WholePathsDrawTheSameBitsInOneKernel) {
    writeMirrorBall();
    const nlohmann::json steps = bench("--traversal lane"), whole = bench("--traversal lane --whole-paths");
    EXPECT_EQ(whole["picture"], steps["picture"]);
    EXPECT_EQ(whole["rays"]["all"]["number"], steps["rays"]["all"]["number"]);
    EXPECT_GT(whole["seconds"]["trace"]["median"].get<double>(), 0);
    EXPECT_GT(steps["seconds"]["generate"]["median"].get<double>(), 0);
    EXPECT_EQ(whole["seconds"]["generate"]["median"].get<double>(), 0);
    EXPECT_FALSE(whole["rays"]["primary"].contains("seconds"));
    const auto live = steps["paths"]["live"].get<uint64_t>(),
               invocations = steps["paths"]["invocations"].get<uint64_t>();
    EXPECT_GT(live, 64 * 48u);
    EXPECT_LT(invocations, 2 * 64 * 48u);
    EXPECT_GE(invocations, live);
    EXPECT_GT(steps["seconds"]["processors"]["median"].get<double>(), 0);
}

TEST_F(GpuBench, MoreCodeDrawsTheSameBits) {
    writeText("a.json", sceneText(32, 24, R"("maxDepth": 0,
  "lights": [{"type": "point", "position": [1, 6, 4], "intensity": 0.8}],
  "materials": {"red": {"diffuse": [0.8, 0.1, 0.1]}},
  "objects": [{"type": "triangle", "vertices": [[-1, -1, 0], [1, -1, 0], [0, 1, -1]], "material": "red"}])"));
    const nlohmann::json pruned = bench({});
    EXPECT_EQ(pruned["features"], (std::vector<std::string>{"triangles", "pointLights"}));
    EXPECT_TRUE(pruned["also"].empty());
    const nlohmann::json with = bench("--with discs,mirrors");
    EXPECT_EQ(with["also"], (std::vector<std::string>{"discs", "mirrors"})) << "in the order of `features`";
    EXPECT_EQ(with["picture"], pruned["picture"]);
    EXPECT_EQ(with["rays"]["all"]["number"], pruned["rays"]["all"]["number"]);
}

// Everything that this device and the scene have: what is not lavapipe with 8 lanes has no packets.
TEST_F(GpuBench, EveryWalkDrawsTheSameBits) {
    std::string triangles;
    for (int i = 0; i < 40; ++i) {
        const std::string x = std::to_string(0.1 * i - 2);
        triangles += R"({"type": "triangle", "vertices": [[)" + x + ", -1, 0], [" + x + ", 1, 0], [" + x +
                     R"(, 0, 1]], "material": "m"},)";
    }
    writeText("a.json",
              sceneText(32, 24,
                        R"("maxDepth": 2,
  "lights": [{"type": "point", "position": [1, 6, 4], "intensity": 0.8}],
  "materials": {"m": {"diffuse": 0.5, "mirror": 0.5}},
  "objects": [)" + triangles +
                            R"({"type": "sphere", "center": [0, 0, -1], "radius": 0.9, "material": "m"}])"));
    const nlohmann::json all = bench("--traversal all");
    std::set<std::string> ways;
    for (const nlohmann::json& walk : all["walks"]) {
        ways.insert(walk["traversal"].get<std::string>());
        EXPECT_EQ(walk["picture"], all["picture"]) << walk;
        for (const char* key : {"primary", "shadow", "mirrored", "all"})
            EXPECT_GT(walk["perSecond"][key]["median"].get<double>(), 0) << key;
    }
    EXPECT_EQ(ways.size(), all["walks"].size());
    ways.erase("packet");
    EXPECT_EQ(ways, (std::set<std::string>{"lane"}));
    EXPECT_FALSE(bench({}).contains("walks"));
}

}  // namespace glint::app::test::gpu_bench_test
