// Which files a scene may read, each once, and how much memory they may take.
#include <set>

#include "core/image_io.h"
#include "import/load.h"
#include "import/scene_files.h"
#include "support.h"

namespace glint::test::scene_files_test {

namespace fs = std::filesystem;

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string sceneOf(const std::string& file) {
    return R"({"meshes": {"m": {"file": ")" + file + R"("}}, "objects": [{"type": "mesh", "mesh": "m"}]})";
}

// A folder "own" with a scene, and "other" beside it.
class SceneFolder : public FolderTest {
  protected:
    void SetUp() override {
        fs::create_directory(file("own"));
        fs::create_directory(file("other"));
        writeText(file("other/t.obj"), kTriangle);
        writeText(file("own/t.obj"), kTriangle);
    }
    std::string loading(const std::string& meshFile, bool allowOutside = false) {
        writeText(file("own/a.json"), sceneOf(meshFile));
        return errorOf([&] { loadScene(file("own/a.json"), {allowOutside}); });
    }
};

TEST_F(SceneFolder, FilesOutsideAreRefused) {
    fs::create_directory(file("own/sub"));
    fs::create_symlink("../other", file("own/link"));
    fs::create_symlink("../other/t.obj", file("own/linked.obj"));
    for (const std::string& name :
         {std::string("../other/t.obj"), file("other/t.obj").string(), std::string("link/t.obj"),
          std::string("linked.obj"), std::string("sub/../../other/t.obj"), std::string("../gone.obj")}) {
        const std::string message = loading(name);
        EXPECT_HAS(message, "lies outside the scene's folder (--allow-outside") << name;
        EXPECT_HAS(message, "/meshes/m/file: ");
        if (name != "../gone.obj") {
            EXPECT_EQ(loading(name, true), "no error") << name;
        }
    }
}

TEST_F(SceneFolder, FilesWithinAreRead) {
    fs::create_symlink("t.obj", file("own/linked.obj"));
    fs::create_directory(file("own/sub"));
    for (const std::string& name :
         {std::string("t.obj"), std::string("./t.obj"), std::string("sub/../t.obj"),
          std::string("../own/t.obj"), std::string("linked.obj"), file("own/t.obj").string()})
        EXPECT_EQ(loading(name), "no error") << name;
}

// A model in a folder below may name files of the scene's folder: that is the border, not the model's.
TEST_F(SceneFolder, TheBorderIsThatOfTheScene) {
    fs::create_directory(file("own/models"));
    writeText(file("own/red.mtl"), "newmtl red\nKd 1 0 0\n");
    writeText(file("own/models/t.obj"), std::string("mtllib ../red.mtl\nusemtl red\n") + kTriangle);
    EXPECT_EQ(loading("models/t.obj"), "no error");
    EXPECT_HAS(loadScene(file("own/models/t.obj")).warnings.at(0), "lies outside");
}

TEST_F(SceneFolder, NamesThatAreNoFilesAreRefused) {
    EXPECT_HAS(loading("https://example.org/t.obj"), "URLs are not read");
    EXPECT_HAS(loading("t.obj\\u0000.png"), "no file name holds a zero byte");
    fs::create_symlink("loop.obj", file("own/loop.obj"));
    EXPECT_HAS(loading("loop.obj"), "cannot be read: ");
    EXPECT_HAS(loading(std::string(300, 'a') + ".obj"), "cannot be read: ");
}

TEST_F(SceneFolder, MaterialFilesAndPicturesToo) {
    writeText(file("other/red.mtl"), "newmtl red\nKd 1 0 0\n");
    writeText(file("own/t.obj"), std::string("mtllib ../other/red.mtl\n") + kTriangle);
    // A model is drawn without what may not be read, be it a name or a link that leads out.
    for (const char* name : {"../other/red.mtl", "/elsewhere/red.mtl"}) {
        writeText(file("own/t.obj"), "mtllib " + std::string(name) + "\n" + kTriangle);
        const Scene scene = loadScene(file("own/t.obj"));
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_HAS(scene.warnings[0], "lies outside");
        fs::create_symlink("../other/red.mtl", file("own/red.mtl"));
        EXPECT_HAS(loadScene(file("own/t.obj")).warnings.at(0), "lies outside");
        fs::remove(file("own/red.mtl"));
    }
    writeText(file("own/t.obj"), std::string("mtllib red.mtl\nusemtl red\n") + kTriangle);
    writeText(file("own/red.mtl"), "newmtl red\nKd 1 1 1\nmap_Kd /dev/zero\n");
    // A map that cannot be read is a warning, as always.
    writeText(file("own/a.json"), sceneOf("t.obj"));
    const Scene scene = loadScene(file("own/a.json"));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_HAS(scene.warnings[0], "lies outside");
    writeText(file("own/a.json"),
              R"({"materials": {"m": {"diffuse": {"texture": "../p.png"}}}, "objects": []})");
    EXPECT_HAS(errorOf([&] { loadScene(file("own/a.json")); }), "lies outside");
}

TEST_F(SceneFolder, AMeshUnderManyNamesIsReadOnce) {
    std::string names, objects;
    for (int i = 0; i < 2000; ++i) {
        const std::string n = std::to_string(i), comma = i > 0 ? "," : "";
        names += comma + "\"m" + n + "\": {\"file\": \"" + (i % 2 ? "./t.obj" : "t.obj") + "\"}";
        objects += comma + R"({"type": "mesh", "mesh": "m)" + n + "\"}";
    }
    writeText(file("own/a.json"), "{\"meshes\": {" + names + "}, \"objects\": [" + objects + "]}");
    const Scene scene = loadScene(file("own/a.json"));
    ASSERT_EQ(scene.objects.size(), 2000u);
    for (size_t i = 1; i < 2000; ++i) ASSERT_EQ(&meshOf(scene, i), &meshOf(scene, 0));
}

TEST_F(SceneFolder, AMaterialFileIsReadOnce) {
    std::string obj, mtl;
    for (int i = 0; i < 20000; ++i) obj += i % 2 ? "mtllib m.mtl\n" : "mtllib ./m.mtl\n";
    for (int i = 0; i < 4000; ++i) mtl += "newmtl a" + std::to_string(i) + "\nKd 1 1 1\n";
    writeText(file("own/t.obj"), obj + "usemtl a7\n" + kTriangle);
    writeText(file("own/m.mtl"), mtl);
    EXPECT_EQ(loadScene(file("own/t.obj")).materials.size(), 4000u);
}

// Each would be an image of its own: 200 materials in 7 KB made 20 GB of one of 2 KB.
TEST_F(SceneFolder, AMapWithItsCoverageIsMadeOnce) {
    writeImage(file("own/p.png"), Image(64, 64, 1));
    writeImage(file("own/q.png"), Image(8, 8, 1, 1.0f));
    std::string mtl;
    for (int i = 0; i < 50; ++i) mtl += "newmtl a" + std::to_string(i) + "\nmap_Kd p.png\nmap_d q.png\n";
    writeText(file("own/t.obj"), std::string("mtllib m.mtl\nusemtl a7\n") + kTriangle);
    writeText(file("own/m.mtl"), mtl);
    const Scene scene = loadScene(file("own/t.obj"));
    std::set<const Image*> images;
    for (const Material& material : scene.materials)
        images.insert(std::get<ImageTexture>(scene.textures.at(material.diffuseTexture).source).image.get());
    EXPECT_EQ(scene.materials.size(), 50u);
    EXPECT_EQ(images.size(), 1u);
    EXPECT_EQ((*images.begin())->channels, 4);
    // Enough for the map, 16 KiB, not for its 64 KiB with coverage.
    LoadOptions options;
    options.memory = 70'000;
    const std::string message = errorOf([&] { loadScene(file("own/t.obj"), options); });
    EXPECT_HAS(message, "m.mtl: its textures take more memory than there is");
}

TEST_F(SceneFolder, MemoryIsAskedFor) {
    writeText(file("own/big.bin"), std::string(10000, ' '));
    LoadOptions options;
    options.memory = 5000;
    SceneFiles little(file("own"), options);
    const std::string message = errorOf([&] { little.read(file("own/big.bin")); });
    EXPECT_HAS(message, "more than there is memory for");
    EXPECT_EQ(errorOf([&] { little.image(file("own/big.bin")); }), message);
    SceneFiles files(file("own"), {});
    files.read(file("own/big.bin"));
    files.take(uint64_t{256} << 20, "a");
    EXPECT_EQ(errorOf([&] { files.take(uint64_t{1} << 30, "a.gltf: /x"); }),
              "a.gltf: /x: the scene would take more than 258.4 MiB of memory, which is out of all "
              "proportion to its files of 0.0 MiB");
    SceneFiles rich(file("own"), {false, 1000});
    EXPECT_EQ(errorOf([&] { rich.take(1001, "a"); }),
              "a: the scene takes more memory than there is, 0.0 MiB");
    EXPECT_EQ(SceneFiles(file("own"), {false, 1600}).mostPixels(), 100u);
}

// From files.

class Load : public FolderTest {};

TEST_F(Load, FilesThatCannotBeRead) {
    for (const std::string name : {"gone.json", "gone/a.json", "gone.obj", "gone.ply", "gone.xyz"}) {
        const auto path = file(name);
        EXPECT_EQ(errorOf([&] { loadScene(path); }), path.string() + ": no such file");
    }
    std::filesystem::create_directory(file("folder.json"));
    const auto directory = file("folder.json");
    EXPECT_EQ(errorOf([&] { loadScene(directory); }), directory.string() + ": is a folder, not a file");
    for (const auto& folder : {folder_, file("folder.json/")})
        EXPECT_EQ(errorOf([&] { loadScene(folder); }), folder.string() + ": is a folder, not a file");
    for (const std::string kind : {"json", "gltf", "glb", "obj", "ply", "stl", "nff"}) {
        const auto path = write("empty." + kind, "");
        EXPECT_EQ(errorOf([&] { loadScene(path); }), path.string() + ": the file is empty");
    }
    const auto link = file("zero.json");
    std::filesystem::create_symlink("/dev/zero", link);
    EXPECT_EQ(errorOf([&] { loadScene(link); }), link.string() + ": is not a regular file");
}

TEST_F(Load, FilesWithoutPermission) {
    const auto path = write("secret.json", "{}");
    std::filesystem::permissions(path, std::filesystem::perms::none);
    withoutPrivileges(folder_, [&] {
        EXPECT_EQ(errorOf([&] { loadScene(path); }), path.string() + ": cannot be read: Permission denied");
    });
}

TEST_F(Load, UnknownKinds) {
    for (const std::string name : {"a.fbx", "a.txt", "a"}) {
        const auto path = write(name, "x");
        EXPECT_EQ(
            errorOf([&] { loadScene(path); }),
            path.string() +
                ": unknown kind of file (a scene is .json, .gltf, .glb or .nff, a model .obj, .ply or .stl)");
    }
}

TEST_F(Load, SceneFilesAreRelativeToThemselves) {
    std::filesystem::create_directory(file("models"));
    write("models/cube.obj", kCubeObj);
    const auto path = write(
        "scene.JSON",
        R"({"meshes": {"c": {"file": "models/cube.obj"}}, "objects": [{"type": "mesh", "mesh": "c"}]})");
    const Scene scene = loadScene(path);
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(meshOf(scene).corners.size(), 12u);
    EXPECT_TRUE(scene.lights.empty());  // a scene file says itself what lights it
}

TEST_F(Load, TheCameraOfAModelThatIsTooLargeIsNotBlamed) {
    for (const std::string far : {"1e39", "1e300"}) {
        const auto path = write("far.obj", "v " + far + " 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
        const std::string error = errorOf([&] { loadScene(path); });
        EXPECT_STARTS(error, path.string() + ": /objects/0: vertex 0 of the mesh: coordinates must be ");
    }
    // Each number may stand there, but what shows them all may not.
    const auto large = write("large.obj", "v 9e17 0 0\nv -9e17 1 0\nv 0 9e17 1\nf 1 2 3\n");
    EXPECT_EQ(errorOf([&] { loadScene(large); }),
              large.string() +
                  ": the model is too large or too far away for a camera in front of it (whose coordinates "
                  "must be below 1e+18, too)");
}

TEST_F(Load, TheFileOfAFaultyMeshIsNamed) {
    const auto path = write(
        "s.json", R"({"meshes": {"m": {"file": "far.obj"}}, "objects": [{"type": "mesh", "mesh": "m"}]})");
    const auto errorWith = [&](const std::string& vertex) {
        write("far.obj", "v 0 0 0\nv " + vertex + "\nv 0 0 1\nf 1 2 3\n");
        return errorOf([&] { loadScene(path); });
    };
    const std::string far = file("far.obj").string();
    EXPECT_EQ(errorWith("1e30 1 0"),
              far + ": vertex 1 (the first is 0): coordinates must be below 1e+18 (got [1e+30, 1, 0])");
    EXPECT_EQ(errorWith("1 1 0"), "no error");
}

TEST_F(Load, WhatIsNoMeshFileIsSaidOfTheScene) {
    const std::string text = write("a.txt", "x").string();
    const auto path = write("s.json", R"({"meshes": {"m": {"file": "a.txt"}},
  "objects": [{"type": "mesh", "mesh": "m"}]})");
    EXPECT_EQ(errorOf([&] { loadScene(path); }),
              path.string() + ": /meshes/m/file: " + text +
                  ": a mesh file must end in .obj, .ply, .stl, .gltf or .glb");
}

TEST_F(Load, WhatIsNoGlbIsNotTakenForJson) {
    const auto path = write("a.glb", "<!DOCTYPE html>");
    EXPECT_EQ(errorOf([&] { loadScene(path); }),
              path.string() + ": neither GLB, which starts with \"glTF\", nor glTF's JSON");
}

TEST_F(Load, AModelAloneGetsCameraLightAndMaterial) {
    const Scene scene = loadScene(write("cube.obj", kCubeObj));
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "/objects/0");
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, Color(0.8));
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.camera.target, glm::dvec3(0.5));
    EXPECT_EQ(scene.maxDepth, 5);
}

TEST_F(Load, AModelWithMaterialsKeepsThem) {
    write("c.mtl", "newmtl red\nKd 1 0 0\n");
    const Scene scene = loadScene(write("c.obj", std::string("mtllib c.mtl\nusemtl red\n") + kCubeObj));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, Color(1, 0, 0));
    EXPECT_EQ(meshOf(scene).materials, std::vector<uint32_t>(12, 0));
}

TEST_F(Load, WarningsOfModelsReachTheScene) {
    const auto path = write("c.obj", std::string(kCubeObj) + "f 1 1 1\n");
    EXPECT_EQ(loadScene(path).warnings,
              Lines{path.string() + ": 1 face with fewer than three different vertices left out"});
}

}  // namespace glint::test::scene_files_test
