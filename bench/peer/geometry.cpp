#include "peer/geometry.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

#include "import/mesh_builder.h"
#include "pack/pack_textures.h"
#include "rays.h"
#include "scene/polygon_plane.h"

namespace glint::bench::peer {
namespace {

using glm::dvec3;
using glm::vec3;
using glm::vec4;

dvec3 apply(const Affine& place, const dvec3& point) {
    return place.linear * point + place.offset;
}

glm::mat3 normalMatrixOf(const glm::dmat3& linear) {
    return glm::mat3(glm::transpose(glm::inverse(linear)));
}

template <class T>
T* newBuffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t count) {
    return static_cast<T*>(rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count));
}

}  // namespace

Geometry::Geometry(const Scene& scene, const Materials& materials, const dvec3& origin)
    : scene_(scene),
      materials_(materials),
      origin_(origin),
      colored_(scene.transmissiveShadows == TransmissiveShadows::Colored) {
    spheres_.kind = Kind::Spheres;
    discs_.kind = Kind::Discs;
    flats_.kind = Kind::Flats;
    device_ = rtcNewDevice("threads=2,set_affinity=0");
    embree_ = rtcNewScene(device_);
    const Timer timer;
    for (const Object& object : scene.objects) add(object);
    if (!sphereRows_.empty()) attach(embree_, pointGeometry(spheres_, sphereRows_, {}), spheres_);
    if (!discRows_.empty()) attach(embree_, pointGeometry(discs_, discRows_, discNormals_), discs_);
    if (!flatVertices_.empty()) attach(embree_, flatGeometry(), flats_);
    rtcCommitScene(embree_);
    buildSeconds_ = timer.elapsed().wall;
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree: error " + std::to_string(error));
}

Geometry::~Geometry() {
    for (const auto& [key, prototype] : prototypes_) rtcReleaseScene(prototype.first);
    rtcReleaseScene(embree_);
    rtcReleaseDevice(device_);
}

Geometry::Item Geometry::itemOf(const Object& object) {
    frames_.push_back(objectFrame(scene_, object, origin_, {}));
    Item item;
    item.frame = static_cast<uint32_t>(frames_.size() - 1);
    item.material = object.material;
    return item;
}

void Geometry::add(const Object& object) {
    if (const auto* sphere = std::get_if<SphereShape>(&object.shape)) {
        Item item = itemOf(object);
        item.center = sphere->center - origin_;
        sphereRows_.emplace_back(item.center, static_cast<float>(sphere->radius));
        spheres_.items.push_back(item);
    } else if (const auto* ball = std::get_if<EllipsoidShape>(&object.shape)) {
        glm::dmat3 radii(0);
        for (int i = 0; i < 3; ++i) radii[i][i] = ball->radii[i];
        const Affine own = object.transform.value_or(Affine{});
        const Part* part = nullptr;
        const RTCScene prototype = prototypeOf(object, part);
        addInstance(object, prototype, *part, {own.linear * radii, apply(own, ball->center)});
    } else if (const auto* plane = std::get_if<PlaneShape>(&object.shape)) {
        Item item = itemOf(object);
        item.center = plane->point - origin_;
        item.normal = glm::normalize(plane->normal);
        planes_.push_back(item);
    } else if (const auto* disc = std::get_if<DiscShape>(&object.shape)) {
        if (object.transform) {
            const Part* part = nullptr;
            const RTCScene prototype = prototypeOf(object, part);
            addInstance(object, prototype, *part, *object.transform);
            return;
        }
        Item item = itemOf(object);
        item.center = disc->center - origin_;
        item.normal = glm::normalize(disc->normal);
        discRows_.emplace_back(item.center, static_cast<float>(disc->radius));
        discNormals_.push_back(item.normal);
        discs_.items.push_back(item);
    } else if (const auto* triangle = std::get_if<TriangleShape>(&object.shape)) {
        Item item = itemOf(object);
        item.byCorners = true;
        item.swapped = glm::determinant(object.applied.linear) < 0;
        addTriangle(item, triangle->vertices[0], triangle->vertices[1], triangle->vertices[2]);
    } else if (std::holds_alternative<PolygonShape>(object.shape)) {
        addPolygon(object);
    } else if (std::holds_alternative<BoxShape>(object.shape)) {
        addBox(object);
    } else if (std::holds_alternative<MeshShape>(object.shape)) {
        addMesh(object);
    } else {
        throw std::invalid_argument("has quadrics");
    }
}

void Geometry::addTriangle(const Item& item, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 normal = glm::cross(b - a, c - a);
    if (glm::dot(normal, normal) == 0) return;
    Item own = item;
    own.normal = glm::normalize(normal);
    for (const dvec3& corner : {a, b, c}) flatVertices_.emplace_back(corner - origin_);
    flats_.items.push_back(own);
}

void Geometry::addPolygon(const Object& object) {
    const std::vector<dvec3>& v = std::get<PolygonShape>(object.shape).vertices;
    const auto plane = polygonPlane(v);
    if (!plane) return;
    std::vector<std::array<uint32_t, 3>> triangles;
    if (!splitPolygon(v, triangles)) throw std::invalid_argument("has polygons that cross themselves");
    const Item item = itemOf(object);
    for (const auto& [a, b, c] : triangles) {
        const size_t before = flats_.items.size();
        addTriangle(item, v[a], v[b], v[c]);
        if (flats_.items.size() > before) flats_.items.back().normal = plane->normal;
    }
}

// Six polygons with the texture coordinates of their own extents.
void Geometry::addBox(const Object& object) {
    const auto& box = std::get<BoxShape>(object.shape);
    const Affine place = object.transform.value_or(Affine{});
    for (int axis = 0; axis < 3; ++axis) {
        for (const bool far : {false, true}) {
            const int j = (axis + 1) % 3, k = (axis + 2) % 3;
            std::vector<dvec3> corners(4, far ? box.max : box.min);
            const double js[] = {box.min[j], box.max[j], box.max[j], box.min[j]};
            const double ks[] = {box.min[k], box.min[k], box.max[k], box.max[k]};
            for (size_t i = 0; i < 4; ++i) {
                corners[far ? i : 3 - i][j] = js[i];
                corners[far ? i : 3 - i][k] = ks[i];
            }
            Object face = object;
            face.shape = PolygonShape{corners};
            const Item item = itemOf(face);
            for (dvec3& corner : corners) corner = apply(place, corner);
            if (glm::determinant(place.linear) < 0) std::swap(corners[1], corners[3]);
            addTriangle(item, corners[0], corners[1], corners[2]);
            addTriangle(item, corners[0], corners[2], corners[3]);
        }
    }
}

void Geometry::addMesh(const Object& object) {
    if (object.transform) {  // the reader has found that sharing pays
        const Part* part = nullptr;
        const RTCScene prototype = prototypeOf(object, part);
        addInstance(object, prototype, *part, *object.transform);
        return;
    }
    Part& part = parts_.emplace_back();
    part.mesh = std::get<MeshShape>(object.shape).mesh;
    part.items.push_back(itemOf(object));
    attach(embree_, meshGeometry(part, {glm::dmat3(1), -origin_}), part);
}

RTCScene Geometry::prototypeOf(const Object& object, const Part*& part) {
    static const char kBall = 0, kPlate = 0;
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    const bool plate = std::holds_alternative<DiscShape>(object.shape);
    const void* const key = mesh ? static_cast<const void*>(mesh->mesh.get()) : plate ? &kPlate : &kBall;
    auto& [scene, known] = prototypes_[key];
    if (known == nullptr) {
        scene = rtcNewScene(device_);
        Part& made = parts_.emplace_back();
        known = &made;
        made.kind = mesh ? Kind::Mesh : plate ? Kind::Discs : Kind::Spheres;
        made.items.emplace_back();
        made.items.back().material = object.material;
        made.items.back().normal = {0, 0, 1};
        if (mesh) made.mesh = mesh->mesh;
        if (plate) made.items.back().normal = std::get<DiscShape>(object.shape).normal;
        const RTCGeometry geometry =
            mesh ? meshGeometry(made, {})
                 : pointGeometry(made, {vec4(0, 0, 0, 1)},
                                 plate ? std::vector<vec3>{made.items.back().normal} : std::vector<vec3>{});
        // Any of its instances may be of glass or have holes, if anything has.
        for (uint32_t i = 0; i < scene_.materials.size(); ++i) made.filtered |= open(i);
        attach(scene, geometry, made);
        rtcCommitScene(scene);
    }
    part = known;
    return scene;
}

void Geometry::addInstance(const Object& object, RTCScene prototype, const Part& part,
                           const Affine& transform) {
    const Item item = itemOf(object);
    Instance instance;
    instance.part = &part;
    instance.frame = item.frame;
    instance.material = item.material;
    instance.linear = transform.linear;
    instance.normalMatrix = normalMatrixOf(transform.linear);
    instance.offset = transform.offset - origin_;
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, prototype);
    std::array<vec3, 4> columns = {instance.linear[0], instance.linear[1], instance.linear[2],
                                   instance.offset};
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(geometry);
    const uint32_t number = rtcAttachGeometry(embree_, geometry);
    rtcReleaseGeometry(geometry);
    partOf_.resize(std::max<size_t>(partOf_.size(), number + 1));
    instanceOf_.resize(std::max<size_t>(instanceOf_.size(), number + 1));
    instanceOf_[number] = static_cast<uint32_t>(instances_.size());
    instances_.push_back(instance);
}

RTCGeometry Geometry::meshGeometry(Part& part, const Affine& place) {
    const Mesh& mesh = *part.mesh;
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const vertices = newBuffer<std::array<float, 3>>(geometry, RTC_BUFFER_TYPE_VERTEX,
                                                           RTC_FORMAT_FLOAT3, mesh.positions.size());
    auto* const corners = newBuffer<std::array<uint32_t, 3>>(geometry, RTC_BUFFER_TYPE_INDEX,
                                                             RTC_FORMAT_UINT3, mesh.corners.size());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const vec3 p = apply(place, mesh.positions[i]);
        vertices[i] = {p.x, p.y, p.z};
    }
    for (size_t i = 0; i < mesh.corners.size(); ++i)
        corners[i] = {mesh.corners[i].x, mesh.corners[i].y, mesh.corners[i].z};
    for (const dvec3& n : mesh.normals) part.normals.emplace_back(glm::normalize(n));
    return geometry;
}

RTCGeometry Geometry::pointGeometry(const Part& part, const std::vector<vec4>& rows,
                                    const std::vector<vec3>& normals) {
    const RTCGeometry geometry =
        rtcNewGeometry(device_, part.kind == Kind::Spheres ? RTC_GEOMETRY_TYPE_SPHERE_POINT
                                                           : RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    auto* const points = newBuffer<vec4>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, rows.size());
    std::memcpy(points, rows.data(), rows.size() * sizeof(vec4));
    if (!normals.empty()) {
        auto* const directions =
            newBuffer<vec3>(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, normals.size());
        std::memcpy(directions, normals.data(), normals.size() * sizeof(vec3));
    }
    return geometry;
}

RTCGeometry Geometry::flatGeometry() {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const vertices =
        newBuffer<vec3>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, flatVertices_.size());
    std::memcpy(vertices, flatVertices_.data(), flatVertices_.size() * sizeof(vec3));
    auto* const corners =
        newBuffer<uint32_t[3]>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, flatVertices_.size() / 3);
    for (uint32_t i = 0; i < flatVertices_.size(); ++i) corners[i / 3][i % 3] = i;
    return geometry;
}

// Whether rays may go through some of what they hit there.
bool Geometry::open(uint32_t material) const {
    const Material& m = materials_[material];
    return m.alphaCutoff > 0 || (m.dielectric && colored_);
}

bool Geometry::seenThrough(const Part& part) const {
    for (const Item& item : part.items)
        if (open(item.material)) return true;
    if (part.mesh)
        for (const uint32_t material : part.mesh->materials)
            if (open(material)) return true;
    return false;
}

uint32_t Geometry::attach(RTCScene scene, RTCGeometry geometry, Part& part) {
    part.owner = this;
    part.filtered = part.filtered || seenThrough(part);
    rtcSetGeometryUserData(geometry, &part);
    if (part.filtered) {
        rtcSetGeometryIntersectFilterFunction(geometry, filterHit);
        rtcSetGeometryOccludedFilterFunction(geometry, filterShadow);
    }
    rtcCommitGeometry(geometry);
    const uint32_t number = rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    if (scene == embree_) {
        partOf_.resize(std::max<size_t>(partOf_.size(), number + 1));
        instanceOf_.resize(std::max<size_t>(instanceOf_.size(), number + 1));
        partOf_[number] = &part;
    }
    return number;
}

}  // namespace glint::bench::peer
