// `glint render --frames` and `--time`, on the reference.
#include <filesystem>

#include "support.h"

namespace glint::app::test::frames_test {
const char* const kTracks = R"(
    {"target": "/camera/eye", "times": [0, 1], "values": [[0, 0, 5], [1, 0, 5]]},
    {"target": "/objects/1/radius", "times": [0.5, 1], "values": [0.5, 1]})";

class Frames : public FolderTest {
  protected:
    void SetUp() override {
        writeText("a.json", sceneText(32, 24,
                                      std::string(R"("ambient": 0.3,
            "lights": [{"type": "point", "position": [1, 6, 4]}],
            "objects": [{"type": "triangle", "vertices": [[-2, -1, 0], [2, -1, 0], [0, 2, -1]]},
                        {"type": "sphere", "center": [0, 0, 1], "radius": 0.5}],
            "animation": {"framesPerSecond": 4, "tracks": [)") +
                                          kTracks + "]}"));
    }

    inline static const Words kRender = "render a.json --backend cpu";

    static Words wordsFor(const std::string& range) { return kRender + "-o f.##.pfm --frames" + range; }
    static Ran frames(const std::string& range, const Words& more = {}) {
        return runGlint(wordsFor(range), more);
    }
};

// A frame has the bytes of its moment drawn by itself, whatever was drawn before it.
TEST_F(Frames, AreTheMomentsOfTheScene) {
    ASSERT_EQ(frames("0:4", "-q").code, 0);
    EXPECT_EQ(names(),
              (std::set<std::string>{"a.json", "f.00.pfm", "f.01.pfm", "f.02.pfm", "f.03.pfm", "f.04.pfm"}));
    std::set<std::vector<uint8_t>> different;
    for (int frame = 0; frame <= 4; ++frame) {
        const std::string name = "f.0" + std::to_string(frame) + ".pfm";
        ASSERT_EQ(runGlint(kRender + "-q -o one.pfm --time" + std::to_string(frame / 4.0)).code, 0);
        EXPECT_EQ(readBytes("one.pfm"), readBytes(name)) << frame;
        different.insert(readBytes(name));
    }
    EXPECT_EQ(different.size(), 5u);
}

// A frame of a glTF file is its moment too.
TEST_F(Frames, OfGltf) {
    writeText("a.json", "");
    writeText("m.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 68, "uri":
        "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAgL8="}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
                        {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}, {"mesh": 0}],
        "animations": [{"samplers": [{"input": 1, "output": 2}],
                        "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}]})");
    const auto render = [](const Words& options) {
        EXPECT_EQ(runGlint("render m.gltf --backend cpu -q --size 32x24", options).code, 0);
    };
    render("--frames 0:3 --fps 3 -o f.#.pfm");
    std::set<std::vector<uint8_t>> different;
    for (int frame = 0; frame <= 3; ++frame) {
        render({"--time", std::to_string(frame / 3.0), "-o", "one.pfm"});
        const auto bytes = readBytes("f." + std::to_string(frame) + ".pfm");
        EXPECT_EQ(readBytes("one.pfm"), bytes) << frame;
        different.insert(bytes);
    }
    EXPECT_EQ(different.size(), 4u);
}

TEST_F(Frames, ThoseThatAreThereStay) {
    ASSERT_EQ(frames("1:2", "-q").code, 0);
    const auto before = readBytes("f.02.pfm");
    writeText("f.01.pfm", "mine");
    const Ran more = frames("1:3");
    EXPECT_EQ(more.code, 0);
    EXPECT_STARTS(
        more.out,
        "wrote 1 frame, f.03.pfm\n2 frames were there already (--overwrite renders them again)\ndevice: ");
    EXPECT_EQ(glint::test::readText("f.01.pfm"), "mine");
    const Ran none = frames("1:3");
    EXPECT_EQ(none.code, 0);
    EXPECT_STARTS(none.out, "3 frames were there already");
    EXPECT_EQ(frames("1:2", "-q --overwrite").code, 0);
    EXPECT_NE(glint::test::readText("f.01.pfm"), "mine");
    EXPECT_EQ(readBytes("f.02.pfm"), before);
}

// The camera alone moves until half a second; a layer that is missing makes the frame incomplete.
TEST_F(Frames, StatsSayWhatChanged) {
    const Words args = wordsFor("0:3") + "--stats json --aov color,depth";
    const nlohmann::json json = jsonOf(args);
    ASSERT_EQ(json["frames"].size(), 4u);
    EXPECT_EQ(json["frames"][1]["changed"], "camera");
    EXPECT_EQ(json["frames"][2]["changed"], "camera");
    EXPECT_EQ(json["frames"][3]["changed"], "scene");
    EXPECT_EQ(json["frames"][3]["time"], 0.75);
    EXPECT_EQ(json["frames"][3]["files"], nlohmann::json({"f.03.pfm", "f.03.depth.pfm"}));
    EXPECT_EQ(json["treesBuilt"], 2);
    std::filesystem::remove("f.02.depth.pfm");
    EXPECT_EQ(jsonOf(args)["there"], 3);
}

TEST_F(Frames, RateAndNames) {
    ASSERT_EQ(runGlint(kRender + "--frames 2 -q --fps 8 -o one.pfm").code, 0);
    ASSERT_EQ(runGlint(kRender + "--frames 1:1 -q -o two.pfm").code, 0);
    EXPECT_EQ(readBytes("one.pfm"), readBytes("two.pfm"));
}

TEST_F(Frames, ASceneWithoutAnimationIsSaidToHaveNone) {
    writeSmallScene("a.json");
    const Ran ran = frames("0:1", "--size 8x6");
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "glint: warning: a.json: has no animation; all frames are the same image\n");
    EXPECT_EQ(readBytes("f.00.pfm"), readBytes("f.01.pfm"));
    const Ran one = runGlint(kRender + "--size 8x6 --time 1");
    EXPECT_EQ(one.code, 0);
    EXPECT_EQ(one.err, "glint: warning: a.json: has no animation; --time changes nothing\n");
}

}  // namespace glint::app::test::frames_test
