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
    {"unknownKind", "a.dae", "{}",
     ": unknown kind of file (a scene is .json, .gltf, .glb or .nff, a model .obj, .ply or .stl)"},
};
INSTANTIATE_TEST_SUITE_P(All, BadScene, ::testing::ValuesIn(kScenes),
                         [](const auto& test) { return test.param.name; });

class SceneFile : public FolderTest {};

TEST_F(SceneFile, AMissingOneNamesItsNeighbour) {
    std::filesystem::create_directory("sub");
    writeSmallScene("sub/earth.json");
    writeText("sub/erth.png", "");
    for (const auto& [file, hint] : {std::pair("sub/erth.json", " (did you mean \"earth.json\"?)"),
                                     {"sub/earth.obj", " (did you mean \"earth.json\"?)"},
                                     {"sub/moon.json", ""}})
        expectError({"info", file}, 3, std::string(file) + ": no such file" + hint);
}

// A model that can be rendered.
TEST_F(SceneFile, NotFiniteVerticesAreAWarning) {
    writeText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 1 0\nf 1 2 3\nf 1 2 4\n");
    const Ran ran = runGlint("render a.obj --backend cpu --size 16x12");
    EXPECT_EQ(ran.err,
              "glint: warning: a.obj: /objects/0: 1 of 2 triangles dropped: a vertex is not finite or beyond "
              "the range of fp32\n");
    EXPECT_EQ(ran.code, 0);
    EXPECT_TRUE(std::filesystem::exists("a.png"));
    EXPECT_EQ(runGlint("render a.obj --backend cpu --size 16x12 -q").err, "");
}

}  // namespace glint::app::test::scene_error_test
