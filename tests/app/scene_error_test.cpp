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

}  // namespace glint::app::test::scene_error_test
