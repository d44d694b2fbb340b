// The "animation" of a scene file.
#include "import/load.h"
#include "import/scene_files.h"
#include "scene/transform.h"
#include "support.h"

namespace glint::test::animation_test {
using glm::dvec3;
using Change = SceneReader::Change;

// `tracks` is JSON.
std::string sceneWith(const std::string& tracks) {
    return R"({"camera": {"eye": [0, 0, 5]}, "ambient": 0.5,
        "lights": [{"type": "point", "position": [0, 1, 0]}],
        "materials": {"a/b": {"diffuse": 0.25}},
        "meshes": {"cube": {"file": "cube.obj"}},
        "objects": [{"type": "mesh", "mesh": "cube", "material": "a/b",
                     "transform": [{"quaternion": [0, 0, 0, 1]}, {"translate": [0, 0, 0]}]},
                    {"type": "sphere", "center": [0, 0, 0], "radius": 1}],
        "animation": {"framesPerSecond": 10, "tracks": [)" +
           tracks + "]}}";
}

const char* const kEye = R"({"target": "/camera/eye", "times": [0, 2], "values": [[0, 0, 5], [4, 0, 5]]})";

class AnimationFile : public FolderTest {
  protected:
    void SetUp() override { writeText(file("cube.obj"), kCubeObj); }
    SceneReader reader(const std::string& tracks, std::optional<double> time = {}) {
        writeText(file("s.json"), sceneWith(tracks));
        return {file("s.json"), {}, time};
    }
    std::string errorIn(const std::string& tracks) {
        const std::string error = glint::test::errorOf([&] { reader(tracks); });
        const size_t start = error.find("s.json: ");
        return start == std::string::npos ? error : error.substr(start + 8);
    }
};

TEST_F(AnimationFile, SaysWhatChangesAndWhen) {
    SceneReader r = reader(kEye);
    ASSERT_TRUE(r.scene().animation);
    EXPECT_EQ(r.scene().animation->framesPerSecond, 10);
    EXPECT_EQ(r.scene().animation->end, 2);
    EXPECT_EQ(r.scene().camera.eye, dvec3(0, 0, 5));
    EXPECT_EQ(r.moveTo(1), Change::Camera);
    EXPECT_EQ(r.scene().camera.eye, dvec3(2, 0, 5));
    EXPECT_EQ(r.moveTo(1), Change::Nothing);
    EXPECT_EQ(r.moveTo(3), Change::Camera);
    EXPECT_EQ(r.moveTo(4), Change::Nothing);
    EXPECT_EQ(reader(kEye, 1.5).scene().camera.eye, dvec3(3, 0, 5));
}

// Numbers of every part, keys that stand for their defaults, and names with a slash.
TEST_F(AnimationFile, MovesNumbersOfAnyPart) {
    SceneReader r = reader(R"(
        {"target": "/camera/fovY", "times": [0, 1], "values": [30, 60]},
        {"target": "/ambient", "times": [0, 1], "values": [[0, 0, 0], [1, 0.5, 0]]},
        {"target": "/lights/0/intensity", "interpolation": "step", "times": [0, 0.5], "values": [1, 3]},
        {"target": "/materials/a~1b/diffuse", "times": [0, 1], "values": [[0, 0, 0], [1, 1, 1]]},
        {"target": "/objects/1/radius", "times": [0, 1], "values": [1, 2]},
        {"target": "/objects/0/transform/1/translate", "interpolation": "cubic", "times": [0, 1],
         "values": [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [2, 4, 6], [0, 0, 0]]})");
    EXPECT_EQ(r.moveTo(0.5), Change::Scene);
    const Scene& scene = r.scene();
    EXPECT_EQ(scene.camera.fovY, 45);
    EXPECT_EQ(scene.ambient, Color(0.5, 0.25, 0));
    EXPECT_EQ(std::get<PointLight>(scene.lights[0]).intensity, Color(3));
    EXPECT_EQ(scene.materials[0].diffuse, Color(0.5));
    EXPECT_EQ(std::get<SphereShape>(scene.objects[1].shape).radius, 1.5);
    EXPECT_EQ(meshOf(scene).positions[0], dvec3(1, 2, 3));
}

TEST_F(AnimationFile, QuaternionsTurn) {
    SceneReader r = reader(R"({"target": "/objects/0/transform/0/quaternion", "times": [0, 1],
        "values": [[0, 0, 0, 1], [0, 1, 0, 0]]})");
    r.moveTo(0.5);  // a quarter turn about y takes x to -z
    const dvec3 corner = meshOf(r.scene()).positions[1];
    const SceneReader still = reader("", 0.0);
    const dvec3 before = meshOf(still.scene()).positions[1];
    EXPECT_NEAR(corner.z, -before.x, 1e-12);
    EXPECT_NEAR(corner.x, before.z, 1e-12);
}

// The moments of a reader that has been elsewhere are those of one that has not, and files are read once.
TEST_F(AnimationFile, TheWayThereDoesNotMatter) {
    const std::string tracks = std::string(kEye) + R"(,
        {"target": "/objects/1/center", "times": [0, 1, 2], "values": [[0, 0, 0], [1, 2, 3], [1, 2, 3]]})";
    SceneReader r = reader(tracks);
    EXPECT_EQ(r.moveTo(2), Change::Scene);
    writeText(file("cube.obj"), "v 9 9 9\n");
    EXPECT_EQ(r.moveTo(0.5), Change::Scene);
    EXPECT_EQ(r.moveTo(1.5), Change::Scene);
    EXPECT_EQ(r.moveTo(1.25), Change::Camera);
    writeText(file("cube.obj"), kCubeObj);
    const Scene direct = reader(tracks, 1.25).scene();
    EXPECT_EQ(r.scene().camera.eye, direct.camera.eye);
    EXPECT_EQ(std::get<SphereShape>(r.scene().objects[1].shape).center,
              std::get<SphereShape>(direct.objects[1].shape).center);
    EXPECT_EQ(meshOf(r.scene()).positions, meshOf(direct).positions);
    EXPECT_EQ(r.scene().sources, direct.sources);
}

TEST_F(AnimationFile, ErrorsSayWhere) {
    const auto track = [](const std::string& target, const std::string& times, const std::string& values) {
        return "{\"target\": \"" + target + "\", \"times\": " + times + ", \"values\": " + values + "}";
    };
    const std::string at = "/animation/tracks/0";
    EXPECT_EQ(errorIn(track("camera/eye", "[0]", "[[0,0,1]]")),
              at + "/target: must be a JSON pointer such as \"/camera/eye\" (got \"camera/eye\")");
    EXPECT_EQ(errorIn(track("/image/width", "[0]", "[3]")),
              at + "/target: \"image\" cannot be animated (camera, cameras, background, ambient, lights, "
                   "materials and objects can)");
    EXPECT_EQ(errorIn(track("/lights/1/position", "[0]", "[[0,0,1]]")),
              at + "/target: the scene has nothing of that name (\"1\" is not there)");
    EXPECT_EQ(errorIn(track("/lights/00/position", "[0]", "[[0,0,1]]")),
              at + "/target: the scene has nothing of that name (\"00\" is not there)");
    EXPECT_EQ(errorIn(track("/lights/0/type", "[0]", "[1]")),
              at + "/target: is \"point\"; numbers and lists of numbers can be animated");
    EXPECT_EQ(errorIn(track("/camera/eye", "[0]", "[[0,1]]")),
              at + "/target: has 3 numbers, and the track's values have 2");
    EXPECT_EQ(errorIn(track("/camera/eye", "[0, 0]", "[[0,0,1],[0,0,2]]")),
              at + "/times/1: must be later than the time before it (got 0)");
    EXPECT_EQ(errorIn(track("/camera/eye", "[]", "[]")),
              at + "/times: must be a list of seconds, one or more (got [])");
    EXPECT_EQ(errorIn(track("/camera/eye", "[0, 1]", "[[0,0,1]]")),
              at + "/values: must be 2 values: one for each time");
    EXPECT_EQ(errorIn(track("/camera/eye", "[0, 1]", "[[0,0,1],[0,0]]")),
              at + "/values/1: must have the form of the first value (got [0, 0])");
    EXPECT_EQ(errorIn(track("/objects/0/transform/0/quaternion", "[0]", "[[0,0,0,0]]")),
              at + "/values/0: a quaternion must not be zero (got [0, 0, 0, 0])");
    const std::string overlaps =
        "/animation/tracks/1: its target is that of a track before it, or within or around it";
    EXPECT_EQ(errorIn(std::string(kEye) + "," + kEye), overlaps);
    const std::string height = track("/camera/eye/1", "[0]", "[2]");
    EXPECT_EQ(errorIn(std::string(kEye) + "," + height), overlaps);
    EXPECT_EQ(errorIn(height + "," + kEye), overlaps);
    EXPECT_NO_THROW(reader(height + "," + track("/camera/eye/2", "[0]", "[2]")));
    EXPECT_EQ(
        errorIn(R"({"target": "/camera/eye", "times": [0], "values": [[0,0,1]], "ease": 1})").substr(0, 24),
        at + "/ease");
}

TEST_F(AnimationFile, ErrorsHaveLineAndColumn) {
    const std::string track = R"({"target": "/lights/1/position", "times": [0], "values": [[0, 0, 1]]})";
    for (const std::optional<double> time : {std::optional<double>(), std::optional(0.5)}) {
        const std::string error = placedErrorOf([&] { reader(track, time); });
        EXPECT_HAS(error, "s.json:8:68: /animation/tracks/0/target: ");
    }
}

// The tracks' values must form a scene. Otherwise the message gives the time, and the moment before stays:
// the same request fails again, and earlier moments can be reached.
TEST_F(AnimationFile, AMomentAtFaultIsNotTaken) {
    const std::string radiusTrack = R"({"target": "/objects/1/radius", "times": [0, 1], "values": [1, -1]})";
    const std::string fovTrack = R"({"target": "/camera/fovY", "times": [0, 1], "values": [30, -30]})";
    for (const auto& [track, what] : {std::pair(radiusTrack, "/objects/1/radius: must be > 0 (got -0.5)"),
                                      std::pair(fovTrack, "/camera/fovY: must be ")}) {
        SceneReader r = reader(track);
        r.moveTo(0.25);
        const double radius = std::get<SphereShape>(r.scene().objects[1].shape).radius;
        const double fov = r.scene().camera.fovY;
        for (int i = 0; i < 2; ++i) {
            const std::string error = glint::test::errorOf([&] { r.moveTo(0.75); });
            EXPECT_HAS(error, what);
            EXPECT_ENDS(error, " (at 0.75 s of the animation)");
        }
        EXPECT_EQ(std::get<SphereShape>(r.scene().objects[1].shape).radius, radius);
        EXPECT_EQ(r.scene().camera.fovY, fov);
        EXPECT_EQ(r.moveTo(0.25), Change::Nothing);
        EXPECT_NE(r.moveTo(0.375), Change::Nothing);
    }
}

}  // namespace glint::test::animation_test
