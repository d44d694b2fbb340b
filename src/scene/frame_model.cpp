#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/vectors.h"
#include "scene/cameras.h"
#include "scene/frame_model.h"
#include "scene/transform.h"

namespace glint {

namespace {

// Towards the eye, from the middle of the model: in front (+z), to the right and above.
constexpr glm::dvec3 kTowardsEye{0.42, 0.40, 1.0};
constexpr double kFovY = 40;
constexpr double kMargin = 1.08;  // of the picture's half size that stays free around the model, as a factor

// Which vertices of a mesh triangles without a bad one have.
std::vector<uint8_t> drawnVertices(const Mesh& mesh) {
    const auto& p = mesh.positions;
    const bool allFinite = std::all_of(p.begin(), p.end(), isFinite);
    std::vector<uint8_t> drawn(p.size());
    for (const glm::uvec3& c : mesh.corners)
        if (allFinite || (isFinite(p[c.x]) && isFinite(p[c.y]) && isFinite(p[c.z])))
            drawn[c.x] = drawn[c.y] = drawn[c.z] = 1;
    return drawn;
}

// Receives a part of an object: the image of the unit ball, center + axes b, which reaches |axes^T n| from
// its centre in the unit direction n. The axes of a point are null, and the third axis of a disc is zero.
using Visit = std::function<void(const glm::dvec3& center, const glm::dmat3* axes)>;

// Visits parts that together hold the finite geometry of a shape that will be drawn. Triangles of meshes with
// a bad vertex are left out; planes have no size.
class PartVisitor {
  public:
    PartVisitor(const Affine& transform, const Visit& visit) : transform_(transform), visit_(visit) {}

    void operator()(const SphereShape& s) const { ball(s.center, glm::dmat3(s.radius)); }
    void operator()(const PlaneShape&) const {}
    void operator()(const DiscShape& s) const { disc(s.center, s.normal, s.radius); }
    void operator()(const BoxShape& s) const { corners(s.min, s.max); }
    void operator()(const TriangleShape& s) const {
        for (const glm::dvec3& vertex : s.vertices) point(vertex);
    }
    void operator()(const PolygonShape& s) const {
        for (const glm::dvec3& vertex : s.vertices) point(vertex);
    }
    void operator()(const QuadricShape& s) const { corners(s.lo, s.hi); }
    void operator()(const EllipsoidShape& s) const {
        ball(s.center, {{s.radii.x, 0, 0}, {0, s.radii.y, 0}, {0, 0, s.radii.z}});
    }
    // Surfaces of revolution whose profile is straight or bends towards the axis end in their widest circles.
    void operator()(const CylinderShape& s) const { ends(s.base, s.radius, s.top, s.radius); }
    void operator()(const ConeShape& s) const { ends(s.base, s.radius, s.apex, s.topRadius); }
    void operator()(const HyperboloidShape& s) const { ends(s.base, s.radius, s.top, s.radius); }
    void operator()(const ParaboloidShape& s) const {
        // It bulges out of the hull of vertex and rim, but not out of a cylinder about it.
        ends(s.vertex, s.radius, s.top, s.radius);
    }
    void operator()(const MeshShape& s) const {
        const auto& p = s.mesh->positions;
        const std::vector<uint8_t> drawn = drawnVertices(*s.mesh);
        for (size_t i = 0; i < p.size(); ++i)
            if (drawn[i] != 0) point(p[i]);
    }

    void corners(const glm::dvec3& lo, const glm::dvec3& hi) const {
        for (int i = 0; i < 8; i++) point({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
    }

  private:
    glm::dvec3 world(const glm::dvec3& p) const { return apply(transform_, p); }
    void point(const glm::dvec3& p) const { visit_(world(p), nullptr); }
    void ball(const glm::dvec3& center, const glm::dmat3& axes) const {
        const glm::dmat3 inWorld = transform_.linear * axes;
        visit_(world(center), &inWorld);
    }
    void disc(const glm::dvec3& center, const glm::dvec3& normal, double radius) const {
        const glm::dvec3 n = glm::normalize(normal);
        const glm::dvec3 a =
            glm::normalize(glm::cross(n, std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        ball(center, {radius * a, radius * glm::cross(n, a), glm::dvec3(0)});
    }
    void ends(const glm::dvec3& p, double pRadius, const glm::dvec3& q, double qRadius) const {
        disc(p, q - p, pRadius);
        disc(q, q - p, qRadius);
    }

    Affine transform_;
    const Visit& visit_;
};

// Visits the box corners of meshes with several instances, so that time does not grow with the number of
// instances.
void forEachPart(const Scene& scene, const Visit& visit) {
    std::map<const Mesh*, std::pair<size_t, BoundingBox>> shared;
    for (const Object& object : scene.objects)
        if (const auto* shape = std::get_if<MeshShape>(&object.shape)) shared[shape->mesh.get()].first++;
    for (const Object& object : scene.objects) {
        const PartVisitor visitor(object.transform.value_or(Affine{}), visit);
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (!shape || shared[shape->mesh.get()].first == 1) {
            std::visit(visitor, object.shape);
            continue;
        }
        BoundingBox& box = shared[shape->mesh.get()].second;
        if (box.empty()) {
            const Visit add = [&box](const glm::dvec3& center, const glm::dmat3*) { box.include(center); };
            PartVisitor({}, add)(*shape);
        }
        if (!box.empty()) visitor.corners(box.lo, box.hi);
    }
}

// How far a part reaches in a direction.
double reach(const glm::dmat3* axes, const glm::dvec3& direction) {
    return axes == nullptr ? 0 : glm::length(direction * *axes);  // axes^T direction
}

CameraFrame viewFrame(UpAxis up) {
    Camera camera;
    camera.eye = fromYUp(kTowardsEye, up);
    camera.up = fromYUp(camera.up, up);
    return cameraFrame(camera);
}

// The distance from `middle` along frame.w at which everything is inside the picture. The sides of the
// picture are planes through the eye with the outward normals n = cos a (+-right or +-up) + sin a back, a
// half the picture's angle; p is inside if n.(p - eye) <= 0, that is with eye = middle + D back if D >= n.(p
// - middle) / sin a.
double viewingDistance(const Scene& scene, const CameraFrame& frame, const glm::dvec3& middle) {
    const double tanY = std::tan(kFovY * std::numbers::pi / 360) / kMargin;
    const double tanX = tanY * scene.image.width / scene.image.height;
    double distance = 0;
    const glm::dvec3 normals[] = {frame.u / tanX + frame.w, -frame.u / tanX + frame.w,
                                  frame.v / tanY + frame.w, -frame.v / tanY + frame.w};  // n / sin a
    forEachPart(scene, [&](const glm::dvec3& center, const glm::dmat3* axes) {
        for (const glm::dvec3& normal : normals)
            distance = std::max(distance, glm::dot(normal, center - middle) + reach(axes, normal));
    });
    return distance;
}

}  // namespace

glm::dvec3 fromYUp(const glm::dvec3& v, UpAxis up) {
    return up == UpAxis::Z ? glm::dvec3(v.x, -v.z, v.y) : up == UpAxis::X ? glm::dvec3(v.y, v.z, v.x) : v;
}

void frameModel(Scene& scene, UpAxis up) {
    scene.maxDepth = 5;
    scene.background = kModelBackground;
    scene.ambient = kModelAmbient;
    frameCamera(scene, up);
    if (scene.lights.empty()) lightModel(scene);
}

void lightModel(Scene& scene) {
    const CameraFrame frame = cameraFrame(scene.camera);
    // The key light of portraits: from the viewer's upper left. It falls on the front and the top of a box
    // and leaves its right side to the ambient light, so that the three differ.
    const glm::dvec3 towardsLight = -0.45 * frame.u + 0.75 * frame.v + 0.8 * frame.w;
    scene.lights.push_back(DirectionalLight{-glm::normalize(towardsLight), Color(0.9)});
}

void frameCamera(Scene& scene, UpAxis up) {
    scene.camera = Camera{};
    scene.camera.up = fromYUp(scene.camera.up, up);
    const CameraFrame frame = viewFrame(up);
    BoundingBox box;
    forEachPart(scene, [&](const glm::dvec3& center, const glm::dmat3* axes) {
        const glm::dvec3 extent(reach(axes, {1, 0, 0}), reach(axes, {0, 1, 0}), reach(axes, {0, 0, 1}));
        box.include(center - extent);
        box.include(center + extent);
    });
    if (box.empty()) return;
    const glm::dvec3 middle = box.lo + 0.5 * (box.hi - box.lo);
    double distance = viewingDistance(scene, frame, middle);
    // A single point has no size to go by; stay far enough away for the eye to differ from it in double and
    // in float.
    distance = std::max({distance, 1e-6 * glm::length(middle), 1e-12});

    scene.camera.target = middle;
    scene.camera.eye = middle + distance * frame.w;
    scene.camera.fovY = kFovY;
}

}  // namespace glint
