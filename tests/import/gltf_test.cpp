// glTF 2.0: geometry, nodes, cameras, lights.
#include <cmath>
#include <numbers>

#include "gltf_maker.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::gltf_test {

using glm::dvec2;
using glm::dvec3;
using glm::uvec3;

Scene load(const std::string& bytes, const char* name = "a.gltf") {
    return OneFile(name).scene(bytes);
}

dvec3 apply(const Object& object, const dvec3& p) {
    const Affine t = object.transform.value_or(Affine{});
    return t.linear * p + t.offset;
}

// Six points in a row of zigzags, drawn with `mode` and `indices`.
Scene drawn(int mode, const std::vector<uint16_t>& indices = {}) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0}, "VEC3");
    std::string primitive = R"({"attributes": {"POSITION": 0}, "mode": )" + std::to_string(mode);
    if (!indices.empty())
        primitive += ", \"indices\": " + std::to_string(maker.add(indices, 5123, "SCALAR", indices.size()));
    return load(maker.text(R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [)" + primitive + "}]}]"));
}

TEST(Gltf, ATriangle) {
    const Scene scene = load(triangleGltf());
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "/nodes/0");
    EXPECT_FALSE(scene.objects[0].transform);
    const Mesh& mesh = meshOf(scene);
    EXPECT_EQ(mesh.positions, (std::vector<dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.corners, std::vector<uvec3>{uvec3(0, 1, 2)});
    EXPECT_TRUE(mesh.normalCorners.empty() && mesh.uvCorners.empty() && mesh.colorCorners.empty());
    EXPECT_EQ(scene.materials.at(0).diffuse, Color(0.8));
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.camera.target, dvec3(0.5, 0.5, 0));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Gltf, Modes) {
    EXPECT_EQ(meshOf(drawn(4)).corners, (std::vector<uvec3>{{0, 1, 2}, {3, 4, 5}}));
    EXPECT_EQ(meshOf(drawn(4, {5, 4, 3, 0, 1})).corners, std::vector<uvec3>{uvec3(5, 4, 3)});
    // A strip's second triangle runs the other way round, so that all face the same side.
    EXPECT_EQ(meshOf(drawn(5)).corners, (std::vector<uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}}));
    // Joined by a doubled corner; the fourth, an odd one, is turned.
    EXPECT_EQ(meshOf(drawn(5, {0, 1, 2, 2, 3, 4})).corners, (std::vector<uvec3>{{0, 1, 2}, {2, 4, 3}}));
    EXPECT_EQ(meshOf(drawn(6)).corners, (std::vector<uvec3>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}, {4, 5, 0}}));
}

TEST(Gltf, IndexTypes) {
    for (const int bytes : {1, 2, 4}) {
        GltfMaker maker;
        maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        size_t indices = 0;
        if (bytes == 1) indices = maker.add<uint8_t>({2, 0, 1}, 5121, "SCALAR", 3);
        if (bytes == 2) indices = maker.add<uint16_t>({2, 0, 1}, 5123, "SCALAR", 3);
        if (bytes == 4) indices = maker.add<uint32_t>({2, 0, 1}, 5125, "SCALAR", 3);
        const Scene scene = load(
            maker.binary(
                R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": )" +
                std::to_string(indices) + "}]}]"),
            "a.glb");
        EXPECT_EQ(meshOf(scene).corners, std::vector<uvec3>{uvec3(2, 0, 1)});
    }
}

TEST(Gltf, Attributes) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    // The normals lie four bytes apart.
    maker.addBytes(bytesOf<int8_t>({0, 0, 127, 9, 0, 0, -128, 9, 127, 0, 0, 9}), 5120, "VEC3", 3,
                   ", \"normalized\": true", ", \"byteStride\": 4");
    maker.add<uint8_t>({255, 0, 51, 255, 0, 255, 0, 255, 0, 0, 255, 128}, 5121, "VEC4", 3,
                       ", \"normalized\": true");
    const Scene scene = load(maker.text(
        R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1,
          "COLOR_0": 2}}]}])"));
    const Mesh& mesh = meshOf(scene);
    EXPECT_EQ(mesh.normals, (std::vector<dvec3>{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}}));
    EXPECT_EQ(mesh.normalCorners, std::vector<uvec3>{uvec3(0, 1, 2)});
    EXPECT_EQ(mesh.colors, (std::vector<Color>{{1, 0, 0.2}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_EQ(mesh.colorCorners, std::vector<uvec3>{uvec3(0, 1, 2)});
    EXPECT_EQ(scene.warnings, Lines{"the alpha of vertex colours (COLOR_0) is ignored"});
}

TEST(Gltf, SparseAccessors) {
    GltfMaker maker;
    const size_t base = maker.view(bytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    const size_t indices = maker.view(bytesOf<uint8_t>({1}));
    const size_t values = maker.view(bytesOf<float>({5, 6, 7}));
    const auto sparse = [&](const std::string& view) {
        return "{" + view + R"("componentType": 5126, "type": "VEC3", "count": 3, "sparse": {"count": 1,
          "indices": {"bufferView": )" +
               std::to_string(indices) + R"(, "componentType": 5121}, "values": {"bufferView": )" +
               std::to_string(values) + "}}}";
    };
    maker.accessor(sparse("\"bufferView\": " + std::to_string(base) + ", "));
    maker.accessor(sparse(""));  // of zeros
    const Scene scene = load(maker.text(
        R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}])"));
    EXPECT_EQ(meshOf(scene).positions, (std::vector<dvec3>{{0, 0, 0}, {5, 6, 7}, {0, 1, 0}}));
    EXPECT_EQ(meshOf(scene).normals, (std::vector<dvec3>{{0, 0, 0}, {5, 6, 7}, {0, 0, 0}}));
}

TEST(Gltf, NodesAreComposedInDouble) {
    const Scene scene = load(triangleGltf(
        "", R"(, "children": [1, 2], "translation": [10, 0, 0], "rotation": [0, 0, 0.7071068, 0.7071068],
          "scale": [2, 2, 2]}, {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,0,0,1]}, {"mesh": 0,
          "scale": [-1, 1, 1])"));
    ASSERT_EQ(scene.objects.size(), 3u);
    // (1,0,0): scaled to 2, turned to +y, moved by 10.
    expectNear(apply(scene.objects[0], {1, 0, 0}), {10, 2, 0});
    expectNear(apply(scene.objects[1], {1, 0, 0}), {10, 4, 0});
    expectNear(apply(scene.objects[2], {1, 0, 0}), {10, -2, 0});
    // One mesh, three places.
    EXPECT_EQ(&meshOf(scene, 0), &meshOf(scene, 1));
    EXPECT_EQ(&meshOf(scene, 0), &meshOf(scene, 2));
    // In float a millionth of a step would be lost beside ten million.
    const Scene far = load(triangleGltf(
        "", R"(, "translation": [1e7, 0, 0], "children": [1]}, {"mesh": 0, "translation": [1e-6, 0, 0])"));
    EXPECT_EQ(far.objects[1].transform->offset.x, 1e7 + 1e-6);
}

TEST(Gltf, OnlyTheDefaultSceneIsShown) {
    const std::string node = R"(}, {"mesh": 0, "translation": [5, 0, 0])";
    EXPECT_EQ(load(triangleGltf(R"("scenes": [{"nodes": [0, 1]}, {"nodes": [1]}])", node)).objects.size(),
              2u);
    const Scene second =
        load(triangleGltf(R"("scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}])", node));
    ASSERT_EQ(second.objects.size(), 1u);
    EXPECT_EQ(second.objects[0].name, "/nodes/1");
    EXPECT_EQ(second.warnings, Lines{"of 2 scenes only number 1 is shown"});
    EXPECT_EQ(load(triangleGltf("", node)).objects.size(), 2u);  // no scenes: all roots
}

TEST(Gltf, ANodeThatIsFlattenedToALineIsNotDrawn) {
    for (const char* scale : {"[0, 0, 0]", "[1, 0, 0]"}) {
        const Scene scene = load(triangleGltf("", std::string(R"(}, {"mesh": 0, "scale": )") + scale));
        EXPECT_EQ(scene.objects.size(), 1u);
        EXPECT_EQ(scene.warnings, Lines{"/nodes/1: flattened by its transform; not drawn"});
    }
}

// The specification leaves nodes out only if all three factors are 0.
TEST(Gltf, ANodeThatIsFlattenedToAPlaneIsDrawn) {
    const Scene scene = load(triangleGltf("", R"(, "scale": [2, 3, 0], "translation": [0, 0, 5])"));
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_FALSE(scene.objects[0].transform.has_value());
    EXPECT_EQ(meshOf(scene).positions, (std::vector<glm::dvec3>{{0, 0, 5}, {2, 0, 5}, {0, 3, 5}}));
    EXPECT_EQ(scene.warnings, Lines{});
}

TEST(Gltf, InstancesOfANode) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    maker.floats({0, 0, 0, 5, 0, 0}, "VEC3");
    maker.floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4");  // none, half a turn about z
    maker.floats({1, 1, 1, 2, 2, 2}, "VEC3");
    maker.floats({1, 1, 1}, "VEC3");
    const auto text = [&](const std::string& attributes) {
        return maker.text(R"("extensionsRequired": ["EXT_mesh_gpu_instancing"], "nodes": [{"mesh": 0,
            "translation": [0, 0, 1], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {)" +
                          attributes +
                          R"(}}}}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}])");
    };
    const Scene scene = load(text(R"("TRANSLATION": 1, "ROTATION": 2, "SCALE": 3)"));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[1].name, "/nodes/0/1");
    EXPECT_EQ(scene.objects[0].transform->offset, glm::dvec3(0, 0, 1));
    const Affine place = *scene.objects[1].transform;
    EXPECT_EQ(place.linear * glm::dvec3(1, 0, 0) + place.offset, glm::dvec3(3, 0, 1));
    EXPECT_EQ(&meshOf(scene, 0), &meshOf(scene, 1));
    const std::string message = errorOf([&] { load(text(R"("TRANSLATION": 1, "SCALE": 4)")); });
    EXPECT_HAS(message, "must have the same number of elements");
}

TEST(Gltf, VariantsShowTheirDefault) {
    EXPECT_EQ(load(triangleGltf(R"("extensionsRequired": ["KHR_materials_variants"],
        "extensionsUsed": ["KHR_materials_variants"])"))
                  .warnings,
              Lines{});
}

TEST(Gltf, PerspectiveCamera) {
    const Scene scene = load(triangleGltf(
        R"("cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 2, "znear": 0.1,
          "zfar": 50}}, {"type": "perspective", "name": "other", "perspective": {"yfov": 1, "znear": 1}}])",
        R"(, "children": [1, 2]}, {"camera": 0, "translation": [1, 2, 3],
          "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476], "scale": [3, 3, 3]}, {"camera": 1)"));
    const Camera& camera = scene.camera;
    EXPECT_EQ(camera.projection, Projection::Perspective);
    expectNear(camera.eye, {1, 2, 3});
    expectNear(camera.target, {0, 2, 3});  // -z turned by 90 degrees about y is -x
    expectNear(glm::normalize(camera.up), {0, 1, 0});
    EXPECT_NEAR(camera.fovY * std::numbers::pi / 180, 0.5, 1e-15);
    EXPECT_EQ(camera.nearT, 0.1);
    const dvec3 corner(2 * 50 * std::tan(0.25), 50 * std::tan(0.25), 50);
    EXPECT_NEAR(camera.farT, glm::length(corner), 1e-9);
    EXPECT_EQ(scene.image.height, 600);
    EXPECT_EQ(scene.image.width, 1200);
    EXPECT_EQ(scene.warnings, Lines{"has 2 cameras; the first is used, \"camera 0\""});
}

TEST(Gltf, OrthographicCamera) {
    const Scene scene = load(triangleGltf(
        R"("cameras": [{"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 4, "znear": 0.5,
          "zfar": 9}}])",
        R"(}, {"camera": 0, "translation": [0, 0, 3])"));
    EXPECT_EQ(scene.camera.projection, Projection::Orthographic);
    EXPECT_EQ(scene.camera.height, 8);
    EXPECT_EQ(scene.camera.target, dvec3(0, 0, 2));
    EXPECT_EQ(scene.camera.nearT, 0.5);
    EXPECT_EQ(scene.camera.farT, 9);
    EXPECT_EQ(scene.image.width, 300);
}

TEST(Gltf, Lights) {
    const std::string lights = R"("extensionsUsed": ["KHR_lights_punctual"], "extensions":
        {"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1, 0.5, 0], "intensity": 10, "range": 3},
        {"type": "directional"},
        {"type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}}]}})";
    const auto use = [](int light, const std::string& place) {
        return R"(}, {"extensions": {"KHR_lights_punctual": {"light": )" + std::to_string(light) + "}}, " +
               place;
    };
    const Scene scene = load(triangleGltf(lights, use(0, R"("translation": [1, 2, 3])") +
                                                      use(1, R"("rotation": [-1, 0, 0, 1])") +
                                                      use(2, R"("translation": [0, 0, 9])")));
    ASSERT_EQ(scene.lights.size(), 3u);
    const double pi = std::numbers::pi;
    const auto& point = std::get<PointLight>(scene.lights[0]);
    EXPECT_EQ(point.position, dvec3(1, 2, 3));
    expectNear(point.intensity, Color(10, 5, 0) / pi);
    EXPECT_EQ(point.falloff, Falloff::InverseSquare);
    const auto& sun = std::get<DirectionalLight>(scene.lights[1]);
    expectNear(glm::normalize(sun.direction), {0, -1, 0});  // -z turned by -90 degrees about x
    expectNear(sun.intensity, Color(1) / pi);
    const auto& spot = std::get<SpotLight>(scene.lights[2]);
    EXPECT_EQ(spot.direction, dvec3(0, 0, -1));
    EXPECT_NEAR(spot.angle, 0.25 * 180 / pi, 1e-12);
    EXPECT_NEAR(spot.penumbra, 0.25 * 180 / pi, 1e-12);
    EXPECT_EQ(spot.falloff, Falloff::InverseSquare);
    EXPECT_EQ(scene.ambient, Color(0));
    EXPECT_EQ(scene.warnings, Lines{"the range of lights is ignored: they fall off by the square"});
}

TEST(Gltf, WhatIsIgnoredIsNamedOnce) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const std::string morph = R"({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]})";
    const std::string points = R"({"attributes": {"POSITION": 0}, "mode": 0})";
    const Scene scene = load(maker.text(
        R"("nodes": [{"mesh": 0, "skin": 0}, {"mesh": 0, "skin": 0}], "skins": [{"joints": [0]}],
           "extensionsUsed": ["KHR_materials_sheen"], "animations": [{}],
           "meshes": [{"primitives": [)" +
        morph + ", " + morph + ", " + points + ", " + points + "]}]"));
    EXPECT_EQ(meshOf(scene).corners.size(), 2u);
    EXPECT_EQ(meshOf(scene).positions.size(), 3u);  // both primitives share them
    EXPECT_EQ(scene.warnings, (Lines{"the extension KHR_materials_sheen is ignored",
                                     "/animations/0: missing key \"samplers\"; nothing is animated",
                                     "skins are ignored: meshes stand as they were modelled",
                                     "morph targets are ignored", "points and lines are ignored"}));
}

TEST(Gltf, AMeshFileIsFlattenedIntoTheWorld) {
    const TemporaryFolder folder;
    const auto path = folder.write(
        "a.gltf", triangleGltf(R"("materials": [{"pbrMetallicRoughness": {"metallicFactor": 0,
          "baseColorFactor": [1, 0, 0, 1]}}])",
                               R"(, "translation": [0, 0, 1]}, {"mesh": 0, "scale": [-1, 1, 1])"));
    const ImportedMesh imported = importMesh(path);
    ASSERT_EQ(imported.mesh.corners.size(), 2u);
    EXPECT_EQ(imported.mesh.positions[imported.mesh.corners[0].y], dvec3(1, 0, 1));
    // The mirrored one turns its corners round, so that its front stays in front.
    EXPECT_EQ(imported.mesh.positions[imported.mesh.corners[1].y], dvec3(0, 1, 0));
    EXPECT_EQ(imported.mesh.positions[imported.mesh.corners[1].z], dvec3(-1, 0, 0));
    EXPECT_EQ(imported.mesh.materials, std::vector<uint32_t>(2, 0));
    EXPECT_EQ(imported.materials.at(0).diffuse, Color(1, 0, 0));
    const Scene scene = loadScene(folder.write(
        "s.json", R"({"meshes": {"t": {"file": "a.gltf"}}, "objects": [{"type": "mesh", "mesh": "t"}]})"));
    EXPECT_EQ(meshOf(scene).corners.size(), 2u);
    EXPECT_TRUE(scene.lights.empty());
}

// One mesh that many nodes show is copied for each of them.
TEST(Gltf, AMeshFileIsLimitedInMemory) {
    const TemporaryFolder folder;
    std::string nodes;
    for (int i = 0; i < 1000; ++i) nodes += R"(}, {"mesh": 0, "scale": [-1, 1, 1])";
    const auto path = folder.write("a.gltf", triangleGltf("", ", \"name\": \"a\"" + nodes));
    LoadOptions options;
    options.memory = 100'000;
    SceneFiles files(path.parent_path(), options);
    EXPECT_HAS(errorOf([&] { importMesh(path, files); }), "takes more memory than there is");
    EXPECT_EQ(importMesh(path).mesh.corners.size(), 1001u);
}

// The scene has its own lights and camera: materials reflect its ambient light.
TEST(Gltf, LightsAndCamerasOfAMeshFileAreIgnored) {
    const TemporaryFolder folder;
    const auto path = folder.write(
        "a.gltf",
        triangleGltf(R"("cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}],
          "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}})",
                     R"(, "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}})"));
    const ImportedMesh imported = importMesh(path),
                       dark = importMesh(folder.write("b.gltf", triangleGltf("")));
    EXPECT_NE(dark.materials.at(0).ambient, Color(0));
    EXPECT_EQ(imported.materials.at(0).ambient, dark.materials.at(0).ambient);
    EXPECT_EQ(imported.warnings, (Lines{path.string() + ": lights of a mesh are ignored",
                                        path.string() + ": cameras of a mesh are ignored"}));
    EXPECT_EQ(loadScene(path).materials.at(0).ambient, Color(0)) << "a file alone is lit by its lights";
}

}  // namespace glint::test::gltf_test
