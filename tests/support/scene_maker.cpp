#include "support/scene_maker.h"

#include <algorithm>

namespace glint::test {

uint32_t addObject(Scene& scene, Shape shape, uint32_t material) {
    if (scene.materials.empty()) scene.materials.resize(1);
    const auto index = static_cast<uint32_t>(scene.objects.size());
    scene.objects.push_back({"/objects/" + std::to_string(index), std::move(shape), material});
    return index;
}

uint32_t addMaterial(Scene& scene, const Color& diffuse, const Color& mirror) {
    Material material;
    material.diffuse = diffuse;
    material.ambient = diffuse;
    material.mirror = mirror;
    scene.materials.push_back(material);
    return static_cast<uint32_t>(scene.materials.size()) - 1;
}

void addTriangle(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                 uint32_t material) {
    scene.objects.push_back({"triangle", TriangleShape{{a, b, c}}, material});
}

void addSphere(Scene& scene, const glm::dvec3& center, double radius, uint32_t material) {
    scene.objects.push_back({"sphere", SphereShape{center, radius}, material});
}

void addPlane(Scene& scene, const glm::dvec3& point, const glm::dvec3& normal, uint32_t material) {
    scene.objects.push_back({"plane", PlaneShape{point, normal}, material});
}

void addDisc(Scene& scene, const glm::dvec3& center, const glm::dvec3& normal, double radius,
             uint32_t material) {
    scene.objects.push_back({"disc", DiscShape{center, normal, radius}, material});
}

void addPolygon(Scene& scene, std::vector<glm::dvec3> vertices, uint32_t material) {
    scene.objects.push_back({"polygon", PolygonShape{std::move(vertices)}, material});
}

void addMesh(Scene& scene, std::vector<glm::dvec3> positions, std::vector<glm::uvec3> corners,
             uint32_t material) {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = std::move(positions);
    mesh->corners = std::move(corners);
    scene.objects.push_back({"mesh", MeshShape{mesh}, material});
}

void addGrid(Scene& scene, uint32_t n, const glm::dvec3& offset, double size) {
    const auto mesh = gridMesh(n);
    for (glm::dvec3& p : mesh->positions) p = offset + size * p / double(n);
    scene.objects.push_back({"mesh", MeshShape{mesh}});
}

std::shared_ptr<Mesh> gridMesh(uint32_t cells, const glm::dvec3& offset) {
    auto mesh = std::make_shared<Mesh>();
    for (uint32_t y = 0; y <= cells; ++y)
        for (uint32_t x = 0; x <= cells; ++x) mesh->positions.push_back(offset + glm::dvec3(x, y, 0));
    for (uint32_t y = 0; y < cells; ++y) {
        for (uint32_t x = 0; x < cells; ++x) {
            const uint32_t a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
            mesh->corners.push_back({a, b, d});
            mesh->corners.push_back({a, d, c});
        }
    }
    return mesh;
}

void aim(Camera& camera, const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
    camera.eye = eye;
    camera.target = target;
    camera.up = up;
}

Scene emptyScene() {
    Scene scene;
    addMaterial(scene, Color(0.8));
    return scene;
}

Scene sceneOf(Shape shape) {
    Scene scene = emptyScene();
    addObject(scene, std::move(shape));
    return scene;
}

QuadricShape generalQuadric(const std::array<double, 10>& coefficients, double half) {
    QuadricShape shape;
    std::copy(coefficients.begin(), coefficients.end(), shape.coefficients);
    shape.lo = glm::dvec3(-half);
    shape.hi = glm::dvec3(half);
    return shape;
}

}  // namespace glint::test
