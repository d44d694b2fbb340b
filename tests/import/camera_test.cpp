// Cameras that have names: reading, choosing, and writing them into files that people edit.
#include <nlohmann/json.hpp>

#include "gltf_maker.h"
#include "import/camera_writer.h"
#include "import/load.h"
#include "scene/cameras.h"
#include "support.h"

namespace glint::test::camera_test {
using glm::dvec3;

const char* const kTwo = R"({"camera": {"eye": [0, 0, 9]}, "cameras": {
    "front": {"eye": [0, 0, 4], "fovY": 30}, "a/b": {"type": "orthographic", "eye": [0, 5, 1], "height": 2}}})";

class Cameras : public FolderTest {
  protected:
    Scene chosen(const std::string& text, const std::string& camera) {
        writeText(file("s.json"), text);
        return loadScene(file("s.json"), {.camera = camera});
    }
};

TEST_F(Cameras, HaveNamesAndTheFieldsOfACamera) {
    const Scene scene = parse(kTwo);
    EXPECT_EQ(scene.camera.eye, dvec3(0, 0, 9));
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_EQ(scene.cameras[0].name, "front");
    EXPECT_EQ(scene.cameras[0].camera.fovY, 30);
    EXPECT_EQ(scene.cameras[1].name, "a/b");
    EXPECT_EQ(scene.cameras[1].camera.projection, Projection::Orthographic);
    EXPECT_TRUE(parse("{}").cameras.empty());
}

TEST_F(Cameras, AreChosenByName) {
    EXPECT_EQ(chosen(kTwo, "").camera.eye, dvec3(0, 0, 9));
    EXPECT_EQ(chosen(kTwo, "a/b").camera.eye, dvec3(0, 5, 1));
    EXPECT_EQ(chosen(kTwo, "front").image.width, ImageSettings().width);
    const auto error = [&](const std::string& text, const std::string& name) {
        const std::string what = glint::test::errorOf(ErrorKind::Argument, [&] { chosen(text, name); });
        return what.substr(what.find("s.json"));
    };
    EXPECT_EQ(error(kTwo, "frnt"), "s.json: no camera \"frnt\" (there are \"front\", \"a/b\")");
    EXPECT_EQ(error("{}", "x\n"), "s.json: no camera \"x?\" (none in it has a name)");
}

// A chosen camera has tracks of its own, and the others' do not move it.
TEST_F(Cameras, AreAnimated) {
    writeText(file("s.json"), R"({"camera": {}, "cameras": {"a": {"eye": [0, 0, 4]}, "b": {"eye": [0, 0, 3]}},
        "animation": {"tracks": [
            {"target": "/cameras/a/eye", "times": [0, 1], "values": [[0, 0, 4], [2, 0, 4]]},
            {"target": "/camera/eye", "times": [0, 1], "values": [[0, 0, 4], [9, 0, 4]]}]}})");
    SceneReader reader(file("s.json"), {.camera = "a"});
    EXPECT_EQ(reader.scene().camera.eye, dvec3(0, 0, 4));
    EXPECT_EQ(reader.moveTo(0.5), SceneReader::Change::Camera);
    EXPECT_EQ(reader.scene().camera.eye, dvec3(1, 0, 4));
    SceneReader other(file("s.json"), {.camera = "b"}, 1.0);
    EXPECT_EQ(other.scene().camera.eye, dvec3(0, 0, 3));
    EXPECT_EQ(other.scene().cameras[0].camera.eye, dvec3(2, 0, 4));
}

// ---- glTF ----

// A wide camera, a square one of another node's name, the first again, and one with a fault.
std::string gltfWithCameras() {
    return triangleGltf(
        R"("cameras": [{"type": "perspective", "name": "wide", "perspective": {"yfov": 0.5, "aspectRatio": 2,
            "znear": 0.1}}, {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0, "zfar": 9}},
            {"type": "perspective", "name": "bad", "perspective": {"yfov": 4, "znear": 1}}])",
        R"(}, {"camera": 0, "translation": [0, 0, 3]}, {"camera": 1, "name": "node", "translation": [0, 0, 4]},
           {"camera": 0, "translation": [0, 0, 5]}, {"camera": 2}, {"camera": 1, "scale": [0, 0, 0])");
}

TEST_F(Cameras, OfGltfAreChosenByName) {
    writeText(file("a.gltf"), gltfWithCameras());
    const Scene first = loadScene(file("a.gltf"));
    EXPECT_EQ(cameraNames(first, 9), "\"wide\", \"node\", \"wide (2)\"");
    EXPECT_EQ(first.camera.eye, dvec3(0, 0, 3));
    EXPECT_EQ(first.image.width, 1200);
    ASSERT_EQ(first.warnings.size(), 3u);
    EXPECT_HAS(first.warnings[0],
               "/cameras/2/perspective/yfov: must be between 0 and pi (got 4); this camera is left out");
    EXPECT_HAS(first.warnings[1], "\"camera 1\"");
    EXPECT_HAS(first.warnings[2], "has 3 cameras; the first is used, \"wide\"");

    const Scene node = loadScene(file("a.gltf"), {.camera = "node"});
    EXPECT_EQ(node.camera.projection, Projection::Orthographic);
    EXPECT_EQ(node.camera.eye, dvec3(0, 0, 4));
    EXPECT_EQ(node.image.width, 600);
    EXPECT_EQ(node.image.height, 600);
    EXPECT_EQ(node.warnings.size(), 2u);
    EXPECT_EQ(loadScene(file("a.gltf"), {.camera = "wide (2)"}).camera.eye, dvec3(0, 0, 5));
}

// ---- writing ----

NamedCamera named(const std::string& name, double x) {
    NamedCamera camera{name, {}};
    camera.camera.eye = {x, 0.1, 1.0 / 3};
    return camera;
}

const std::string kA = "\"a\": " + cameraText(named("a", 1).camera);
const std::string kB = "\"b\": " + cameraText(named("b", 2).camera);

std::string with(const std::string& text, const std::vector<NamedCamera>& cameras = {named("a", 1)}) {
    return withCameras(text, "s.json", cameras);
}

TEST_F(Cameras, TextMeansTheSame) {
    Camera full;
    full.eye = {0.1, 1e-17, -1.0 / 3};
    full.planeNormal = dvec3(0, 0.1, 1);
    full.window = ViewWindow{-0.1, 0.7, -1.0 / 7, 0.3};
    full.nearT = 0.1;
    full.farT = 1e17;
    full.lensRadius = 0.01;
    full.focusDistance = 2.0 / 3;
    Camera parallel;
    parallel.projection = Projection::Orthographic;
    parallel.height = 1.1;
    Camera wide;
    wide.fovY = 100.0 / 3;
    for (const Camera& camera : {Camera{}, full, parallel, wide})
        EXPECT_EQ(parse("{\"camera\": " + cameraText(camera) + "}").camera, camera) << cameraText(camera);
}

// Written by hand, to show what is kept.
TEST_F(Cameras, AreWrittenBesideWhatIsThere) {
    EXPECT_EQ(with("{}"), "{\n  \"cameras\": {\n    " + kA + "\n  }\n}");
    EXPECT_EQ(
        with("{\n  \"camera\": {},  // mine\n  \"objects\": []\n}\n"),
        "{\n  \"cameras\": {\n    " + kA + "\n  },\n  \"camera\": {},  // mine\n  \"objects\": []\n}\n");
    EXPECT_EQ(with("// top\n{\n  \"camera\": {}\n}"),
              "// top\n{\n  \"cameras\": {\n    " + kA + "\n  },\n  \"camera\": {}\n}");
    EXPECT_EQ(with("{\"camera\": {}}"), "{\n  \"cameras\": {\n    " + kA + "\n  },\n\"camera\": {}}");
    EXPECT_EQ(
        with("// { top\n{\n  \"cameras\": {\n    " + kB + "  // side\n  },\n  \"ambient\": 1\n}"),
        "// { top\n{\n  \"cameras\": {\n    " + kA + ",\n    " + kB + "  // side\n  },\n  \"ambient\": 1\n}");
    EXPECT_EQ(with("{\r\n\t\"cameras\": {\r\n\t\t" + kB + "  // last\r\n\t}\r\n}\r\n"),
              "{\r\n\t\"cameras\": {\r\n\t\t" + kA + ",\r\n\t\t" + kB + "  // last\r\n\t}\r\n}\r\n");
    EXPECT_EQ(with("{\"cameras\": {" + kB + "}}"), "{\"cameras\": {\n  " + kA + ",\n" + kB + "}}");
    EXPECT_EQ(with("{\n  \"cameras\": {\n  }\n}"), "{\n  \"cameras\": {\n    " + kA + "\n  }\n}");
    EXPECT_EQ(with("{\n  \"cameras\": {}\n}", {named("a", 1), named("b", 2)}),
              "{\n  \"cameras\": {\n    " + kA + ",\n    " + kB + "\n  }\n}");
    EXPECT_EQ(with("{\"ambient\": 1}", {}), "{\"ambient\": 1}");
}

// In files of many layouts every byte is kept, all other values stay the same, and the new cameras are
// added.
TEST_F(Cameras, NothingOfTheFileIsLost) {
    const std::string values[] = {"{}", "{\"fovY\": 30 }", "{ // \"cameras\": {\n}", "{\"up\": [0, 1, 0]}"};
    const std::string blanks[] = {
        "", " ", "\n", "\n  ", " /* } */ ", " // ,\n  ", "\r\n\t", "\n\n/* \" */\n ", "//{\n"};
    const std::string bom = "\xef\xbb\xbf";
    int files = 0;
    for (const std::string& value : values)
        for (const std::string& x : blanks)
            for (const std::string& y : blanks)
                for (const std::string key : {"camera", "cam\\u0065ras", "materials"})
                    for (const bool more : {false, true}) {
                        const bool list = key[3] == '\\' || key == "materials";
                        std::string text =
                            bom + x + "{" + y + "\"" + key + "\"" + x + ":" + y +
                            (list ? "{" + x + "\"{x\\\"\"" + y + ":" + value + y + "}" : value) + x;
                        if (more) text += "," + y + "\"ambient\": 0.5 " + x;
                        text += "}" + y;
                        const std::string written = with(text, {named("a", 1), named("\"]}", 2)});
                        size_t at = 0;  // each byte comes again, in its order
                        for (const char c : text) {
                            if (std::string_view(" \t\r\n").find(c) != std::string_view::npos) continue;
                            at = written.find(c, at);
                            ASSERT_NE(at, std::string::npos) << text << "\n" << written;
                            ++at;
                        }
                        auto before = nlohmann::json::parse(text, nullptr, true, true);
                        auto after = nlohmann::json::parse(written, nullptr, true, true);
                        ASSERT_EQ(after["cameras"].size(), before["cameras"].size() + 2);
                        EXPECT_EQ(after["cameras"]["\"]}"]["eye"][0], 2.0);
                        before.erase("cameras");
                        after.erase("cameras");
                        EXPECT_EQ(after, before) << text << "\n" << written;
                        ++files;
                    }
    EXPECT_GT(files, 1000);
}

TEST_F(Cameras, WritingRefusesWhatItCannotKeep) {
    using enum ErrorKind;
    const auto error = [](ErrorKind kind, const std::string& text, const std::vector<NamedCamera>& cameras) {
        return glint::test::errorOf(kind, [&] { with(text, cameras); });
    };
    EXPECT_EQ(error(Argument, "{\"cameras\": {" + kA + "}}", {named("a", 3)}),
              "s.json: there is a camera \"a\" already");
    EXPECT_EQ(error(Argument, "{}", {named("a", 3), named("a", 4)}),
              "s.json: there is a camera \"a\" already");
    EXPECT_EQ(error(ErrorKind::Scene, "[]", {named("a", 3)}), "s.json: must be an object {...} (got [])");
    EXPECT_EQ(error(ErrorKind::Scene, "{\"cameras\": 3}", {named("a", 3)}),
              "s.json: /cameras: must be an object {...} (got 3)");
    EXPECT_HAS(error(ErrorKind::Scene, "{", {named("a", 3)}), "s.json:1:");
    EXPECT_EQ(error(Failed, "{}", {named("\xff", 3)}),
              "s.json: its cameras cannot be written; paste them by hand");
}

}  // namespace glint::test::camera_test
