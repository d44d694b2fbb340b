// `--camera NAME`: the scene's cameras by name, in every command that has one.
#include "support.h"

namespace glint::app::test::camera_test {
const std::string kRest = R"("ambient": 0.3, "lights": [{"type": "point", "position": [1, 6, 4]}],
    "objects": [{"type": "sphere", "center": [0.5, 0, 0], "radius": 1}])";

class CameraOption : public FolderTest {
  protected:
    void SetUp() override {
        writeText("two.json",
                  R"({"image": {"width": 32, "height": 24}, "camera": {"eye": [0, 0, 5]}, "cameras": {
            "side": {"eye": [5, 1, 0], "fovY": 30}, "far": {"eye": [0, 0, 50]}}, )" +
                      kRest + "}");
        writeText("side.json",
                  R"({"image": {"width": 32, "height": 24}, "camera": {"eye": [5, 1, 0], "fovY": 30}, )" +
                      kRest + "}");
    }
    static Ran onHost(const Words& args) { return runGlint(args, "--backend cpu"); }
};

TEST_F(CameraOption, DrawsWhatThatCameraSees) {
    ASSERT_EQ(onHost("render two.json -q -o a.pfm --camera side").code, 0);
    ASSERT_EQ(onHost("render side.json -q -o b.pfm").code, 0);
    ASSERT_EQ(onHost("render two.json -q -o c.pfm").code, 0);
    EXPECT_EQ(readBytes("a.pfm"), readBytes("b.pfm"));
    EXPECT_NE(readBytes("a.pfm"), readBytes("c.pfm"));
}

TEST_F(CameraOption, TracesItsPixels) {
    const Ran side = onHost("trace two.json --pixel 16,12 --camera side");
    EXPECT_EQ(side.code, 0);
    EXPECT_EQ(side.out, onHost("trace side.json --pixel 16,12").out);
    EXPECT_NE(side.out, onHost("trace two.json --pixel 16,12").out);
}

TEST_F(CameraOption, InfoListsThem) {
    const Ran ran = runGlint("info two.json --camera far");
    EXPECT_EQ(ran.code, 0);
    EXPECT_HAS(ran.out, "  camera        perspective\n  cameras       \"side\", \"far\"\n");
    EXPECT_LACKS(runGlint("info side.json").out, "cameras");
}

TEST_F(CameraOption, AnUnknownNameIsAnErrorOfTheCommandLine) {
    for (const char* command : {"render two.json --backend cpu", "trace two.json --backend cpu --pixel 1,1",
                                "info two.json", "bench two.json --backend cpu"})
        expectError(command + Words("--camera sid"), 2,
                    "two.json: no camera \"sid\" (there are \"side\", \"far\")");
    expectError("info side.json --camera x", 2, "side.json: no camera \"x\" (none in it has a name)");
    expectError("info two.json --camera ''", 2, "--camera: the name is empty");
}

// Parts of pictures of two cameras make no picture.
TEST_F(CameraOption, PartsKnowTheirCamera) {
    ASSERT_EQ(onHost("render two.json -q --part 1/2 -o 1.part").code, 0);
    ASSERT_EQ(onHost("render two.json -q --part 2/2 -o 2.part --camera side").code, 0);
    const Ran merged = runGlint("merge 1.part 2.part -o m.pfm");
    EXPECT_NE(merged.code, 0);
    EXPECT_HAS(merged.err, "camera");
}

}  // namespace glint::app::test::camera_test
