// Builds small PackedScenes without the packing code of src/pack: these tests stand on the layouts and the
// trees of src/bvh.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "pack/packed_scene.h"
#include "reference/tracer.h"

namespace glint::test {

// Every primitive is an object of its own; its id, and its object's index, is the number of primitives added
// before it. Material 0 is matte white: ambient 0, diffuse 1.
class SceneMaker {
  public:
    SceneMaker();

    uint32_t material(const glm::vec3& diffuse, const glm::vec3& specular = glm::vec3(0), float shininess = 1,
                      const glm::vec3& mirror = glm::vec3(0), const glm::vec3& ambient = glm::vec3(0));
    uint32_t triangle(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2, uint32_t material = 0);
    uint32_t triangle(const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2,
                      const shared::VertexNormals& normals, uint32_t material = 0);
    uint32_t sphere(const glm::vec3& center, float radius, uint32_t material = 0);
    uint32_t anchoredSphere(const glm::vec3& point, const glm::vec3& normal, float radius,
                            uint32_t material = 0);
    uint32_t plane(const glm::vec3& point, const glm::vec3& normal, uint32_t material = 0);
    uint32_t disc(const glm::vec3& center, const glm::vec3& normal, float radius, uint32_t material = 0);
    // The plane is by the first three vertices.
    uint32_t polygon(const std::vector<glm::vec3>& vertices, uint32_t material = 0);
    void cube(const glm::vec3& center, float halfEdge);  // 12 triangles, outward
    void light(uint32_t kind, const glm::vec3& position, const glm::vec3& intensity = glm::vec3(1));

    // Angles in degrees; see SpotLight.
    void spot(const glm::vec3& position, const glm::vec3& axis, double angle, double penumbra,
              uint32_t kind = shared::kLightSpot, const glm::vec3& intensity = glm::vec3(1));

    // The next primitive takes this id.
    void setNextId(uint32_t id) { nextId_ = id; }

    shared::Environment environment;

    PackedScene finish(uint32_t maxLeafSize = 2) const;

  private:
    uint32_t nextId_ = 0;
    PackedScene scene_;  // primitives in the order added
};

// A packed scene and its tracer.
struct SceneHolder {
    PackedScene scene;
};
struct SceneTracer : SceneHolder, reference::Tracer {
    explicit SceneTracer(PackedScene packed) : SceneHolder{std::move(packed)}, Tracer(scene) {}
    explicit SceneTracer(const SceneMaker& maker, uint32_t maxLeafSize = 2)
        : SceneTracer(maker.finish(maxLeafSize)) {}
};

// Closed meshes, wound outward.
struct ClosedMesh {
    std::vector<glm::dvec3> vertices;
    std::vector<glm::uvec3> triangles;
};
// A sphere of quads of two triangles each, its poles on the z axis, with a radius for each vertex. Vertices
// are not rounded to fp32.
ClosedMesh makeBall(uint32_t parallels, uint32_t meridians, const std::function<double()>& radius);
// The ball of 16 x 16 quads, whose radii are 1 + 5 xi for uniform xi, of pbrt's test Triangle.Watertight
// (Pharr, Jakob, Humphreys, pbrt-v4, src/pbrt/shapes_test.cpp), rounded to fp32.
ClosedMesh makeBumpyMesh(uint32_t seed, uint32_t steps = 16);
// The cube [-1, 1]^3 in squares of edge 2 / n, each cut in two: edges and planes along the axes, all places
// exact.
ClosedMesh gridCube(uint32_t n);

// The closest hit if every ray enters every box: an oracle for Tracer::closest().
std::optional<reference::Hit> closestOfAll(const reference::Tracer& tracer, const reference::Ray& ray,
                                           const reference::Source& source = {});

reference::Ray makeRay(const glm::dvec3& origin, const glm::dvec3& direction);
reference::Ray rayTowards(const glm::dvec3& origin, const glm::dvec3& target);

class Random {
  public:
    explicit Random(uint64_t seed) : engine_(seed) {}
    double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>(engine_() % n); }
    glm::dvec3 box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    glm::dvec3 direction();  // uniform on the unit sphere

  private:
    std::mt19937 engine_;
};

}  // namespace glint::test
