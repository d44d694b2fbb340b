#include "view/view_scene.h"

#include <gtest/gtest.h>

#include <set>

#include "import/load.h"
#include "support.h"

namespace glint::view::scene_files_test {
class SceneFiles : public test::FolderTest {};

TEST_F(SceneFiles, AreThoseThatTheSceneWasReadFrom) {
    std::filesystem::create_directories("parts");
    test::writeText("parts/a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test::writeText("parts/a.mtl", "newmtl m\nKd 1 0 0\n");
    test::writeText("scene.json", R"({ // a comment
      "meshes": {"a": {"file": "parts/a.obj"}}, "objects": [{"type": "mesh", "mesh": "a"}]})");
    std::set<std::string> names;
    for (const auto& file : sceneFiles("scene.json", loadScene("scene.json"))) names.insert(file.string());
    EXPECT_EQ(names, (std::set<std::string>{"scene.json", "parts/a.obj", "parts/a.mtl"}));
}

TEST_F(SceneFiles, ReportsAChangeOnceItIsOver) {
    FileWatch watch;
    watch.watch({"scene.json"});
    EXPECT_FALSE(watch.changed());
    test::writeText("scene.json", "{}");
    EXPECT_FALSE(watch.changed());  // may still be being written
    EXPECT_TRUE(watch.changed());
    EXPECT_FALSE(watch.changed());
    std::filesystem::remove("scene.json");
    EXPECT_FALSE(watch.changed());
    EXPECT_TRUE(watch.changed());
}

}  // namespace glint::view::scene_files_test
