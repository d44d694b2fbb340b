// Animations of glTF files: nodes that move, and what hangs on them.
#include <cmath>

#include "gltf_maker.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::gltf_animation_test {
using glm::dvec3;
using Change = SceneReader::Change;

// A triangle at node 0, a camera at node 1 below node 2, a light at node 3. The channels' accessors begin at
// number 1; `channels` and `samplers` are JSON.
struct Maker : GltfMaker {
    Maker() { floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"); }
    std::string file(const std::string& samplers, const std::string& channels, const std::string& node0 = "",
                     const std::string& more = "") const {
        return text(R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "cameras": [{"type": "perspective", "name": "eye", "perspective": {"yfov": 0.5, "znear": 0.1}}],
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
            "scenes": [{"nodes": [0, 2, 3]}],
            "nodes": [{"mesh": 0)" +
                    node0 + R"(}, {"camera": 0, "translation": [0, 0, 5]}, {"children": [1]},
                      {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
            "animations": [{"samplers": [)" +
                    samplers + R"(], "channels": [)" + channels + "]}" + more + "]");
    }
};

std::string sampler(size_t input, size_t output, const std::string& how = "LINEAR") {
    return "{\"input\": " + std::to_string(input) + ", \"output\": " + std::to_string(output) +
           ", \"interpolation\": \"" + how + "\"}";
}

std::string channel(int sampler, int node, const std::string& path) {
    return "{\"sampler\": " + std::to_string(sampler) + ", \"target\": {\"node\": " + std::to_string(node) +
           ", \"path\": \"" + path + "\"}}";
}

class GltfAnimation : public FolderTest {
  protected:
    SceneReader reader(const std::string& text, std::optional<double> time = {},
                       const std::string& camera = "") {
        writeText(file("a.gltf"), text);
        return {file("a.gltf"), {.camera = camera}, time};
    }
    // The only warning of the file, without its name.
    std::string warningOf(const std::string& text) {
        const SceneReader r = reader(text);
        EXPECT_FALSE(r.scene().animation);
        EXPECT_EQ(r.scene().warnings.size(), 1u);
        const std::string warning = r.scene().warnings.empty() ? "" : r.scene().warnings[0];
        const size_t at = warning.find("a.gltf: ");
        return at == std::string::npos ? warning : warning.substr(at + 8);
    }
};

dvec3 offsetOf(const Scene& scene) {
    return scene.objects.at(0).transform.value_or(Affine{}).offset;
}

TEST_F(GltfAnimation, NodesMoveAndMeshesAreReadOnce) {
    Maker maker;
    const size_t times = maker.floats({0, 2}, "SCALAR"), places = maker.floats({0, 0, 0, 4, 0, 2}, "VEC3");
    const std::string text = maker.file(sampler(times, places), channel(0, 0, "translation"));
    SceneReader r = reader(text);
    ASSERT_TRUE(r.scene().animation);
    EXPECT_EQ(r.scene().animation->end, 2);
    EXPECT_EQ(r.scene().animation->framesPerSecond, 24);
    EXPECT_TRUE(r.scene().warnings.empty()) << r.scene().warnings[0];
    EXPECT_FALSE(r.scene().objects[0].transform);
    const Mesh* const mesh = &meshOf(r.scene());
    EXPECT_EQ(r.moveTo(1), Change::Scene);
    EXPECT_EQ(offsetOf(r.scene()), dvec3(2, 0, 1));
    EXPECT_EQ(&meshOf(r.scene()), mesh);
    EXPECT_EQ(r.moveTo(1), Change::Nothing);
    EXPECT_EQ(r.moveTo(9), Change::Scene);
    EXPECT_EQ(offsetOf(r.scene()), dvec3(4, 0, 2));
    EXPECT_EQ(offsetOf(reader(text, 1.0).scene()), dvec3(2, 0, 1));
}

// A camera that hangs on a turning node goes about it; nothing else changes.
TEST_F(GltfAnimation, CamerasHangOnTheirNodes) {
    Maker maker;
    const float h = std::sqrt(0.5f);
    const size_t times = maker.floats({0, 1}, "SCALAR"),
                 turns = maker.floats({0, 0, 0, 1, 0, h, 0, h}, "VEC4");
    const std::string text = maker.file(sampler(times, turns), channel(0, 2, "rotation"));
    for (const std::string camera : {"", "eye"}) {
        SceneReader r = reader(text, {}, camera);
        EXPECT_EQ(r.moveTo(1), Change::Camera);
        EXPECT_LT(glm::length(r.scene().camera.eye - dvec3(5, 0, 0)), 1e-6);
        EXPECT_EQ(r.moveTo(0.5), Change::Camera);
        EXPECT_NEAR(r.scene().camera.eye.x, 5 * std::sqrt(0.5), 1e-6);  // slerp keeps the distance
        EXPECT_NEAR(r.scene().camera.eye.z, 5 * std::sqrt(0.5), 1e-6);
        EXPECT_EQ(r.scene().cameras[0].camera.eye, r.scene().camera.eye);
    }
}

TEST_F(GltfAnimation, LightsStepsAndSplines) {
    Maker maker;
    const size_t times = maker.floats({0, 1}, "SCALAR"), places = maker.floats({0, 1, 0, 0, 2, 0}, "VEC3");
    const size_t spline = maker.floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 4, 6, 0, 0, 0}, "VEC3");
    SceneReader r =
        reader(maker.file(sampler(times, places, "STEP") + "," + sampler(times, spline, "CUBICSPLINE"),
                          channel(0, 3, "translation") + "," + channel(1, 0, "translation")));
    r.moveTo(0.5);
    EXPECT_EQ(std::get<PointLight>(r.scene().lights[0]).position, dvec3(0, 1, 0));
    EXPECT_LT(glm::length(offsetOf(r.scene()) - dvec3(1, 2, 3)), 1e-6);  // half way: flat at both ends
    EXPECT_EQ(r.moveTo(1), Change::Scene);
    EXPECT_EQ(std::get<PointLight>(r.scene().lights[0]).position, dvec3(0, 2, 0));
}

// What is flattened at rest may grow.
TEST_F(GltfAnimation, FlattenedNodesGrow) {
    Maker maker;
    const size_t times = maker.floats({0, 1}, "SCALAR"), sizes = maker.floats({0, 0, 0, 2, 2, 2}, "VEC3");
    writeText(file("a.gltf"), "");
    const std::string text = maker.file(sampler(times, sizes), channel(0, 0, "scale"));
    SceneReader r = reader(text);
    EXPECT_EQ(r.scene().objects.size(), 1u);
    EXPECT_EQ(r.moveTo(0), Change::Scene);
    EXPECT_EQ(r.scene().objects.size(), 0u);
    EXPECT_EQ(r.moveTo(0.5), Change::Scene);
    ASSERT_EQ(r.scene().objects.size(), 1u);
    EXPECT_FALSE(r.scene().objects[0].transform);  // of size 1
}

TEST_F(GltfAnimation, FaultsMoveNothingAndAreSaid) {
    Maker maker;
    const size_t times = maker.floats({0, 1}, "SCALAR"), places = maker.floats({0, 0, 0, 4, 0, 2}, "VEC3"),
                 back = maker.floats({1, 1}, "SCALAR"), zero = maker.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4");
    const std::string rest = "; nothing is animated", good = sampler(times, places);
    const auto warning = [&](const std::string& samplers, const std::string& channels,
                             const std::string& node = "") {
        return warningOf(maker.file(samplers, channels, node));
    };
    EXPECT_EQ(warning(sampler(back, places), channel(0, 0, "translation")),
              "/animations/0/samplers/0: its times must ascend" + rest);
    EXPECT_EQ(warning(sampler(times, zero), channel(0, 0, "rotation")),
              "/animations/0/samplers/0: a rotation must not be zero" + rest);
    EXPECT_EQ(warning(sampler(times, places, "CUBICSPLINE"), channel(0, 0, "translation")),
              "/animations/0/samplers/0: has 2 times, and values for 0" + rest);
    EXPECT_EQ(warning(sampler(times, places, "BEZIER"), channel(0, 0, "translation")),
              "/animations/0/samplers/0/interpolation: must be LINEAR, STEP or CUBICSPLINE (got \"BEZIER\")" +
                  rest);
    EXPECT_EQ(warning(good, channel(1, 0, "translation")),
              "/animations/0/channels/0/sampler: there is no such sampler" + rest);
    EXPECT_EQ(warning(good, channel(0, 0, "colour")),
              "/animations/0/channels/0/target/path: must be translation, rotation, scale or weights (got "
              "\"colour\")" +
                  rest);
    EXPECT_EQ(warning(good, channel(0, 0, "translation"), R"(, "matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])"),
              "/animations/0/channels/0/target/node: a node with a matrix cannot be animated" + rest);
    EXPECT_EQ(warning(good, channel(0, 0, "weights")), "morph targets are ignored");
    SceneReader two = reader(maker.file(good, channel(0, 0, "translation"), "", ", {}"));
    ASSERT_EQ(two.scene().warnings.size(), 1u);
    EXPECT_HAS(two.scene().warnings[0], "of 2 animations only the first is shown");
    EXPECT_EQ(two.moveTo(1), Change::Scene);
}

// As joints of a skin, which is ignored.
TEST_F(GltfAnimation, NodesThatShowNothingAreNoAnimation) {
    Maker maker;
    const size_t times = maker.floats({0, 2}, "SCALAR"), places = maker.floats({0, 0, 0, 1, 0, 0}, "VEC3");
    std::string text = maker.file(sampler(times, places), channel(0, 4, "translation"));
    const auto replace = [&](const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
    };
    replace("[0, 2, 3]", "[0, 2, 3, 4]");
    replace("\"light\": 0}}}]", "\"light\": 0}}}, {\"name\": \"joint\"}]");
    EXPECT_EQ(warningOf(text), "the animation moves nothing that is shown");
}

}  // namespace glint::test::gltf_animation_test
