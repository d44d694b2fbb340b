#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "scene/load.h"

namespace glint {

namespace {

// Towards the eye, from the middle of the model: in front (+z), to the right and above.
constexpr glm::dvec3 kTowardsEye{0.42, 0.40, 1.0};
constexpr double kFovY = 40;
constexpr double kMargin = 1.08;  // of the picture's half size that stays free around the model, as a factor

// Axis-aligned, in some frame.
struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};

    bool empty() const { return low.x > high.x; }
    void add(const glm::dvec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
};

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Of a vector, at least: the Frobenius norm.
double greatestStretch(const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

// Calls visit(point, radius) for the finite geometry of a shape that will be drawn: triangles with a bad
// vertex are left out, planes have no size.
template <typename Visit>
void forEachPointOf(const Shape& anyShape, const Visit& visit) {
    const auto triangle = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        if (!finite(a) || !finite(b) || !finite(c)) return;
        visit(a, 0.0);
        visit(b, 0.0);
        visit(c, 0.0);
    };
    if (const auto* sphere = std::get_if<SphereShape>(&anyShape)) {
        visit(sphere->center, sphere->radius);
    } else if (const auto* disc = std::get_if<DiscShape>(&anyShape)) {
        visit(disc->center, disc->radius);  // the sphere around it
    } else if (const auto* flat = std::get_if<TriangleShape>(&anyShape)) {
        triangle(flat->vertices[0], flat->vertices[1], flat->vertices[2]);
    } else if (const auto* polygon = std::get_if<PolygonShape>(&anyShape)) {
        for (const glm::dvec3& vertex : polygon->vertices) visit(vertex, 0.0);
    } else if (const auto* shape = std::get_if<MeshShape>(&anyShape)) {
        const auto& positions = shape->mesh->positions;
        for (const glm::uvec3& c : shape->mesh->corners)
            triangle(positions[c.x], positions[c.y], positions[c.z]);
    }
}

// The same of a scene, in the world. Of meshes that are stored once the corners of their boxes.
template <typename Visit>
void forEachPoint(const Scene& scene, const Visit& visit) {
    std::map<const Mesh*, Box> boxes;
    for (const Object& object : scene.objects) {
        if (!object.transform) {
            forEachPointOf(object.shape, visit);
            continue;
        }
        const Affine& world = *object.transform;
        const auto placed = [&](const glm::dvec3& point, double radius) {
            visit(world.linear * point + world.offset, radius * greatestStretch(world.linear));
        };
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (shape == nullptr) {
            forEachPointOf(object.shape, placed);
            continue;
        }
        const auto [known, fresh] = boxes.try_emplace(shape->mesh.get());
        Box& box = known->second;
        if (fresh) forEachPointOf(object.shape, [&](const glm::dvec3& point, double) { box.add(point); });
        if (box.empty()) continue;
        for (int i = 0; i < 8; ++i)
            placed({i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                    i & 4 ? box.high.z : box.low.z},
                   0);
    }
}

struct Frame {
    glm::dvec3 right, up, back;  // orthonormal; back points to the eye
};

Frame viewFrame() {
    const glm::dvec3 back = glm::normalize(kTowardsEye);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
    return {right, glm::cross(back, right), back};
}

// The distance from `middle` along frame.back at which everything is inside the picture. A point at (x, y, z)
// in the frame is inside if |y| <= (D - z) tan, so D = z + |y| / tan; a sphere of radius r needs r / sin
// more, from the cone's tangent.
double viewingDistance(const Scene& scene, const Frame& frame, const glm::dvec3& middle) {
    const double tanY = std::tan(kFovY * std::numbers::pi / 360) / kMargin;
    const double tanX = tanY * scene.image.width / scene.image.height;
    const double sinX = tanX / std::sqrt(1 + tanX * tanX), sinY = tanY / std::sqrt(1 + tanY * tanY);
    double distance = 0;
    forEachPoint(scene, [&](const glm::dvec3& point, double radius) {
        const glm::dvec3 d = point - middle;
        const double z = glm::dot(d, frame.back);
        distance = std::max({distance, z + std::abs(glm::dot(d, frame.right)) / tanX + radius / sinX,
                             z + std::abs(glm::dot(d, frame.up)) / tanY + radius / sinY});
    });
    return distance;
}

}  // namespace

void frameModel(Scene& scene) {
    scene.maxDepth = 5;
    scene.background = Color(0.42, 0.50, 0.60);
    scene.ambient = Color(0.2);

    const Frame frame = viewFrame();
    if (scene.lights.empty()) {
        // The key light of portraits: from the viewer's upper left. It falls on the front and the top of a
        // box and leaves its right side to the ambient light, so that the three differ.
        const glm::dvec3 towardsLight = -0.45 * frame.right + 0.75 * frame.up + 0.8 * frame.back;
        scene.lights.push_back(DirectionalLight{-glm::normalize(towardsLight), Color(0.9)});
    }

    Box box;
    forEachPoint(scene, [&](const glm::dvec3& point, double radius) {
        box.add(point - glm::dvec3(radius));
        box.add(point + glm::dvec3(radius));
    });
    if (box.empty()) {
        scene.camera = Camera{};
        return;
    }
    const glm::dvec3 middle = box.low + 0.5 * (box.high - box.low);
    double distance = viewingDistance(scene, frame, middle);
    // A single point has no size to go by; stay far enough away for the eye to differ from it in double and
    // in float.
    distance = std::max({distance, 1e-6 * glm::length(middle), 1e-12});

    scene.camera = Camera{};
    scene.camera.target = middle;
    scene.camera.eye = middle + distance * frame.back;
    scene.camera.fovY = kFovY;
}

}  // namespace glint
