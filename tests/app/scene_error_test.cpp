// Scenes and models that are at fault: one line that says where, exit code 3, no file left behind.
#include "support.h"

namespace glint::app::test::scene_error_test {
struct Bad {
    const char* name;
    const char* file;
    const char* text;
    const char* line;  // after "glint: " and the file's name
};

class BadScene : public FolderTest, public ::testing::WithParamInterface<Bad> {};

TEST_P(BadScene, IsOneLineAndExitCode3) {
    const Bad& bad = GetParam();
    writeText(bad.file, bad.text);
    for (const char* command : {"render --backend cpu -o out.png", "info", "trace --backend cpu --pixel 0,0"})
        expectError(command + Words(bad.file), 3, std::string(bad.file) + bad.line);
    EXPECT_EQ(names(), std::set<std::string>{bad.file});
}

const Bad kScenes[] = {
    {"empty", "a.json", "", ": the file is empty"},
    {"syntax", "a.json", "{\n  \"objects\": [1,}", ":2:16: a comma must not stand before '}'"},
    {"unknownKey", "a.json", "{\"objekts\": []}", ":1:13: /objekts: unknown key (did you mean \"objects\"?)"},
    {"spot", "a.json",
     R"({"lights": [{"type": "spot", "position": [0,1,0], "direction": [0,-1,0], "angle": 200}]})",
     ":1:83: /lights/0/angle: must be from 0 to 180 degrees (got 200)"},
    {"missingMesh", "a.json",
     R"({"meshes": {"m": {"file": "no.obj"}}, "objects": [{"type": "mesh", "mesh": "m"}]})",
     ":1:27: /meshes/m/file: no such file: no.obj"},
    {"truncatedPly", "a.ply",
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
     "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n",
     ":11: the file ends after 2 of 3 elements \"vertex\""},
    {"unknownKind", "a.dae", "{}",
     ": unknown kind of file (a scene is .json, .gltf, .glb or .nff, a model .obj, .ply or .stl)"},
};
INSTANTIATE_TEST_SUITE_P(All, BadScene, ::testing::ValuesIn(kScenes),
                         [](const auto& test) { return test.param.name; });

class SceneFile : public FolderTest {};

TEST_F(SceneFile, MissingOrAFolder) {
    std::filesystem::create_directory("folder.json");
    const std::pair<const char*, const char*> cases[] = {{"no.json", "no such file"},
                                                         {"no/no.json", "no such file"},
                                                         {"no.ply", "no such file"},
                                                         {"folder.json", "is a folder, not a file"},
                                                         {"folder.json/", "is a folder, not a file"}};
    for (const auto& [file, reason] : cases)
        expectError({"render", file, "--backend", "cpu"}, 3, std::string(file) + ": " + reason);
    EXPECT_EQ(names(), std::set<std::string>{"folder.json"});
}

TEST_F(SceneFile, AMissingOneNamesItsNeighbour) {
    std::filesystem::create_directory("sub");
    writeSmallScene("sub/earth.json");
    writeText("sub/erth.png", "");
    for (const auto& [file, hint] : {std::pair("sub/erth.json", " (did you mean \"earth.json\"?)"),
                                     {"sub/earth.obj", " (did you mean \"earth.json\"?)"},
                                     {"sub/moon.json", ""}})
        expectError({"info", file}, 3, std::string(file) + ": no such file" + hint);
}

// Models that can be rendered, with a warning each.
TEST_F(SceneFile, NotFiniteVerticesAreAWarning) {
    writeText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 1 0\nf 1 2 3\nf 1 2 4\n");
    const Ran ran = runGlint("render a.obj --backend cpu --size 16x12");
    EXPECT_EQ(ran.err,
              "glint: warning: a.obj: /objects/0: 1 of 2 triangles dropped: a vertex is not finite or beyond "
              "the range of fp32\n");
    EXPECT_EQ(ran.code, 0);
    EXPECT_TRUE(std::filesystem::exists("a.png"));
}

TEST_F(SceneFile, TexturesAndMissingMaterialFilesAreWarnings) {
    writeText("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    writeText("a.mtl", "newmtl m\nKd 1 0 0\nmap_Kd no.png\n");
    writeText("b.obj", "mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Ran a = runGlint("render a.obj --backend cpu --size 16x12");
    EXPECT_EQ(a.err, "glint: warning: a.mtl: no.png: no such file; drawn without it\n");
    EXPECT_EQ(a.code, 0);
    const Ran b = runGlint("render b.obj --backend cpu --size 16x12");
    EXPECT_EQ(b.err, "glint: warning: b.obj:1: no.mtl: no such file; drawn without these materials\n");
    EXPECT_EQ(b.code, 0);
    EXPECT_EQ(runGlint("render b.obj --backend cpu --size 16x12 -q").err, "");
}

}  // namespace glint::app::test::scene_error_test
