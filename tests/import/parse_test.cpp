// Every key of a scene file, in and out.
#include "import/load.h"
#include "scene/sampling.h"
#include "scene/transform.h"
#include "support.h"

namespace glint::test::parse_test {

using glm::dvec3;

// docs/reference/scene-format.md; Schema.DefaultsAreTheParsersDefaults has the numbers.
TEST(Parse, EmptySceneHasTheDocumentedDefaults) {
    const Scene scene = parse("{}");
    EXPECT_EQ(scene.image, ImageSettings{});
    EXPECT_EQ(scene.camera, Camera{});
    EXPECT_EQ(scene.camera.target, dvec3(0));
    EXPECT_EQ(scene.camera.up, dvec3(0, 1, 0));
    EXPECT_EQ(scene.camera.farT, std::numeric_limits<double>::infinity());
    EXPECT_EQ(scene.background, Color(0));
    EXPECT_EQ(scene.ambient, Color(0));
    EXPECT_EQ(scene.maxDepth, 5);
    EXPECT_TRUE(scene.lights.empty() && scene.materials.empty() && scene.objects.empty());
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Parse, ImageCameraAndSurroundings) {
    const Scene scene = parse(R"({
        "$schema": "scene.schema.json",
        "image": {"width": 65536, "height": 1, "samplesPerPixel": 16},
        "camera": {"type": "perspective", "eye": [1, 2, 3], "target": [4, 5, 6], "up": [0, 0, 2], "fovY": 33.5,
                   "window": [-1, 2, -3, 4], "near": 0.5, "far": 100},
        "background": [0.2, 0.3, 0.5], "ambient": 0.25, "maxDepth": 0})");
    EXPECT_EQ(scene.image, (ImageSettings{.width = 65536, .height = 1, .samplesPerPixel = 16}));
    EXPECT_EQ(scene.camera, (Camera{.eye = {1, 2, 3},
                                    .target = {4, 5, 6},
                                    .up = {0, 0, 2},
                                    .planeNormal = {},
                                    .fovY = 33.5,
                                    .window = ViewWindow{-1, 2, -3, 4},
                                    .nearT = 0.5,
                                    .farT = 100}));
    EXPECT_EQ(scene.background, Color(0.2, 0.3, 0.5));
    EXPECT_EQ(scene.ambient, Color(0.25));
    EXPECT_EQ(scene.maxDepth, 0);
}

// docs/guide/sampling.md: the grid below 16 samples, the sequence from there on and for adaptive sampling.
TEST(Parse, SamplerUnlessOneIsNamed) {
    const auto samplerOfImage = [](const std::string& keys) {
        return samplerOf(parse("{\"image\": {" + keys + "}}").image);
    };
    EXPECT_EQ(parse("{}").image.sampler, Sampler::Auto);
    EXPECT_EQ(samplerOfImage(""), Sampler::Grid);
    EXPECT_EQ(samplerOfImage(R"("samplesPerPixel": 15)"), Sampler::Grid);
    EXPECT_EQ(samplerOfImage(R"("samplesPerPixel": 16)"), Sampler::LowDiscrepancy);
    EXPECT_EQ(samplerOfImage(R"("samplesPerPixel": 64, "sampler": "auto")"), Sampler::LowDiscrepancy);
    EXPECT_EQ(samplerOfImage(R"("samplesPerPixel": 64, "sampler": "grid")"), Sampler::Grid);
    EXPECT_EQ(samplerOfImage(R"("samplesPerPixel": 4, "sampler": "jittered")"), Sampler::Jittered);
    EXPECT_EQ(samplerOfImage(R"("samplesPerPixel": 4, "adaptive": {})"), Sampler::LowDiscrepancy);
}

TEST(Parse, OrthographicAndObliqueCameras) {
    const auto cameraOf = [](const std::string& keys) {
        return parse("{\"camera\": {" + keys + "}}").camera;
    };
    EXPECT_EQ(cameraOf(R"("type": "orthographic")"),
              (Camera{.projection = Projection::Orthographic, .planeNormal = {}, .window = {}}));
    EXPECT_EQ(cameraOf(R"("type": "orthographic", "eye": [1, 2, 3], "target": [4, 5, 6], "up": [0, 0, 2],
        "height": 2.5, "window": [-1, 2, -3, 4], "planeNormal": [0, 3, 1], "near": 0.5, "far": 7)"),
              (Camera{.projection = Projection::Orthographic,
                      .eye = {1, 2, 3},
                      .target = {4, 5, 6},
                      .up = {0, 0, 2},
                      .planeNormal = dvec3(0, 3, 1),
                      .height = 2.5,
                      .window = ViewWindow{-1, 2, -3, 4},
                      .nearT = 0.5,
                      .farT = 7}));
    EXPECT_EQ(cameraOf(R"("planeNormal": [0, 0, -1], "fovY": 60)"),
              (Camera{.planeNormal = dvec3(0, 0, -1), .fovY = 60, .window = {}}));
}

TEST(Parse, WholeNumbersMayBeWrittenAsFloats) {
    EXPECT_EQ(parse(R"({"image": {"width": 8e2, "height": 600.0}})").image.width, 800);
}

TEST(Parse, Lights) {
    const Scene scene = parse(R"({"lights": [
        {"type": "point", "position": [2, 5, 3]},
        {"type": "point", "position": [0, 0, 0], "intensity": [1, 2, 3], "falloff": "inverseSquare"},
        {"type": "point", "position": [0, 0, 0], "falloff": "none"},
        {"type": "directional", "direction": [0, -2, 0], "intensity": 0.5},
        {"type": "spot", "position": [1, 2, 3], "direction": [0, -2, 1], "angle": 30},
        {"type": "spot", "position": [0, 0, 0], "direction": [1, 0, 0], "angle": 0, "penumbra": 12.5,
         "intensity": [1, 2, 3], "falloff": "inverseSquare"}]})");
    const std::vector<Light> expected = {
        PointLight{{2, 5, 3}, Color(1), Falloff::None},
        PointLight{dvec3(0), {1, 2, 3}, Falloff::InverseSquare},
        PointLight{dvec3(0), Color(1), Falloff::None},
        DirectionalLight{{0, -2, 0}, Color(0.5)},
        SpotLight{{1, 2, 3}, {0, -2, 1}, 30, 0, Color(1), Falloff::None},
        SpotLight{dvec3(0), {1, 0, 0}, 0, 12.5, {1, 2, 3}, Falloff::InverseSquare}};
    EXPECT_EQ(scene.lights, expected);
}

TEST(Parse, MaterialsKeepFileOrderAndAmbientFollowsDiffuse) {
    const Scene scene = parse(R"({"materials": {
        "z": {"diffuse": [0.8, 0, 0]},
        "a": {"ambient": [1, 0, 0], "diffuse": 0.5, "specular": 0.25, "shininess": 60, "mirror": [0.9, 0.8, 0.7]},
        "m": {}}})");
    const std::vector<Material> expected = {{.name = "z", .ambient = {0.8, 0, 0}, .diffuse = {0.8, 0, 0}},
                                            {.name = "a",
                                             .ambient = {1, 0, 0},
                                             .diffuse = Color(0.5),
                                             .specular = Color(0.25),
                                             .shininess = 60,
                                             .mirror = {0.9, 0.8, 0.7}},
                                            {.name = "m",
                                             .ambient = Color(0.8),
                                             .diffuse = Color(0.8),
                                             .specular = Color(0),
                                             .shininess = 32,
                                             .mirror = Color(0)}};
    EXPECT_EQ(scene.materials, expected);
}

TEST(Parse, Objects) {
    const Scene scene = parse(R"({"materials": {"red": {}, "blue": {}}, "objects": [
        {"type": "sphere", "center": [1, 2, 3], "radius": 4, "material": "blue"},
        {"type": "plane", "point": [0, -1, 0], "normal": [0, 3, 0], "material": "red"},
        {"type": "triangle", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]},
        {"type": "sphere", "center": [0, 0, 0], "radius": 1},
        {"type": "disc", "center": [1, 2, 3], "normal": [0, 0, 4], "radius": 5, "material": "blue"},
        {"type": "polygon", "vertices": [[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 1, 0]]},
        {"type": "box", "min": [1, 2, 3], "max": [4, 5, 6], "material": "red"}]})");
    const std::vector<Object> expected = {
        {"/objects/0", SphereShape{{1, 2, 3}, 4}, 1},
        {"/objects/1", PlaneShape{{0, -1, 0}, {0, 3, 0}}, 0},
        {"/objects/2", TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 2},
        {"/objects/3", SphereShape{{0, 0, 0}, 1}, 2},
        {"/objects/4", DiscShape{{1, 2, 3}, {0, 0, 4}, 5}, 1},
        {"/objects/5", PolygonShape{{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 1, 0}}}, 2},
        {"/objects/6", BoxShape{{1, 2, 3}, {4, 5, 6}}, 0}};
    EXPECT_EQ(scene.objects, expected);
    // The objects without a material share one grey material behind the scene's own.
    ASSERT_EQ(scene.materials.size(), 3u);
    EXPECT_EQ(scene.materials[2].name, "default");
    EXPECT_EQ(scene.materials[2].diffuse, Color(0.8));
}

TEST(Parse, QuadricsOfEveryForm) {
    const Scene scene = parse(R"({"objects": [
        {"type": "quadric", "coefficients": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], "bounds": [[-1, -2, -3], [1, 2, 3]]},
        {"type": "ellipsoid", "center": [1, 2, 3], "radii": [4, 5, 6]},
        {"type": "cylinder", "base": [0, 0, 1], "top": [0, 0, 2], "radius": 3},
        {"type": "cone", "base": [0, 0, 1], "apex": [0, 0, 2], "radius": 3, "topRadius": 1, "capped": true},
        {"type": "hyperboloid", "base": [0, 0, 1], "top": [0, 0, 2], "radius": 3, "waist": 2, "capped": false},
        {"type": "paraboloid", "vertex": [0, 0, 1], "top": [0, 0, 2], "radius": 3, "capped": true}]})");
    const std::vector<Shape> expected = {
        QuadricShape{{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, {-1, -2, -3}, {1, 2, 3}},
        EllipsoidShape{{1, 2, 3}, {4, 5, 6}},
        CylinderShape{{0, 0, 1}, {0, 0, 2}, 3, false},
        ConeShape{{0, 0, 1}, {0, 0, 2}, 3, 1, true},
        HyperboloidShape{{0, 0, 1}, {0, 0, 2}, 3, 2, false},
        ParaboloidShape{{0, 0, 1}, {0, 0, 2}, 3, true}};
    EXPECT_EQ(shapesOf(scene), expected);
}

// Boxes and quadrics keep transforms that make no other box of them; Placement has the shapes that stay
// round.
TEST(Parse, TransformsReachTheShapesOrStayWithThem) {
    const Scene scene = parse(R"({"objects": [
        {"type": "sphere", "center": [1, 0, 0], "radius": 1,
         "transform": [{"scale": 2}, {"rotate": [0, 0, 1, 90]}, {"translate": [0, 0, -3]}]},
        {"type": "plane", "point": [0, 1, 0], "normal": [0, 1, 0], "transform": [{"rotate": [0, 0, 5, 90]}]},
        {"type": "triangle", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
         "transform": [1, 0.5, 0, 3,  0, 1, 0, 0,  0, 0, 2, 4,  0, 0, 0, 1]},
        {"type": "sphere", "center": [1, 0, 0], "radius": 1, "transform": []},
        {"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "transform": [{"scale": [2, 3, 4]}, {"translate": [1, 0, 0]}]},
        {"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "transform": [{"rotate": [0, 1, 0, 30]}]},
        {"type": "cylinder", "base": [0, 0, 1], "top": [0, 0, 2], "radius": 3, "transform": [{"translate": [5, 0, 0]}]}]})");
    // By hand: (1,0,0) * 2 = (2,0,0), a quarter turn about z gives (0,2,0), then z - 3.
    const std::vector<Shape> expected = {SphereShape{{0, 2, -3}, 2},
                                         PlaneShape{{-1, 0, 0}, {-1, 0, 0}},
                                         TriangleShape{{{3, 0, 4}, {4, 0, 4}, {3.5, 1, 4}}},
                                         SphereShape{{1, 0, 0}, 1},
                                         BoxShape{{1, 0, 0}, {3, 3, 4}},
                                         BoxShape{{0, 0, 0}, {1, 1, 1}},
                                         CylinderShape{{0, 0, 1}, {0, 0, 2}, 3, false}};
    EXPECT_EQ(shapesOf(scene), expected);
    for (size_t i = 0; i < 7; i++) EXPECT_EQ(scene.objects[i].transform.has_value(), i > 4) << i;
    EXPECT_EQ(scene.objects[6].transform->offset, dvec3(5, 0, 0));
}

TEST(Parse, AMeshIsSharedUntilItIsTransformed) {
    const TemporaryFolder folder;
    folder.write("cube.obj", kCubeObj);
    const Scene scene =
        parseScene(R"({"materials": {"red": {}}, "meshes": {"cube": {"file": "cube.obj"}}, "objects": [
        {"type": "mesh", "mesh": "cube"},
        {"type": "mesh", "mesh": "cube", "material": "red"},
        {"type": "mesh", "mesh": "cube", "transform": []},
        {"type": "mesh", "mesh": "cube", "transform": [{"scale": 2}]}]})",
                   "s.json", folder.path());
    ASSERT_EQ(scene.objects.size(), 4u);
    const Mesh* mesh = &meshOf(scene, 0);
    EXPECT_EQ(mesh->corners.size(), 12u);
    EXPECT_EQ(&meshOf(scene, 1), mesh);
    EXPECT_EQ(&meshOf(scene, 2), mesh);
    const Mesh* scaled = &meshOf(scene, 3);
    EXPECT_NE(scaled, mesh);
    EXPECT_EQ(mesh->positions[6], dvec3(1, 1, 1));
    EXPECT_EQ(scaled->positions[6], dvec3(2, 2, 2));
    EXPECT_EQ(scene.materials[scene.objects[0].material].name, "default");
    EXPECT_EQ(scene.materials[scene.objects[1].material].name, "red");
}

TEST(Parse, MeshMaterialsJoinTheScenesUnlessTheObjectNamesOne) {
    const TemporaryFolder folder;
    folder.write("two.mtl", "newmtl one\nKd 1 0 0\nnewmtl two\nKd 0 1 0\n");
    folder.write("two.obj",
                 "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl two\nf 1 2 3\nusemtl one\nf 3 2 1\n");
    const Scene scene =
        parseScene(R"({"materials": {"grey": {}}, "meshes": {"m": {"file": "two.obj"}}, "objects": [
        {"type": "mesh", "mesh": "m"}, {"type": "mesh", "mesh": "m", "material": "grey"}, {"type": "mesh", "mesh": "m"}]})",
                   "s.json", folder.path());
    ASSERT_EQ(scene.materials.size(), 3u);  // the file's are added once
    EXPECT_EQ(scene.materials[1].name, "one");
    EXPECT_EQ(scene.materials[2].name, "two");
    EXPECT_EQ(meshOf(scene, 0).materials, (std::vector<uint32_t>{2, 1}));
    EXPECT_TRUE(meshOf(scene, 1).materials.empty());
    EXPECT_EQ(scene.objects[1].material, 0u);
    EXPECT_EQ(&meshOf(scene, 2), &meshOf(scene, 0));
}

TEST(Parse, UnusedMeshesAreNotLoadedButSaid) {
    const Scene scene = parse(R"({"meshes": {"a/b": {"file": "there-is-no-such-file.obj"}}})");
    EXPECT_EQ(scene.warnings, Lines{"s.json: /meshes/a~1b: no object uses this mesh"});
}

}  // namespace glint::test::parse_test
