// NFF (E. Haines, version 3.9).
#include <cmath>
#include <numbers>

#include "import/load.h"
#include "support.h"

namespace glint::test::nff_test {

using glm::dvec3;

const std::string kView = "v\nfrom 0 -4 1\nat 0 0 0.5\nup 0 0 1\nangle 45\nhither 0.5\nresolution 513 513\n";

Scene load(const std::string& text) {
    return OneFile("a.nff").scene(text);
}

std::string error(const std::string& text) {
    return OneFile("a.nff").error(text);
}

TEST(Nff, View) {
    const Scene scene = load(kView + "b 0.1 0.2 0.3\ns 0 0 0 1\n");
    EXPECT_EQ(scene.camera.eye, dvec3(0, -4, 1));
    EXPECT_EQ(scene.camera.target, dvec3(0, 0, 0.5));
    EXPECT_EQ(scene.camera.up, dvec3(0, 0, 1));
    EXPECT_EQ(scene.camera.nearT, 0.5);
    EXPECT_EQ(scene.image.width, 513);
    EXPECT_EQ(scene.image.height, 513);
    EXPECT_EQ(scene.background, Color(0.1, 0.2, 0.3));
    // The centres of the first and the last of 513 rows are 512 rows apart, and see each other at 45 degrees.
    const double halfRow = std::tan(scene.camera.fovY * std::numbers::pi / 360) / 513;
    EXPECT_NEAR(std::atan(512 * halfRow) * 360 / std::numbers::pi, 45, 1e-12);
    EXPECT_EQ(scene.maxDepth, 4);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Nff, WhatIsMissingIsMade) {
    const Scene scene = load("s 3 4 5 1\n");
    EXPECT_EQ(scene.camera.target, dvec3(3, 4, 5));
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.ambient, Color(0.2));
    EXPECT_EQ(scene.background, Color(0));  // "If no background color is set, assume RGB = {0,0,0}."
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, Color(0.8));
}

// sqrt(n) / (2n) for each light and the ambient component.
TEST(Nff, LightsWithoutAColorShareIntensity) {
    const Scene one = load("l 1 2 3\ns 0 0 0 1\n");
    EXPECT_EQ(std::get<PointLight>(one.lights.at(0)).position, dvec3(1, 2, 3));
    EXPECT_EQ(std::get<PointLight>(one.lights[0]).intensity, Color(0.5));
    EXPECT_EQ(std::get<PointLight>(one.lights[0]).falloff, Falloff::None);
    EXPECT_EQ(one.ambient, Color(0.5));
    const Scene four = load("l 1 2 3\nl 0 0 9 # a comment\nl 1 1 1 0.5 0.25 2\nl 4 4 4\ns 0 0 0 1\n");
    ASSERT_EQ(four.lights.size(), 4u);
    EXPECT_EQ(std::get<PointLight>(four.lights[1]).intensity, Color(0.25));
    EXPECT_EQ(std::get<PointLight>(four.lights[2]).intensity, Color(0.5, 0.25, 2));
    EXPECT_EQ(four.ambient, Color(0.25));
}

TEST(Nff, Fills) {
    const Scene scene = load(
        "f 1 0.5 0.25 0.8 0.3 10 0 0\ns 0 0 0 1\nf 1 1 1 0.1 0.1 100 0.9 1.5\ns 3 0 0 1\n"
        "f 1 0.5 0.25 0.8 0.3 10 0 0\ns 6 0 0 1\nf 1 1 1 1 0.5 0 0 1\ns 9 0 0 1\n");
    ASSERT_EQ(scene.materials.size(), 3u);  // the third is the first again
    const Material& red = scene.materials[0];
    EXPECT_EQ(red.diffuse, Color(0.8, 0.4, 0.2));
    EXPECT_EQ(red.ambient, red.diffuse);
    EXPECT_EQ(red.specular, Color(0.3));
    EXPECT_EQ(red.mirror, Color(0.3));
    EXPECT_EQ(red.transmission, Color(0));
    // At 5 degrees from the mirror direction Phong's highlight and Blinn's, whose angle is half of it, agree.
    const double phong = std::pow(std::cos(5 * std::numbers::pi / 180), 10);
    EXPECT_NEAR(std::pow(std::cos(2.5 * std::numbers::pi / 180), red.shininess), phong, 1e-3 * phong);
    const Material& glass = scene.materials[1];
    EXPECT_EQ(glass.transmission, Color(0.9));
    EXPECT_EQ(glass.ior, 1.5);
    EXPECT_EQ(glass.mirror, Color(0));
    EXPECT_EQ(glass.specular, Color(0.1));
    EXPECT_EQ(scene.materials[2].specular, Color(0));  // Shine 0: no highlight
    EXPECT_EQ(scene.objects[0].material, 0u);
    EXPECT_EQ(scene.objects[1].material, 1u);
    EXPECT_EQ(scene.objects[2].material, 0u);
    EXPECT_EQ(scene.objects[3].material, 2u);
}

TEST(Nff, SpheresAndPolygons) {
    const Scene scene = load(
        "s 1 2 3 4\np 3\n0 0 0\n1 0 0\n0 1 0\np 4 0 0 0 2 0 0 2 1 0 0 1 0 # one line\n"
        "p 5 0 0 0 2 0 0 2 2 0 1 1 0 0 2 0\n");
    const std::vector<Object> expected = {
        {"line 1", SphereShape{{1, 2, 3}, 4}},
        {"line 2", TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        {"line 6", PolygonShape{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}}},
        {"line 7", PolygonShape{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 1, 0}, {0, 2, 0}}}}};
    EXPECT_EQ(scene.objects, expected);
}

TEST(Nff, ConesAndCylinders) {
    const Scene scene = load(
        "c 0 0 0 2\n0 0 3 1\nc 0 0 0 2 0 0 3 2\nc 0 0 0 1 0 0 3 2\nc 0 0 0 -2 0 0 3 -2\n"
        "c\n0 0 0 2 # tapers to a point\n0 0 3 0\n");
    // "The surface exists without endcaps." The wider end of the third is its base.
    const std::vector<Shape> expected = {
        ConeShape{{0, 0, 0}, {0, 0, 3}, 2, 1, false}, CylinderShape{{0, 0, 0}, {0, 0, 3}, 2, false},
        ConeShape{{0, 0, 3}, {0, 0, 0}, 2, 1, false}, CylinderShape{{0, 0, 0}, {0, 0, 3}, 2, false},
        ConeShape{{0, 0, 0}, {0, 0, 3}, 2, 0, false}};
    EXPECT_EQ(shapesOf(scene), expected);
    EXPECT_EQ(scene.warnings, Lines{"1 surface with a negative radius, seen from outside too"});
}

TEST(Nff, PatchesThatFollowEachOtherAreOneMesh) {
    const std::string patch = "pp 3\n0 0 0 0 0 1\n1 0 0 1 0 1\n0 1 0 0 1 1\n";
    const Scene scene =
        load(patch + "pp 4 1 0 0 0 0 1 2 0 0 0 0 1 2 1 0 0 0 1 1 1 0 0 0 1\n" + "s 9 9 9 1\n" + patch);
    ASSERT_EQ(scene.objects.size(), 3u);
    const Mesh& mesh = meshOf(scene);
    ASSERT_EQ(mesh.corners.size(), 3u);
    EXPECT_EQ(mesh.faces, (std::vector<uint32_t>{0, 1, 1}));
    ASSERT_EQ(mesh.normalCorners.size(), 3u);
    EXPECT_EQ(mesh.normals[mesh.normalCorners[0].y], dvec3(1, 0, 1));
    EXPECT_EQ(meshOf(scene, 2).corners.size(), 1u);
}

TEST(Nff, WhatIsWarnedAbout) {
    EXPECT_EQ(load("s 0 0 0 -2\n").warnings,
              Lines{"1 surface with a negative radius, seen from outside too"});
    EXPECT_EQ(std::get<SphereShape>(load("s 0 0 0 -2\n").objects[0].shape).radius, 2);
    EXPECT_EQ(load("s 0 0 0 1\np 3 0 0 0 1 1 1 2 2 2\npp 3 0 0 0 0 0 1 0 0 0 0 0 1 1 0 0 0 0 1\n").warnings,
              Lines{"2 polygons without area left out"});
    const std::string bent = "p 4 0 0 0 1 0 0 1 1 0.5 0 1 0\n";
    EXPECT_EQ(load(bent).warnings, Lines{"1 polygon not planar, split into triangles"});
    EXPECT_EQ(meshOf(load(bent)).corners.size(), 2u);
    EXPECT_EQ(load("v from 0 -4 1 at 0 0 0 up 0 0 1 angle 45 resolution 400 300 s 0 0 0 1").warnings.size(),
              1u);
}

TEST(Nff, Errors) {
    EXPECT_EQ(error("# nothing\n"), ":1: the file holds no objects");
    EXPECT_EQ(error("s 0 0 0 1\nq 1 2\n"), ":2: \"q\" is no entity of NFF (v, b, l, f, c, s, p, pp)");
    EXPECT_EQ(error("from 0 0 0\n"), ":1: \"from\" must follow \"v\"");
    EXPECT_EQ(error("s 0 0 0"), ":1: the file ends within a sphere");
    EXPECT_EQ(error("s 0 0 0 0\n"), ":1: the radius of a sphere must not be 0");
    EXPECT_EQ(error("s 0 0 0 nan\n"), ":1: a sphere has a number that is not finite");
    EXPECT_EQ(error("s 0 0 zero 1\n"), ":1: \"zero\" is not a number (a sphere needs one)");
    EXPECT_EQ(error("p 2\n0 0 0\n1 0 0\n"), ":1: a polygon must have from 3 to 10000 vertices");
    EXPECT_EQ(error("p 99999999999\n0 0 0\n"), ":1: a polygon must have from 3 to 10000 vertices");
    EXPECT_EQ(error("pp 3.5\n0 0 0\n"), ":1: a patch must have from 3 to 10000 vertices");
    EXPECT_EQ(error("c 0 0 0 1 0 0 0 2\n"), ":1: base and apex of a cone must differ");
    EXPECT_EQ(error("c 0 0 0 1\n0 0 1 -1\n"), ":2: the radii of a cone have different signs");
    EXPECT_EQ(error("c 0 0 0 0 0 0 1 0\n"), ":1: both radii of a cone are 0");
    EXPECT_EQ(error("f 1 1 1 -1 0 1 0 1\n"), ":1: a fill has a negative number");
    EXPECT_EQ(error("f 1 1 1 1 0 1 1.5 1\n"), ":1: the transmittance T of a fill must be from 0 to 1");
    EXPECT_EQ(error("f 1 1 1 1 0 1 0.5 0\n"), ":1: the index of refraction of a fill with T > 0 must be > 0");
    EXPECT_EQ(error("b 1 -1 0\n"), ":1: a background has a negative colour");
    EXPECT_EQ(error("v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\ns 0 0 0 1\n"),
              ":6: the view (v) lacks \"resolution\"");
    EXPECT_EQ(error("v\nangle 180\n"), ":2: angle must be between 0 and 180 degrees");
    EXPECT_EQ(error("v\nresolution 0 5\n"), ":2: resolution must be whole numbers from 1 to 65536");
    EXPECT_EQ(error("v from 0 0 5 at 0 0 0 up 0 0 1 angle 45 resolution 9 9 s 0 0 0 1"),
              ": camera/up: must not be parallel to the view direction [0, 0, -5] (got [0, 0, 1])");
    EXPECT_EQ(error("s 0 0 0 1e30\n"), ": line 1/radius: must be from 1e-14 to 1e+18 (got 1e+30)");
}

}  // namespace glint::test::nff_test
