// Devices, scenes and arrays for the tests of the C API.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "glint/glint.h"

namespace glint::library::test {

// A program for each, by on_reference.cpp and on_device.cpp: the reference needs no Vulkan, the device is
// lavapipe in tests.
extern const bool kOnDevice;
inline const char* selector() {
    return kOnDevice ? "" : "cpu";
}

using F3 = std::array<float, 3>;
using D3 = std::array<double, 3>;
using U3 = std::array<uint32_t, 3>;

inline glm::dvec3 vectorOf(const D3& v) {
    return {v[0], v[1], v[2]};
}
inline D3 arrayOf(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

template <class T>
constexpr glint_type typeOf() {
    if constexpr (std::is_same_v<T, float>) return GLINT_F32;
    if constexpr (std::is_same_v<T, double>) return GLINT_F64;
    if constexpr (std::is_same_v<T, uint32_t>) return GLINT_U32;
    if constexpr (std::is_same_v<T, uint64_t>) return GLINT_U64;
    return GLINT_U8;
}
template <class T>
glint_view viewOf(const std::vector<T>& values) {
    return {values.data(), values.size(), 0, typeOf<T>(), 0};
}
template <class T, size_t N>
glint_view viewOf(const std::vector<std::array<T, N>>& values) {
    return {values.data(), values.size(), 0, typeOf<T>(), 0};
}
template <class T>
glint_out outOf(std::vector<T>& values) {
    return {values.data(), values.size(), 0, typeOf<T>(), 0};
}
template <class T, size_t N>
glint_out outOf(std::vector<std::array<T, N>>& values) {
    return {values.data(), values.size(), 0, typeOf<T>(), 0};
}

// Rays between arrays, which must outlive them.
template <class Origins, class Directions>
glint_rays raysFrom(const Origins& origins, const Directions& directions) {
    GLINT_INIT(glint_rays, rays);
    rays.origins = viewOf(origins);
    rays.directions = viewOf(directions);
    return rays;
}

// Returns the number of the first sphere.
inline uint32_t addSpheres(glint_scene* scene, const std::vector<D3>& centers,
                           const std::vector<double>& radii) {
    GLINT_INIT(glint_spheres, spheres);
    spheres.centers = viewOf(centers);
    spheres.radii = viewOf(radii);
    uint32_t first = GLINT_NONE;
    EXPECT_EQ(glint_scene_add_spheres(scene, &spheres, &first), GLINT_OK) << glint_last_error();
    return first;
}
inline void addJson(glint_scene* scene, const std::string& text) {
    EXPECT_EQ(glint_scene_add_json(scene, text.c_str(), nullptr, nullptr, nullptr), GLINT_OK)
        << text << glint_last_error();
}

// An argument is refused, with a message that holds `part`.
inline void refused(glint_status status, const std::string& part) {
    EXPECT_EQ(status, GLINT_ERROR_ARGUMENT);
    EXPECT_NE(std::string(glint_last_error()).find(part), std::string::npos) << glint_last_error();
}

inline std::filesystem::path sceneFile(const std::string& name) {
    return std::filesystem::path(GLINT_SOURCE_DIR) / "scenes" / name;
}

// One device for all tests of a suite, and the scene of a test.
class LibraryTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        ASSERT_EQ(glint_device_open(selector(), &device_), GLINT_OK) << glint_last_error();
    }
    static void TearDownTestSuite() {
        glint_device_release(device_);
        device_ = nullptr;
    }
    void TearDown() override { glint_scene_release(scene_); }

    static glint_device* device() { return device_; }
    glint_scene* scene() {
        if (scene_ == nullptr) {
            EXPECT_EQ(glint_scene_create(device_, &scene_), GLINT_OK) << glint_last_error();
        }
        return scene_;
    }
    // In place of the one so far.
    void useScene(glint_scene* other) {
        glint_scene_release(scene_);
        scene_ = other;
    }
    void load(const std::string& name) {
        glint_scene_release(scene_);
        ASSERT_EQ(glint_scene_load(device_, sceneFile(name).c_str(), &scene_), GLINT_OK)
            << glint_last_error();
    }
    void commit() { ASSERT_EQ(glint_scene_commit(scene()), GLINT_OK) << glint_last_error(); }

    // A mesh of these corners, consecutive or by indices.
    template <class T>
    uint32_t addMesh(const std::vector<std::array<T, 3>>& vertices, const std::vector<U3>& corners = {}) {
        GLINT_INIT(glint_triangles, triangles);
        triangles.vertices = viewOf(vertices);
        if (!corners.empty()) triangles.indices = viewOf(corners);
        uint32_t geometry = GLINT_NONE;
        EXPECT_EQ(glint_scene_add_triangles(scene(), &triangles, &geometry), GLINT_OK) << glint_last_error();
        return geometry;
    }

  private:
    inline static glint_device* device_ = nullptr;
    glint_scene* scene_ = nullptr;
};

}  // namespace glint::library::test
