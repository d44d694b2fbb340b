// Scenes from arrays, files and texts; instances, changes, commits, devices.
#include <cmath>
#include <thread>

#include "support.h"

namespace glint::library::test {
namespace {

class LibraryScene : public LibraryTest {
  protected:
    // t and geometry of the nearest hit of a ray along -z.
    std::pair<double, uint32_t> below(double x, double y, double z = 100) {
        const std::vector<D3> origins = {{x, y, z}}, directions = {{0, 0, -1}};
        const Found found = closest(raysFrom(origins, directions));
        return {found.t[0], found.geometry[0]};
    }
    // fp32 keeps 24 of t's binary digits at the least where nothing cancels.
    void expectBelow(std::array<double, 2> at, double t, uint32_t geometry) {
        const auto [found, number] = below(at[0], at[1]);
        EXPECT_EQ(number, geometry) << at[0];
        EXPECT_NEAR(found, t, 1e-4) << at[0];
    }
    uint32_t addTriangleAt(double x) { return addMesh<D3>({{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}}); }
};

TEST_F(LibraryScene, GeometriesAreNumberedAsTheyCome) {
    EXPECT_EQ(addTriangleAt(0), 0u);
    EXPECT_EQ(addSpheres(scene(), {{10, 0, 0}}, {2}), 1u);
    uint32_t first = 9, count = 9;
    ASSERT_OK(glint_scene_add_json(scene(), R"({"materials": {"red": {"diffuse": [1, 0, 0]}}, "objects": [
        {"type": "disc", "center": [20, 0, 3], "normal": [0, 0, 1], "radius": 1, "material": "red"},
        {"type": "box", "min": [29, -1, 0], "max": [31, 1, 5], "material": "red"}]})",
                                   nullptr, &first, &count));
    EXPECT_EQ(first, 2u);
    EXPECT_EQ(count, 2u);
    EXPECT_EQ(addTriangleAt(40), 4u);
    commit();
    expectBelow({0.2, 0.2}, 100, 0);
    expectBelow({10, 0}, 98, 1);
    expectBelow({20, 0}, 97, 2);
    expectBelow({30, 0}, 95, 3);
    expectBelow({40.2, 0.2}, 100, 4);
    uint32_t material = 9;
    EXPECT_OK(glint_scene_find_material(scene(), "red", &material));
    EXPECT_EQ(material, 0u);
    EXPECT_EQ(glint_scene_find_material(scene(), "blue", &material), GLINT_ERROR_ARGUMENT);
    EXPECT_EQ(info().geometries, 5u);
    EXPECT_EQ(info().triangles, 2u);
    // Boxes are rounded outwards.
    EXPECT_NEAR(info().lower[0], 0, 1e-4);
    EXPECT_NEAR(info().upper[0], 41, 1e-4);
}

// fp64 and a million units from 0: what is rounded is the distance from the scene's own origin.
TEST_F(LibraryScene, FarFromTheOrigin) {
    const double far = 1e6 + 1.0 / 1024;
    addTriangleAt(far);
    commit();
    expectBelow({far + 0.25, 0.25}, 100, 0);
    EXPECT_EQ(below(far - 1e-4, 0.25).second, GLINT_NONE);
    EXPECT_EQ(below(far + 1e-4, 0.25).second, 0u);
}

TEST_F(LibraryScene, InstancesAndTransforms) {
    const uint32_t triangle = addTriangleAt(0);
    const double moved[12] = {1, 0, 0, 7, 0, 1, 0, 0, 0, 0, 1, 2},
                 doubled[12] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 4};
    uint32_t instance = 9;
    ASSERT_OK(glint_scene_add_instance(scene(), triangle, moved, &instance));
    EXPECT_EQ(instance, 1u);
    commit();
    expectBelow({0.2, 0.2}, 100, 0);
    expectBelow({7.2, 0.2}, 98, 1);
    // Not seen before it is committed; of an instance it replaces the transform.
    ASSERT_OK(glint_scene_set_transform(scene(), instance, doubled));
    expectBelow({7.2, 0.2}, 98, 1);
    commit();
    EXPECT_EQ(below(7.2, 0.2).second, GLINT_NONE);
    expectBelow({0.8, 0.8}, 96, 1);
    const std::vector<D3> vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, few(2);
    const glint_view view = viewOf(vertices), short_view = viewOf(few);
    ASSERT_OK(glint_scene_set_vertices(scene(), triangle, &view));
    commit();
    expectBelow({0.8, 0.8}, 94, 1);  // 2 * 1 + 4
    EXPECT_EQ(glint_scene_set_vertices(scene(), triangle, &short_view), GLINT_ERROR_ARGUMENT);
    const double flat[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(glint_scene_set_transform(scene(), instance, flat), GLINT_ERROR_ARGUMENT);
    EXPECT_EQ(glint_scene_set_transform(scene(), 5, moved), GLINT_ERROR_ARGUMENT);
}

TEST_F(LibraryScene, FilesAndTheirFaults) {
    load("knot.json");
    EXPECT_GT(info().triangles, 1000u);
    glint_scene* none = scene();
    EXPECT_EQ(glint_scene_load(device(), "/no/such/file.json", &none), GLINT_ERROR_SCENE);
    EXPECT_EQ(none, nullptr);
    EXPECT_HAS(glint_last_error(), "/no/such/file.json");
    EXPECT_EQ(glint_scene_add_json(scene(), "{\"objects\": 3}", nullptr, nullptr, nullptr),
              GLINT_ERROR_SCENE);
}

TEST_F(LibraryScene, TrianglesThatAreRefused) {
    const std::vector<F3> vertices(3);
    const std::vector<U3> corners = {{0, 1, 3}};
    GLINT_INIT(glint_triangles, triangles);
    triangles.vertices = viewOf(vertices);
    triangles.indices = viewOf(corners);
    refused(glint_scene_add_triangles(scene(), &triangles, nullptr), "triangle 0 names a vertex");
    triangles.indices = {};
    triangles.vertices.count = 2;
    EXPECT_EQ(glint_scene_add_triangles(scene(), &triangles, nullptr), GLINT_ERROR_ARGUMENT);
    triangles.vertices.count = 3;
    triangles.material = 7;
    EXPECT_EQ(glint_scene_add_triangles(scene(), &triangles, nullptr), GLINT_ERROR_ARGUMENT);
    commit();  // an empty scene is one
    EXPECT_EQ(below(0, 0).second, GLINT_NONE);
}

// By the call, as nothing takes them out again: the scene would never be committed.
TEST_F(LibraryScene, SpheresThatAreRefused) {
    GLINT_INIT(glint_spheres, spheres);
    D3 center = {0, 0, 0};
    double radius = 1;
    spheres.centers = {&center, 1, 0, GLINT_F64, 0};
    spheres.radii = {&radius, 1, 0, GLINT_F64, 0};
    const auto refuse = [&](const std::string& part) {
        refused(glint_scene_add_spheres(scene(), &spheres, nullptr), part);
    };
    radius = 0;
    refuse("radius 0 is not greater than 0");
    for (const double far : {HUGE_VAL, 1e19, 1e-15}) {
        radius = far;
        refuse("radius 0 is not from 1e-14 to 1e18");
    }
    radius = 1;
    for (const double far : {std::nan(""), -HUGE_VAL, 1e19}) {
        center[1] = far;
        refuse("center 0 is not finite, or not within 1e18 of 0");
    }
    spheres.radii.count = 0;
    refuse("radii has 0 elements, and 1 is needed");
    commit();
    const double nothing[12] = {};
    EXPECT_EQ(glint_scene_load(nullptr, "x", nullptr), GLINT_ERROR_ARGUMENT);
    EXPECT_STREQ(glint_last_error(), "glint_scene_load: device is NULL");
    addMesh<F3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_EQ(glint_scene_set_transform(scene(), 0, nothing), GLINT_ERROR_ARGUMENT);
    EXPECT_STREQ(glint_last_error(),
                 "glint_scene_set_transform: transform: the matrix is singular, or not finite");
}

TEST_F(LibraryScene, DegenerateTrianglesKeepTheirNumbers) {
    const float nan = std::nanf("");
    addMesh<F3>({{nan, 0, 0},
                 {1, 0, 0},
                 {0, 1, 0},
                 {5, 0, 0},
                 {6, 0, 0},
                 {7, 0, 0},
                 {0, 0, 0},
                 {1, 0, 0},
                 {0, 1, 0}});
    commit();
    const std::vector<D3> origins = {{0.2, 0.2, 1}}, directions = {{0, 0, -1}};
    EXPECT_EQ(closest(raysFrom(origins, directions)).primitive[0], 2u);
    EXPECT_GE(info().warnings, 1u);
    const char* text = nullptr;
    EXPECT_OK(glint_scene_warning(scene(), 0, &text));
    EXPECT_EQ(glint_scene_warning(scene(), info().warnings, &text), GLINT_ERROR_ARGUMENT);
}

TEST_F(LibraryScene, DevicesAndVersions) {
    uint32_t count = 0;
    ASSERT_OK(glint_device_count(&count));
    ASSERT_GE(count, 1u);
    GLINT_INIT(glint_device_info, info);
    ASSERT_OK(glint_device_describe(count - 1, &info));
    EXPECT_STREQ(info.name, "cpu");
    EXPECT_TRUE(info.usable && info.reference);
    EXPECT_EQ(glint_device_describe(count, &info), GLINT_ERROR_ARGUMENT);
    glint_device* opened = nullptr;
    EXPECT_EQ(glint_device_open("no such device", &opened), GLINT_ERROR_DEVICE);
    EXPECT_EQ(opened, nullptr);
    EXPECT_EQ(glint_version(), 1000u);
    EXPECT_STREQ(glint_status_name(GLINT_ERROR_SCENE), "scene");
    EXPECT_STREQ(glint_status_name(99), "unknown");
    glint_device_release(nullptr);
    glint_scene_release(nullptr);
}

// The scene outlives its device's handle, and its own first owner.
TEST_F(LibraryScene, HandlesAreCounted) {
    glint_device* device = nullptr;
    ASSERT_OK(glint_device_open("cpu", &device));
    glint_scene* own = nullptr;
    ASSERT_OK(glint_scene_create(device, &own));
    glint_device_release(device);
    glint_scene_retain(own);
    glint_scene_release(own);
    EXPECT_OK(glint_scene_commit(own));
    glint_scene_release(own);
}

// The last error is the thread's own.
TEST_F(LibraryScene, ErrorsByThread) {
    glint_scene* none = nullptr;
    EXPECT_NE(glint_scene_load(device(), "/a", &none), GLINT_OK);
    std::string other = "unset";
    std::thread([&] { other = glint_last_error(); }).join();
    EXPECT_EQ(other, "");
    EXPECT_NE(std::string(glint_last_error()), "");
}

}  // namespace
}  // namespace glint::library::test
