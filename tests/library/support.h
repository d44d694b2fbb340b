// Devices, scenes and arrays for the tests of the C API.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "glint/glint.h"
#include "support/scene_maker.h"
#include "support/support.h"

// A call of the C API succeeds.
#define EXPECT_OK(call) EXPECT_EQ(call, GLINT_OK) << glint_last_error()
#define ASSERT_OK(call) ASSERT_EQ(call, GLINT_OK) << glint_last_error()

namespace glint::library::test {

// A program for each, by on_reference.cpp and on_device.cpp: the reference needs no Vulkan, the device is
// lavapipe in tests.
extern const bool kOnDevice;
inline const char* selector() {
    return kOnDevice ? "" : "cpu";
}

using F3 = std::array<float, 3>;
using D3 = glm::dvec3;
using U3 = glm::uvec3;

// The type of a number, or of an element's numbers.
template <class T>
constexpr glint_type typeOf() {
    if constexpr (requires { typename T::value_type; }) return typeOf<typename T::value_type>();
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
template <class T>
glint_out outOf(std::vector<T>& values) {
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

struct RayList {
    std::vector<D3> origins, directions;

    void add(const D3& from, const D3& along) {
        origins.push_back(from);
        directions.push_back(along);
    }
    size_t size() const { return origins.size(); }
    glint_rays rays() const { return raysFrom(origins, directions); }
};

// The hits of rays, in arrays of their own.
struct Found {
    std::vector<uint8_t> hit, sure;
    std::vector<double> t, lower, upper;
    std::vector<uint32_t> geometry, primitive;
    std::vector<D3> point, normal, origin;
    bool operator==(const Found&) const = default;

    // Outputs for `count` rays; certified: with sure and the bounds of t.
    glint_hits outputs(size_t count, bool certified = false) {
        GLINT_INIT(glint_hits, hits);
        // Filled with what no query answers.
        const auto room = [count](auto& values, auto unlikely) {
            values.assign(count, unlikely);
            return outOf(values);
        };
        hits.hit = room(hit, uint8_t{9});
        hits.t = room(t, -1.0);
        hits.geometry = room(geometry, 77u);
        hits.primitive = room(primitive, 77u);
        hits.point = room(point, D3{-1});
        hits.normal = room(normal, D3{-9});
        hits.origin = room(origin, D3{-1});
        if (!certified) return hits;
        hits.sure = room(sure, uint8_t{9});
        hits.t_lower = room(lower, -1.0);
        hits.t_upper = room(upper, -1.0);
        return hits;
    }
};
// The answers of three queries to the same rays.
struct Answers {
    Found closest;
    std::vector<uint8_t> any;
    std::vector<uint32_t> crossings;
    bool operator==(const Answers&) const = default;
};
// All hits of rays: those of ray i are from offsets[i] to offsets[i + 1].
struct Listed {
    std::vector<uint64_t> offsets;
    std::vector<double> t;
    std::vector<uint32_t> geometry, primitive;
    std::vector<D3> normal;
};

// Returns the number of the mesh. The triangles are consecutive vertices, or by indices.
template <class Vertex>
uint32_t addMesh(glint_scene* scene, const std::vector<Vertex>& vertices,
                 const std::vector<U3>& corners = {}) {
    GLINT_INIT(glint_triangles, triangles);
    triangles.vertices = viewOf(vertices);
    if (!corners.empty()) triangles.indices = viewOf(corners);
    uint32_t geometry = GLINT_NONE;
    EXPECT_OK(glint_scene_add_triangles(scene, &triangles, &geometry));
    return geometry;
}
// The triangles of side x side squares, whose vertices are given row by row.
inline std::vector<U3> gridCorners(uint32_t side) {
    return glint::test::gridMesh(side)->corners;
}
// Returns the number of the first sphere.
inline uint32_t addSpheres(glint_scene* scene, const std::vector<D3>& centers,
                           const std::vector<double>& radii) {
    GLINT_INIT(glint_spheres, spheres);
    spheres.centers = viewOf(centers);
    spheres.radii = viewOf(radii);
    uint32_t first = GLINT_NONE;
    EXPECT_OK(glint_scene_add_spheres(scene, &spheres, &first));
    return first;
}
inline void addJson(glint_scene* scene, const std::string& text) {
    EXPECT_EQ(glint_scene_add_json(scene, text.c_str(), nullptr, nullptr, nullptr), GLINT_OK)
        << text << glint_last_error();
}

// An argument is refused, with a message that holds `part`.
inline void refused(glint_status status, const std::string& part) {
    EXPECT_EQ(status, GLINT_ERROR_ARGUMENT);
    EXPECT_HAS(glint_last_error(), part);
}

// Options of a call that count its questions, cancel it and keep its progress.
struct Watch {
    std::atomic<int> asked = 0;  // from any thread
    int cancelAt = 0;            // the number of the question to say yes to, from 1; 0: none
    std::vector<double> told;
    glint_options options() {
        GLINT_INIT(glint_options, made);
        made.user = this;
        made.cancelled = [](void* user) {
            auto& watch = *static_cast<Watch*>(user);
            return ++watch.asked == watch.cancelAt ? 1 : 0;
        };
        made.progress = [](void* user, double part) { static_cast<Watch*>(user)->told.push_back(part); };
        return made;
    }
};

inline std::filesystem::path sceneFile(const std::string& name) {
    return glint::test::sourcePath("scenes/" + name);
}

// One device for all tests of a suite, and the scene of a test.
class LibraryTest : public testing::Test {
  protected:
    static void SetUpTestSuite() { ASSERT_OK(glint_device_open(selector(), &device_)); }
    static void TearDownTestSuite() {
        glint_device_release(device_);
        device_ = nullptr;
    }
    void TearDown() override { glint_scene_release(scene_); }

    static glint_device* device() { return device_; }
    glint_scene* scene() {
        if (scene_ == nullptr) {
            EXPECT_OK(glint_scene_create(device_, &scene_));
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
        ASSERT_OK(glint_scene_load(device_, sceneFile(name).c_str(), &scene_));
    }
    void commit() { ASSERT_OK(glint_scene_commit(scene())); }

    template <class Vertex>
    uint32_t addMesh(const std::vector<Vertex>& vertices, const std::vector<U3>& corners = {}) {
        return test::addMesh(scene(), vertices, corners);
    }
    glint_scene_info info() {
        GLINT_INIT(glint_scene_info, info);
        EXPECT_OK(glint_scene_info_of(scene(), &info));
        return info;
    }

    Found closest(const glint_rays& rays, bool certified = false) {
        Found found;
        const glint_hits hits = found.outputs(countOf(rays), certified);
        EXPECT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
        return found;
    }
    std::vector<uint8_t> any(const glint_rays& rays) {
        std::vector<uint8_t> hit(countOf(rays), 9);
        const glint_out out = outOf(hit);
        EXPECT_OK(glint_query_any(scene(), &rays, &out, nullptr));
        return hit;
    }
    std::vector<uint32_t> counts(const glint_rays& rays) {
        std::vector<uint32_t> crossings(countOf(rays), 99);
        const glint_out out = outOf(crossings);
        EXPECT_OK(glint_query_count(scene(), &rays, &out, nullptr));
        return crossings;
    }
    Answers answers(const glint_rays& rays) { return {closest(rays), any(rays), counts(rays)}; }
    Listed list(const glint_rays& rays) {
        Listed listed;
        listed.offsets.resize(countOf(rays) + 1);
        const glint_out offsets = outOf(listed.offsets);
        uint64_t total = 0;
        EXPECT_OK(glint_query_all(scene(), &rays, &offsets, nullptr, &total, nullptr));
        listed.t.resize(total);
        listed.geometry.resize(total);
        listed.primitive.resize(total);
        listed.normal.resize(total);
        GLINT_INIT(glint_hits, hits);
        hits.t = outOf(listed.t);
        hits.geometry = outOf(listed.geometry);
        hits.primitive = outOf(listed.primitive);
        hits.normal = outOf(listed.normal);
        EXPECT_OK(glint_query_all(scene(), &rays, &offsets, &hits, &total, nullptr));
        return listed;
    }

  private:
    static size_t countOf(const glint_rays& rays) {
        return std::max(rays.origins.count, rays.directions.count);
    }

    inline static glint_device* device_ = nullptr;
    glint_scene* scene_ = nullptr;
};

}  // namespace glint::library::test
