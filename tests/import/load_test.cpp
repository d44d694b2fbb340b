// From files.
#include "import/load.h"

#include "support.h"

namespace glint::test::load_test {

TEST(Load, FilesThatCannotBeRead) {
    const TemporaryFolder folder;
    for (const std::string name : {"gone.json", "gone.obj", "gone.ply", "gone.xyz"}) {
        const auto path = folder.path() / name;
        EXPECT_EQ(errorOf([&] { loadScene(path); }), path.string() + ": no such file");
    }
    std::filesystem::create_directory(folder.path() / "folder.json");
    const auto directory = folder.path() / "folder.json";
    EXPECT_EQ(errorOf([&] { loadScene(directory); }), directory.string() + ": is a folder, not a file");
    EXPECT_EQ(errorOf([&] { loadScene(folder.path()); }),
              folder.path().string() + ": is a folder, not a file");
    for (const std::string name : {"empty.json", "empty.obj", "empty.ply"}) {
        const auto path = folder.write(name, "");
        EXPECT_EQ(errorOf([&] { loadScene(path); }), path.string() + ": the file is empty");
    }
    const auto link = folder.path() / "zero.json";
    std::filesystem::create_symlink("/dev/zero", link);
    EXPECT_EQ(errorOf([&] { loadScene(link); }), link.string() + ": is not a regular file");
}

TEST(Load, FilesWithoutPermission) {
    const TemporaryFolder folder;
    const auto path = folder.write("secret.json", "{}");
    std::filesystem::permissions(path, std::filesystem::perms::none);
    withoutPrivileges(folder.path(), [&] {
        EXPECT_EQ(errorOf([&] { loadScene(path); }), path.string() + ": cannot be read: Permission denied");
    });
}

TEST(Load, UnknownKinds) {
    const TemporaryFolder folder;
    for (const std::string name : {"a.fbx", "a.txt", "a"}) {
        const auto path = folder.write(name, "x");
        EXPECT_EQ(errorOf([&] { loadScene(path); }),
                  path.string() +
                      ": unknown kind of file (a scene is .json, .gltf, .glb or .nff, a model "
                      ".obj, .ply or .stl)");
    }
}

TEST(Load, SceneFilesAreRelativeToThemselves) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "models");
    folder.write("models/cube.obj", kCubeObj);
    const auto path = folder.write(
        "scene.JSON",
        R"({"meshes": {"c": {"file": "models/cube.obj"}}, "objects": [{"type": "mesh", "mesh": "c"}]})");
    const Scene scene = loadScene(path);
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(std::get<MeshShape>(scene.objects[0].shape).mesh->corners.size(), 12u);
    EXPECT_TRUE(scene.lights.empty());  // a scene file says itself what lights it
}

TEST(Load, TheCameraOfAModelThatIsTooLargeIsNotBlamed) {
    const TemporaryFolder folder;
    for (const std::string far : {"1e39", "1e300"}) {
        const auto path = folder.write("far.obj", "v " + far + " 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
        const std::string error = errorOf([&] { loadScene(path); });
        EXPECT_EQ(error.rfind(path.string() + ": /objects/0: vertex 0 of the mesh: coordinates must be ", 0),
                  0u)
            << error;
    }
    // Each number may stand there, but what shows them all may not.
    const auto large = folder.write("large.obj", "v 9e17 0 0\nv -9e17 1 0\nv 0 9e17 1\nf 1 2 3\n");
    EXPECT_EQ(errorOf([&] { loadScene(large); }),
              large.string() +
                  ": the model is too large or too far away for a camera in front of it (whose "
                  "coordinates must be below 1e+18, too)");
}

TEST(Load, TheFileOfAFaultyMeshIsNamed) {
    const TemporaryFolder folder;
    const auto path = folder.write(
        "s.json", R"({"meshes": {"m": {"file": "far.obj"}}, "objects": [{"type": "mesh", "mesh": "m"}]})");
    const auto errorWith = [&](const std::string& vertex) {
        folder.write("far.obj", "v 0 0 0\nv " + vertex + "\nv 0 0 1\nf 1 2 3\n");
        return errorOf([&] { loadScene(path); });
    };
    const std::string file = (folder.path() / "far.obj").string();
    EXPECT_EQ(errorWith("1e30 1 0"),
              file + ": vertex 1 (the first is 0): coordinates must be below 1e+18 (got [1e+30, 1, 0])");
    EXPECT_EQ(errorWith("1 1 0"), "no error");
}

TEST(Load, WhatIsNoMeshFileIsSaidOfTheScene) {
    const TemporaryFolder folder;
    const std::string text = folder.write("a.txt", "x").string();
    const auto path = folder.write("s.json", R"({"meshes": {"m": {"file": "a.txt"}},
  "objects": [{"type": "mesh", "mesh": "m"}]})");
    EXPECT_EQ(errorOf([&] { loadScene(path); }),
              path.string() + ": /meshes/m/file: " + text +
                  ": a mesh file must end in .obj, .ply, .stl, .gltf or .glb");
}

TEST(Load, WhatIsNoGlbIsNotTakenForJson) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", "<!DOCTYPE html>");
    EXPECT_EQ(errorOf([&] { loadScene(path); }),
              path.string() + ": neither GLB, which starts with \"glTF\", nor glTF's JSON");
}

TEST(Load, AModelAloneGetsCameraLightAndMaterial) {
    const TemporaryFolder folder;
    const Scene scene = loadScene(folder.write("cube.obj", kCubeObj));
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "/objects/0");
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, Color(0.8));
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.camera.target, glm::dvec3(0.5));
    EXPECT_EQ(scene.maxDepth, 5);
}

TEST(Load, AModelWithMaterialsKeepsThem) {
    const TemporaryFolder folder;
    folder.write("c.mtl", "newmtl red\nKd 1 0 0\n");
    const Scene scene =
        loadScene(folder.write("c.obj", std::string("mtllib c.mtl\nusemtl red\n") + kCubeObj));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, Color(1, 0, 0));
    EXPECT_EQ(std::get<MeshShape>(scene.objects[0].shape).mesh->materials, std::vector<uint32_t>(12, 0));
}

TEST(Load, WarningsOfModelsReachTheScene) {
    const TemporaryFolder folder;
    const auto path = folder.write("c.obj", std::string(kCubeObj) + "f 1 1 1\n");
    EXPECT_EQ(loadScene(path).warnings,
              std::vector<std::string>{path.string() +
                                       ": 1 face with fewer than three different vertices left out"});
}

}  // namespace glint::test::load_test
