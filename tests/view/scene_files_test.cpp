#include "view/scene_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support.h"

namespace glint::view::scene_files_test {
namespace {

class SceneFiles : public test::FolderTest {};

std::set<std::string> namesOf(const std::filesystem::path& scene) {
    std::set<std::string> names;
    for (const auto& file : sceneFiles(scene)) names.insert(file.string());
    return names;
}

TEST_F(SceneFiles, FindsWhatASceneNames) {
    std::filesystem::create_directories("parts");
    test::writeText("parts/a.obj", "mtllib a.mtl\r\nv 0 0 0\n");
    test::writeText("parts/a.mtl", "newmtl m\n");
    test::writeText("scene.json", R"({ // a comment
      "meshes": {"a": {"file": "parts/a.obj"}, "b": {"file": "missing.obj"}}, "name": "red"})");
    EXPECT_EQ(namesOf("scene.json"), (std::set<std::string>{"scene.json", "parts/a.obj", "parts/a.mtl"}));
    EXPECT_EQ(namesOf("parts/a.obj"), (std::set<std::string>{"parts/a.obj", "parts/a.mtl"}));
}

TEST_F(SceneFiles, BuffersAndPicturesOfGltfBelongToIt) {
    std::filesystem::create_directories("parts");
    test::writeText("parts/a.bin", "x");
    test::writeText("parts/a.gltf", R"({"buffers": [{"uri": "a.bin"}, {"uri": "data:;base64,AAAA"}]})");
    EXPECT_EQ(namesOf("parts/a.gltf"), (std::set<std::string>{"parts/a.gltf", "parts/a.bin"}));
}

TEST_F(SceneFiles, ABrokenOrMissingSceneIsStillWatched) {
    test::writeText("broken.json", "{");
    EXPECT_EQ(namesOf("broken.json"), std::set<std::string>{"broken.json"});
    EXPECT_EQ(namesOf("nothing.json"), std::set<std::string>{"nothing.json"});
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

}  // namespace
}  // namespace glint::view::scene_files_test
