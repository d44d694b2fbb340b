// Small scenes, object by object.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace glint::test {

// Returns the object's index; its name is /objects/INDEX.
uint32_t addObject(Scene& scene, Shape shape, uint32_t material = 0);
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
void aim(Camera& camera, const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up = {0, 1, 0});
// Matte grey as material 0, no light.
Scene emptyScene();
// emptyScene() with one object.
Scene sceneOf(Shape shape);
// Clipped at +-half on each axis.
QuadricShape generalQuadric(const std::array<double, 10>& coefficients, double half);
// cells x cells squares of two triangles each over [0, cells] x [0, cells] in the plane z = 0, shifted by
// `offset`, all facing +z.
std::shared_ptr<Mesh> gridMesh(uint32_t cells, const glm::dvec3& offset = glm::dvec3(0));

}  // namespace glint::test
