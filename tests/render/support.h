// A device, scenes and bitwise comparison for the tests of render and verify.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "../reference/scene_maker.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "trace/picture.h"

namespace glint::render::test {

using reference::test::Random;
using reference::test::SceneMaker;

// One device for the tests of a suite.
class RenderTest : public testing::Test {
  protected:
    static void SetUpTestSuite();
    static void TearDownTestSuite();
    static const gpu::Device& device() { return *device_; }

  private:
    static std::unique_ptr<gpu::Device> device_;
};

// ---- scenes ----

struct Case {
    Scene scene;
    PackedScene packed;
    shared::Camera camera;
    int width = 0, height = 0;
};
Case makeCase(Scene scene, int width, int height, BuildQuality quality = BuildQuality::Default);
// scenes/NAME.json
Case fileCase(const std::string& name, int width, int height);
// Scene text as in a file.
Case textCase(const std::string& text, int width, int height);
// The names of all scenes/*.json.
std::vector<std::string> sceneNames();
// With boxes that hold everything, so that each ray is tested against each primitive.
PackedScene withOpenBoxes(PackedScene scene);

uint32_t addMaterial(Scene& scene, const Color& diffuse, const Color& mirror = Color(0));
void addTriangle(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                 uint32_t material = 0);
void addSphere(Scene& scene, const glm::dvec3& center, double radius, uint32_t material = 0);
void addPlane(Scene& scene, const glm::dvec3& point, const glm::dvec3& normal, uint32_t material = 0);
void addDisc(Scene& scene, const glm::dvec3& center, const glm::dvec3& normal, double radius,
             uint32_t material = 0);
void addPolygon(Scene& scene, std::vector<glm::dvec3> vertices, uint32_t material = 0);
void addMesh(Scene& scene, std::vector<glm::dvec3> positions, std::vector<glm::uvec3> corners,
             uint32_t material = 0);
// n x n squares of two triangles each in the plane z = 0 from (0, 0) to (1, 1), moved by `offset`.
void addGrid(Scene& scene, uint32_t n, const glm::dvec3& offset = glm::dvec3(0), double size = 1);
// Matte grey as material 0, no light.
Scene emptyScene();
// Packed by hand, see SceneMaker: nothing is dropped or moved.
PackedScene packedBy(const SceneMaker& maker);

// ---- pictures and rays ----

// Everything but the data is the default.
Picture draw(Renderer& renderer, const Case& c);
Picture draw(const gpu::Device& device, const Case& c, const Options& options = {});

// The whole picture of a case with its data, and the reference's colours in double.
Request wholeWithData(const Case& c);

// True if colour, data and `done` agree in every bit.
testing::AssertionResult sameBits(const Picture& a, const Picture& b);
testing::AssertionResult sameBits(const RayHit& a, const RayHit& b);
testing::AssertionResult sameBits(const std::vector<RayHit>& a, const std::vector<RayHit>& b,
                                  const std::vector<RayInput>& rays);

RayInput rayOf(const glm::vec3& origin, const glm::vec3& direction);
// The direction is rounded to float, and unit length if `unit`.
RayInput rayTowards(const glm::dvec3& origin, const glm::dvec3& target, bool unit = false);
size_t misses(const std::vector<RayHit>& hits);
std::string text(const RayInput& ray);

}  // namespace glint::render::test
