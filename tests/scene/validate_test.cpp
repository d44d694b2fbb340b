// Scenes built by hand, as by users of the library: validateScene must find what a parser would refuse.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "scene/polygon_plane.h"
#include "scene/validate.h"
#include "support/support.h"

namespace glint::test::validate_test {

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();

std::shared_ptr<Mesh> triangleMesh() {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh->corners = {{0, 1, 2}};
    return mesh;
}

Scene validScene() {
    Scene scene;
    scene.materials.emplace_back().name = "grey";
    scene.lights = {PointLight{}, DirectionalLight{}, SpotLight{}};
    scene.objects = {{"/objects/0", SphereShape{}, 0},
                     {"/objects/1", PlaneShape{}, 0},
                     {"/objects/2", TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 0},
                     {"/objects/3", MeshShape{triangleMesh()}, 0},
                     {"/objects/4", DiscShape{}, 0}};
    return scene;
}

template <typename Change>
std::string errorAfter(const Change& change) {
    Scene scene = validScene();
    change(scene);
    return errorOf(ErrorKind::Scene, [&] { validateScene(scene, "s"); });
}

template <typename T>
T& shape(Scene& scene, size_t object) {
    return std::get<T>(scene.objects[object].shape);
}
template <typename T>
T& light(Scene& scene, size_t index) {
    return std::get<T>(scene.lights[index]);
}

TEST(Validate, AcceptsTheEndsOfTheRanges) {
    EXPECT_EQ(errorAfter([](Scene& s) {
                  s.image.width = s.image.samplesPerPixel = 65536;
                  s.image.height = 1;
                  s.maxDepth = 1000;
                  s.materials[0].shininess = 0;
                  s.materials[0].mirror = Color(1);
                  s.materials[0].diffuse = Color(0);
                  shape<SphereShape>(s, 0) = {{-9.9e17, 0, 0}, 1e-14};
                  s.camera.fovY = 179.9;
                  light<DirectionalLight>(s, 1).direction = {0, 0, 1e-18};
                  light<SpotLight>(s, 2).angle = 180;
              }),
              "no error");
    EXPECT_EQ(errorAfter([](Scene& s) { shape<SphereShape>(s, 0).radius = 1e18; }), "no error");
    EXPECT_EQ(errorAfter([](Scene& s) {
                  s.camera.projection = Projection::Orthographic;
                  s.camera.height = 1e-18;
                  s.camera.fovY = 500;  // not used
                  light<SpotLight>(s, 2).angle = 0;
                  light<SpotLight>(s, 2).penumbra = 0.001;
              }),
              "no error");
    EXPECT_EQ(errorAfter([](Scene& s) { s.objects.clear(); }), "no error");
}

TEST(Validate, NumbersThatAreNotFinite) {
    const std::pair<void (*)(Scene&), std::string> cases[] = {
        {[](Scene& s) { s.camera.eye.x = kNan; }, "/camera/eye: must be finite (got [nan, 0, 5])"},
        {[](Scene& s) { s.camera.up.y = kInf; }, "/camera/up: must be finite (got [0, inf, 0])"},
        {[](Scene& s) { s.camera.fovY = kNan; }, "/camera/fovY: must be between 0 and 180 degrees (got nan)"},
        {[](Scene& s) { s.camera.nearT = kNan; }, "/camera/near: must be >= 0 and finite (got nan)"},
        {[](Scene& s) { s.camera.farT = kNan; }, "/camera/far: must be greater than near, 0 (got nan)"},
        {[](Scene& s) {
             s.camera.window = ViewWindow{-1, kNan, -1, 1};
         },
         "/camera/window: edges must be finite and below 1e+18 (got nan)"},
        {[](Scene& s) { s.background.y = kNan; }, "/background: must be finite (got [0, nan, 0])"},
        {[](Scene& s) { s.ambient = Color(kInf); }, "/ambient: must be finite (got inf)"},
        {[](Scene& s) { light<PointLight>(s, 0).position.z = kNan; },
         "/lights/0/position: must be finite (got [0, 0, nan])"},
        {[](Scene& s) { light<DirectionalLight>(s, 1).intensity.x = kNan; },
         "/lights/1/intensity: must be finite (got [nan, 1, 1])"},
        {[](Scene& s) { s.camera.planeNormal = glm::dvec3(0, kInf, 1); },
         "/camera/planeNormal: must be finite (got [0, inf, 1])"},
        {[](Scene& s) {
             s.camera.projection = Projection::Orthographic;
             s.camera.height = kNan;
         },
         "/camera/height: must be > 0 (got nan)"},
        {[](Scene& s) { light<SpotLight>(s, 2).position.x = kInf; },
         "/lights/2/position: must be finite (got [inf, 0, 0])"},
        {[](Scene& s) { light<SpotLight>(s, 2).angle = kNan; },
         "/lights/2/angle: must be from 0 to 180 degrees (got nan)"},
        {[](Scene& s) { light<SpotLight>(s, 2).penumbra = kNan; },
         "/lights/2/penumbra: must be >= 0 degrees (got nan)"},
        {[](Scene& s) { s.materials[0].shininess = kNan; },
         "/materials/grey/shininess: must be from 0 to 1e+18 (got nan)"},
        {[](Scene& s) { shape<SphereShape>(s, 0).radius = kNan; },
         "/objects/0/radius: must be > 0 (got nan)"},
        {[](Scene& s) { shape<SphereShape>(s, 0).radius = kInf; },
         "/objects/0/radius: must be from 1e-14 to 1e+18 (got inf)"},
        {[](Scene& s) { shape<PlaneShape>(s, 1).normal = glm::dvec3(kNan, 0, 0); },
         "/objects/1/normal: must be finite (got [nan, 0, 0])"},
        {[](Scene& s) { shape<TriangleShape>(s, 2).vertices[1].x = kNan; },
         "/objects/2/vertices/1: must be finite (got [nan, 0, 0])"},
        {[](Scene& s) { shape<DiscShape>(s, 4).radius = kNan; }, "/objects/4/radius: must be > 0 (got nan)"},
        {[](Scene& s) { shape<DiscShape>(s, 4).normal.z = kInf; },
         "/objects/4/normal: must be finite (got [0, 1, inf])"},
    };
    for (const auto& [change, message] : cases) EXPECT_EQ(errorAfter(change), "s: " + message);
}

TEST(Validate, Polygons) {
    const auto withPolygon = [](std::vector<glm::dvec3> vertices) {
        return errorAfter([&](Scene& s) { s.objects[0].shape = PolygonShape{std::move(vertices)}; });
    };
    EXPECT_EQ(withPolygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, kNan, 0}}),
              "s: /objects/0/vertices/3: must be finite (got [0.5, nan, 0])");
    EXPECT_EQ(withPolygon({}), "s: /objects/0/vertices: must have three distinct points or more (got 0)");
    std::vector<glm::dvec3> ring;
    for (int i = 0; i < 8192; ++i) ring.emplace_back(std::cos(i / 1304.0), std::sin(i / 1304.0), 7);
    EXPECT_EQ(withPolygon(ring), "no error");
    ring.emplace_back(0, 0, 7);
    EXPECT_EQ(withPolygon(ring),
              "s: /objects/0/vertices: must be at most 8192 points (got 8193); faces of a mesh are split "
              "into triangles and may have more");
}

TEST(Validate, CameraGeometry) {
    EXPECT_EQ(errorAfter([](Scene& s) { s.camera.up = glm::dvec3(0, 0, 0); }),
              "s: /camera/up: must not be zero (got [0, 0, 0])");
    EXPECT_EQ(errorAfter([](Scene& s) { s.camera.up = glm::dvec3(1e-10, 0, -1); }),
              "s: /camera/up: must not be parallel to the view direction [0, 0, -5] (got [1e-10, 0, -1])");
    EXPECT_EQ(errorAfter([](Scene& s) { s.camera.up = glm::dvec3(1e-6, 0, -1); }), "no error");
    EXPECT_EQ(errorAfter([](Scene& s) { s.camera.up = glm::dvec3(0, 1e-18, 0); }), "no error");
    EXPECT_EQ(errorAfter([](Scene& s) {
                  s.camera.window = ViewWindow{};
                  s.camera.fovY = 500;  // not used
              }),
              "no error");
    // 1e-6 radians off the plane through the view direction is enough, 1e-10 is not.
    EXPECT_EQ(errorAfter([](Scene& s) { s.camera.planeNormal = glm::dvec3(1, 0, 1e-6); }), "no error");
    EXPECT_EQ(errorAfter([](Scene& s) { s.camera.planeNormal = glm::dvec3(1, 0, 1e-10); }),
              "s: /camera/planeNormal: must not be perpendicular to the view direction [0, 0, -5] (got [1, "
              "0, 1e-10])");
    // An oblique camera may look along up.
    EXPECT_EQ(errorAfter([](Scene& s) {
                  s.camera.up = glm::dvec3(0, 0, 1);
                  s.camera.planeNormal = glm::dvec3(0, 1, 1);
              }),
              "no error");
}

TEST(Validate, ColorsTooBright) {
    EXPECT_EQ(errorAfter([](Scene& s) { s.materials[0].specular = Color(1e19); }),
              "s: /materials/grey/specular: must be at most 1e+18 (got 1e+19)");
    EXPECT_EQ(errorAfter([](Scene& s) { s.materials[0].mirror = Color(0, 0, 1.01); }),
              "s: /materials/grey/mirror: must be from 0 to 1 (got [0, 0, 1.01])");
}

TEST(Validate, MaterialWithoutANameIsGivenByItsNumber) {
    EXPECT_EQ(errorAfter([](Scene& s) { s.materials.emplace_back().diffuse = Color(-1); }),
              "s: /materials/1/diffuse: must be >= 0 (got -1)");
}

TEST(Validate, Indices) {
    EXPECT_EQ(errorAfter([](Scene& s) { s.objects[1].material = 1; }),
              "s: /objects/1/material: there is no material number 1 (there are 1)");
    EXPECT_EQ(errorAfter([](Scene& s) { s.objects[3].shape = MeshShape{}; }),
              "s: /objects/3: the mesh is missing");
    const auto withMesh = [](auto change) {
        return errorAfter([&](Scene& s) {
            auto mesh = triangleMesh();
            change(*mesh);
            s.objects[3].shape = MeshShape{mesh};
        });
    };
    EXPECT_EQ(withMesh([](Mesh& m) { m.corners[0].z = 3; }),
              "s: /objects/3: triangle 0 of the mesh uses vertex 3, there are 3");
    EXPECT_EQ(withMesh([](Mesh& m) { m.materials = {1}; }),
              "s: /objects/3: triangle 0 of the mesh uses material 1, there are 1");
    EXPECT_EQ(withMesh([](Mesh& m) { m.materials.resize(2); }),
              "s: /objects/3: the mesh has 2 material indices for 1 triangles");
    EXPECT_EQ(withMesh([](Mesh& m) { m.faces.resize(2); }),
              "s: /objects/3: the mesh has 2 face indices for 1 triangles");
    EXPECT_EQ(withMesh([](Mesh& m) { m.normalCorners.emplace_back(0, 0, 0); }),
              "s: /objects/3: triangle 0 of the mesh uses normal 0, there are 0");
    EXPECT_EQ(withMesh([](Mesh& m) { m.normalCorners = {glm::uvec3(Mesh::kNoIndex)}; }), "no error");
}

TEST(Validate, MeshVertices) {
    const auto withVertex = [](const glm::dvec3& v) {
        return errorAfter([&](Scene& s) {
            auto mesh = triangleMesh();
            mesh->positions[1] = v;
            s.objects[3].shape = MeshShape{mesh};
        });
    };
    EXPECT_EQ(withVertex({kNan, 0, 0}), "no error");  // dropped when the scene is packed
    EXPECT_EQ(withVertex({0, kInf, 0}), "no error");
    EXPECT_EQ(withVertex({0, -1e18, 0}),
              "s: /objects/3: vertex 1 of the mesh: coordinates must be below 1e+18 (got [0, -1e+18, 0])");
}

// The plane of a polygon, and when there is none.

using glm::dvec3;

const std::vector<dvec3> kL = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

TEST(PolygonPlane, ConcaveReversedAndFarAway) {
    const auto plane = polygonPlane(kL);
    ASSERT_TRUE(plane);
    EXPECT_EQ(plane->normal, dvec3(0, 0, 1));
    EXPECT_EQ(plane->deviation, 0);
    EXPECT_NEAR(glm::length(plane->point - dvec3(1, 1, 0)), 0, 1e-15);  // sums 6 and 6 over 6 vertices
    EXPECT_EQ(polygonPlane(std::vector<dvec3>(kL.rbegin(), kL.rend()))->normal, dvec3(0, 0, -1));
    std::vector<dvec3> far = kL;
    for (dvec3& v : far) v += dvec3(1e12, -1e12, 3);
    EXPECT_EQ(polygonPlane(far)->normal, dvec3(0, 0, 1));
}

// Collinear and repeated vertices add nothing to the sum.
TEST(PolygonPlane, NeedlessVerticesChangeNothing) {
    const std::vector<dvec3> more = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0},
                                     {1, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
    EXPECT_EQ(polygonPlane(more)->normal, dvec3(0, 0, 1));
}

// Points of a line as decimals: none of them lies on it in binary.
TEST(PolygonPlane, NoneWithoutArea) {
    for (const double scale : {1e-9, 1.0, 1e9}) {
        for (const dvec3& offset : {dvec3(0), dvec3(100.1, -0.3, 1e7)}) {
            std::vector<dvec3> line;
            for (const double t : {0.1, 0.3, 0.7, 0.2, 0.9})
                line.push_back(scale * (offset + t * dvec3(0.1, 0.7, -0.3)));
            EXPECT_FALSE(polygonPlane(line)) << scale;
            line.back() += scale * dvec3(1e-3, 0, 0);
            EXPECT_TRUE(polygonPlane(line)) << scale;
        }
    }
    EXPECT_FALSE(polygonPlane(std::vector<dvec3>{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));
}

// If Newell's sum vanishes, consists of rounding, or is too small for a direction, the plane is still that of
// three corners.
TEST(PolygonPlane, BowTies) {
    const std::vector<dvec3> bow = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_EQ(polygonPlane(bow)->normal, dvec3(0, 0, 1)) << "at its first vertex it turns left";
    EXPECT_EQ(polygonPlane(std::vector<dvec3>(bow.rbegin(), bow.rend()))->normal, dvec3(0, 0, -1));
    const dvec3 u(0.6, 0.48, 0.64), v(-0.8, 0.36, 0.48), n = glm::cross(u, v);
    for (const double size : {1e-3, 1.0, 1e3}) {
        for (const double more : {0.0, 1e-12, 1e-7, 1e-3}) {  // by how much the right half is larger
            std::vector<dvec3> tilted, single;
            for (const glm::dvec2 p :
                 {glm::dvec2(-1, -1), glm::dvec2(1, 1 + more), glm::dvec2(1, -1), glm::dvec2(-1, 1)}) {
                tilted.push_back(size * (dvec3(0.1, 0.7, -0.3) + p.x * u + p.y * v));
                single.push_back(dvec3(glm::vec3(tilted.back())));
            }
            for (const auto& vertices : {tilted, single}) {
                const auto plane = polygonPlane(vertices);
                ASSERT_TRUE(plane);
                EXPECT_LE(plane->deviation, planarTolerance(vertices)) << size << ' ' << more;
                const double front = more > 1e-5 ? -1 : 1;  // what is on the right is clockwise
                EXPECT_GT(front * glm::dot(plane->normal, n), 1 - 1e-9) << size << ' ' << more;
            }
        }
    }
    // Four points in space whose sum vanishes are no polygon: the plane of three leaves the fourth far off.
    const std::vector<dvec3> skew = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 1}};
    EXPECT_GT(polygonPlane(skew)->deviation, 0.1);
}

// A regular ring with one vertex raised by h: its plane is off by at most h there, and the raised vertex is
// the farthest one from it.
TEST(PolygonPlane, DeviationNamesTheVertex) {
    std::vector<dvec3> ring;
    for (int i = 0; i < 12; ++i)
        ring.emplace_back(std::cos(i * std::numbers::pi / 6), std::sin(i * std::numbers::pi / 6), 0);
    ring[7].z = 0.01;
    const auto plane = polygonPlane(ring);
    EXPECT_EQ(plane->farthest, 7u);
    EXPECT_GT(plane->deviation, 0.005);
    EXPECT_LT(plane->deviation, 0.01);
}

// A tilted polygon in fp32 or with six decimals passes, one that is bent by 1e-4 does not.
TEST(PolygonPlane, ToleranceCoversRoundedCoordinates) {
    for (const double size : {1e-3, 1.0, 1e3}) {
        std::vector<dvec3> exact, single, decimal;
        for (int i = 0; i < 40; ++i) {
            const double a = i * std::numbers::pi / 20;
            exact.push_back(size * (dvec3(3, -2, 5) + std::cos(a) * dvec3(0.6, 0.48, 0.64) +
                                    std::sin(a) * dvec3(-0.8, 0.36, 0.48)));
            single.push_back(dvec3(glm::vec3(exact.back())));
            dvec3 d = exact.back();
            for (int k = 0; k < 3; ++k) {
                char text[32];
                std::snprintf(text, sizeof(text), "%g", d[k]);
                d[k] = std::atof(text);
            }
            decimal.push_back(d);
        }
        EXPECT_LT(polygonPlane(exact)->deviation, 1e-14 * size);
        EXPECT_LT(polygonPlane(single)->deviation, planarTolerance(single));
        EXPECT_LT(polygonPlane(decimal)->deviation, planarTolerance(decimal));
        exact[3] += 1e-4 * size * dvec3(0, 0.8, -0.6);
        EXPECT_GT(polygonPlane(exact)->deviation, planarTolerance(exact));
    }
}

}  // namespace glint::test::validate_test
