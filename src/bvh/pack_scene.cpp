#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "bvh/area_vector.h"
#include "bvh/flatten.h"
#include "bvh/packed_scene.h"
#include "bvh/primitives.h"
#include "bvh/quadrics.h"
#include "bvh/region.h"
#include "bvh/unit_vector.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "scene/polygon_plane.h"
#include "shared/dispatch.h"

namespace glint {
namespace {

constexpr size_t kChunk = 32768;  // primitives that one thread writes at a time

shared::Material roundMaterial(const Material& material) {
    shared::Material out;
    out.ambient = glm::vec3(material.ambient);
    out.diffuse = glm::vec3(material.diffuse);
    out.specular = glm::vec3(material.specular);
    out.shininess = static_cast<float>(material.shininess);
    out.mirror = glm::vec3(material.mirror);
    return out;
}

// 1 - cos, without its cancellation for small angles.
float oneMinusCosine(double degrees) {
    const double half = std::sin(degrees * (std::numbers::pi / 360));
    return static_cast<float>(2 * half * half);
}

shared::Light roundLight(const Light& light, const glm::dvec3& origin) {
    shared::Light out;
    if (const auto* point = std::get_if<PointLight>(&light)) {
        out.position = glm::vec3(point->position - origin);
        out.kind = point->inverseSquare ? shared::kLightPointInverseSquare : shared::kLightPoint;
        out.intensity = glm::vec3(point->intensity);
    } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
        out.position = glm::vec3(spot->position - origin);
        out.kind = spot->inverseSquare ? shared::kLightSpotInverseSquare : shared::kLightSpot;
        out.intensity = glm::vec3(spot->intensity);
        out.axis = glm::vec3(unitVector(spot->direction).value());
        out.inner = oneMinusCosine(spot->angle);
        out.outer = oneMinusCosine(spot->angle + spot->penumbra);
    } else {
        const auto& directional = std::get<DirectionalLight>(light);
        out.position = glm::vec3(unitVector(-directional.direction).value());
        out.kind = shared::kLightDirectional;
        out.intensity = glm::vec3(directional.intensity);
    }
    return out;
}

void packPlanes(const Scene& scene, const PrimitiveNumbers& numbers, const Region& region,
                PackedScene& packed) {
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const auto* plane = std::get_if<PlaneShape>(&scene.objects[i].shape);
        if (plane == nullptr) continue;
        const glm::dvec3 normal = unitVector(plane->normal).value();
        shared::Plane out;
        out.point = glm::vec3(planeAnchor(plane->point, normal, region) - packed.origin);
        out.normal = glm::vec3(normal);
        out.id = numbers.firstId(i);
        out.object = i;
        out.material = scene.objects[i].material;
        packed.planes.push_back(out);
    }
    checkLimit("planes", packed.planes.size(), shared::kMaxPlanes);
}

// The three unit vertex normals of a triangle; false if any of them is missing, zero or not finite.
bool vertexNormals(const Mesh* mesh, uint32_t face, shared::VertexNormals& out) {
    if (mesh == nullptr || mesh->normalCorners.empty()) return false;
    const glm::uvec3 corners = mesh->normalCorners[face];
    glm::vec3* const normals[3] = {&out.n0, &out.n1, &out.n2};
    for (int i = 0; i < 3; ++i) {
        if (corners[i] == Mesh::kNoIndex) return false;
        const auto unit = unitVector(mesh->normals[corners[i]]);
        if (!unit) return false;
        *normals[i] = glm::vec3(*unit);
    }
    return true;
}

// Length of a polygon's part of the vertex array: its edges and those without length that fill the last trip.
uint32_t packedVertices(const PolygonShape& polygon) {
    return polygonTrips(polygon.vertices.size()) * shared::kPolygonEdgesPerTrip + 1;
}

// Writes what is in the BVH to the arrays of its kinds in the order of the BVH's leaves.
class LeafOrderWriter {
  public:
    LeafOrderWriter(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                    const Primitives& primitives, const std::vector<uint32_t>& order, PackedScene& packed)
        : scene_(scene),
          numbers_(numbers),
          frame_(frame),
          primitives_(primitives),
          order_(order),
          packed_(packed),
          used_(scene.materials.size()) {}

    void write(unsigned threads);
    bool used(size_t material) const { return used_[material].load(std::memory_order_relaxed); }
    void use(size_t material) {
        // Read first: many threads writing the same byte would pass its cache line around.
        if (!used(material)) used_[material].store(true, std::memory_order_relaxed);
    }

  private:
    struct Counts {
        std::array<uint32_t, shared::kKindCount> kinds{};
        uint32_t normals = 0, polygonVertices = 0;
    };
    template <class Visit>
    void visitChunk(size_t chunk, Visit&& visit) const {
        const size_t end = std::min(order_.size(), (chunk + 1) * kChunk);
        for (size_t i = chunk * kChunk; i < end; ++i) visit(order_[i], primitives_.sources[order_[i]]);
    }
    Counts count(size_t chunk) const;
    void writeChunk(size_t chunk, Counts next);
    void writeTriangle(Primitives::Source source, uint32_t slot, uint32_t normals);
    void writeSphere(Primitives::Source source, uint32_t slot);
    void writeDisc(Primitives::Source source, uint32_t slot);
    void writePolygon(Primitives::Source source, uint32_t slot, uint32_t firstVertex);
    void writeQuadric(Primitives::Source source, uint32_t slot);

    const Scene& scene_;
    const PrimitiveNumbers& numbers_;
    const Frame& frame_;
    const Primitives& primitives_;
    const std::vector<uint32_t>& order_;
    PackedScene& packed_;
    std::vector<std::atomic<bool>> used_;
};

void LeafOrderWriter::write(unsigned threads) {
    const size_t chunks = (order_.size() + kChunk - 1) / kChunk;
    std::vector<Counts> first(chunks);
    parallelFor(
        chunks, [&](size_t i) { first[i] = count(i); }, threads);
    Counts total;
    for (Counts& c : first) {
        const Counts here = c;
        c = total;
        for (uint32_t kind = 0; kind < shared::kKindCount; ++kind) total.kinds[kind] += here.kinds[kind];
        total.normals += here.normals;
        total.polygonVertices += here.polygonVertices;
    }
    packed_.triangles.resize(total.kinds[shared::kKindTriangle]);
    packed_.triangleSurfaces.resize(total.kinds[shared::kKindTriangle]);
    packed_.spheres.resize(total.kinds[shared::kKindSphere]);
    packed_.discs.resize(total.kinds[shared::kKindDisc]);
    packed_.polygons.resize(total.kinds[shared::kKindPolygon]);
    packed_.quadrics.resize(total.kinds[shared::kKindQuadric]);
    packed_.polygonVertices.resize(total.polygonVertices);
    packed_.vertexNormals.resize(total.normals);
    parallelFor(
        chunks, [&](size_t i) { writeChunk(i, first[i]); }, threads);
}

LeafOrderWriter::Counts LeafOrderWriter::count(size_t chunk) const {
    Counts counts;
    shared::VertexNormals normals;
    visitChunk(chunk, [&](uint32_t primitive, Primitives::Source source) {
        ++counts.kinds[primitives_.kinds[primitive]];
        if (primitives_.kinds[primitive] == shared::kKindTriangle) {
            const TriangleSource triangles(scene_.objects[source.object]);
            counts.normals += vertexNormals(triangles.mesh(), source.face, normals);
        } else if (const auto* polygon = std::get_if<PolygonShape>(&scene_.objects[source.object].shape)) {
            counts.polygonVertices += packedVertices(*polygon);
        }
    });
    return counts;
}

void LeafOrderWriter::writeChunk(size_t chunk, Counts next) {
    visitChunk(chunk, [&](uint32_t primitive, Primitives::Source source) {
        const uint8_t kind = primitives_.kinds[primitive];
        const uint32_t slot = next.kinds[kind]++;
        if (kind == shared::kKindSphere) return writeSphere(source, slot);
        if (kind == shared::kKindDisc) return writeDisc(source, slot);
        if (kind == shared::kKindQuadric) return writeQuadric(source, slot);
        if (const auto* polygon = std::get_if<PolygonShape>(&scene_.objects[source.object].shape)) {
            writePolygon(source, slot, next.polygonVertices);
            next.polygonVertices += packedVertices(*polygon);
            return;
        }
        const TriangleSource triangles(scene_.objects[source.object]);
        shared::VertexNormals normals;
        const bool smooth = vertexNormals(triangles.mesh(), source.face, normals);
        if (smooth) packed_.vertexNormals[next.normals] = normals;
        writeTriangle(source, slot, smooth ? next.normals++ : shared::kNone);
    });
}

void LeafOrderWriter::writeTriangle(Primitives::Source source, uint32_t slot, uint32_t normals) {
    const Object& object = scene_.objects[source.object];
    const TriangleSource triangles(object);
    const Corners v = roundTriangle(triangles.vertices(source.face), frame_.origin).value();
    shared::Triangle& triangle = packed_.triangles[slot];
    triangle.v0 = v[0];
    triangle.v1 = v[1];
    triangle.v2 = v[2];
    triangle.id = numbers_.firstId(source.object) + source.face;

    const Mesh* mesh = triangles.mesh();
    shared::TriangleSurface& surface = packed_.triangleSurfaces[slot];
    surface.normal = glm::vec3(unitVector(areaVector(v[0], v[1], v[2])).value());
    surface.object = source.object;
    surface.primitive = mesh != nullptr && !mesh->faces.empty() ? mesh->faces[source.face] : source.face;
    surface.material =
        mesh != nullptr && !mesh->materials.empty() ? mesh->materials[source.face] : object.material;
    surface.vertexNormals = normals;
    use(surface.material);
}

void LeafOrderWriter::writeSphere(Primitives::Source source, uint32_t slot) {
    const Object& object = scene_.objects[source.object];
    shared::Sphere& sphere = packed_.spheres[slot];
    sphere = roundSphere(std::get<SphereShape>(object.shape), frame_);
    sphere.id = numbers_.firstId(source.object);
    sphere.object = source.object;
    sphere.material = object.material;
    use(sphere.material);
}

void LeafOrderWriter::writeDisc(Primitives::Source source, uint32_t slot) {
    const Object& object = scene_.objects[source.object];
    shared::Disc& disc = packed_.discs[slot];
    disc = roundDisc(std::get<DiscShape>(object.shape), frame_);
    disc.id = numbers_.firstId(source.object);
    disc.object = source.object;
    disc.material = object.material;
    use(disc.material);
}

void LeafOrderWriter::writePolygon(Primitives::Source source, uint32_t slot, uint32_t firstVertex) {
    const Object& object = scene_.objects[source.object];
    const auto& shape = std::get<PolygonShape>(object.shape);
    const std::vector<glm::vec3> vertices = roundPolygon(shape, frame_.origin).value();
    const PolygonPlane plane = polygonPlane(widened(vertices)).value();
    shared::Polygon& polygon = packed_.polygons[slot];
    polygon.point = glm::vec3(plane.point);
    polygon.normal = glm::vec3(plane.normal);
    polygon.id = numbers_.firstId(source.object);
    polygon.object = source.object;
    polygon.material = object.material;
    polygon.firstVertex = firstVertex;
    polygon.trips = polygonTrips(vertices.size());
    for (uint32_t i = 0; i < packedVertices(shape); ++i)
        packed_.polygonVertices[firstVertex + i].position = vertices[i < vertices.size() ? i : 0];
    use(polygon.material);
}

void LeafOrderWriter::writeQuadric(Primitives::Source source, uint32_t slot) {
    const Object& object = scene_.objects[source.object];
    shared::Quadric& quadric = packed_.quadrics[slot];
    quadric = roundQuadric(object, frame_);
    quadric.id = numbers_.firstId(source.object);
    quadric.object = source.object;
    quadric.material = object.material;
    use(quadric.material);
}

// A leaf of polygons must not take more trips than one polygon may: the device cannot stop within a leaf.
void limitPolygonTrips(const Scene& scene, BvhOptions& options, PackedScene& packed) {
    uint32_t trips = 0;
    for (const Object& object : scene.objects)
        if (const auto* polygon = std::get_if<PolygonShape>(&object.shape))
            trips = std::max(trips, polygonTrips(polygon->vertices.size()));
    if (trips == 0) return;
    options.maxLeafSize = std::clamp(shared::kMaxPolygonTrips / trips, 1u, options.maxLeafSize);
    // Two more for each polygon: the end of its loop and that of the leaf.
    packed.polygonTripsPerLeaf = options.maxLeafSize * (trips + 2);
}

void fillStatistics(const Bvh& bvh, double traversalCost, PackStatistics& statistics) {
    statistics.depth = bvh.depth;
    if (bvh.nodes.empty()) return;
    // A random line that meets a convex box meets one inside it with the chance of their areas' ratio; where
    // both are points or lines, it meets both.
    const double rootArea = bvh.nodes[0].box.halfArea();
    for (const BvhNode& node : bvh.nodes) {
        const double chance = rootArea > 0 ? node.box.halfArea() / rootArea : 1.0;
        statistics.sahCost += chance * (node.count > 0 ? node.count : traversalCost);
        statistics.leaves += node.count > 0;
    }
}

void addLightKind(const shared::Light& light, SceneFeatures& features) {
    switch (light.kind) {
        case shared::kLightDirectional:
            features.directionalLights = true;
            break;
        case shared::kLightSpot:
        case shared::kLightSpotInverseSquare:
            features.spotLights = true;
            break;
        default:
            features.pointLights = true;
    }
}

template <class Used>
SceneFeatures featuresOf(const PackedScene& packed, Used&& used) {
    SceneFeatures f;
    f.triangles = !packed.triangles.empty();
    f.spheres = !packed.spheres.empty();
    for (const shared::Sphere& s : packed.spheres) f.anchoredSpheres |= s.anchorNormal != glm::vec3(0);
    f.planes = !packed.planes.empty();
    f.discs = !packed.discs.empty();
    f.polygons = !packed.polygons.empty();
    f.quadrics = !packed.quadrics.empty();
    f.vertexNormals = !packed.vertexNormals.empty();
    for (const shared::Light& light : packed.lights) addLightKind(light, f);
    for (size_t i = 0; i < packed.materials.size(); ++i) {
        if (!used(i)) continue;
        f.specular |= packed.materials[i].specular != glm::vec3(0);
        f.mirrors |= packed.environment.maxDepth > 0 && packed.materials[i].mirror != glm::vec3(0);
    }
    return f;
}

void packEnvironment(const Scene& scene, PackedScene& packed) {
    for (const Material& material : scene.materials) packed.materials.push_back(roundMaterial(material));
    for (const Light& light : scene.lights) packed.lights.push_back(roundLight(light, packed.origin));
    shared::Environment& environment = packed.environment;
    environment.background = glm::vec3(scene.background);
    environment.ambient = glm::vec3(scene.ambient);
    environment.root = packed.nodes.empty() ? shared::kNone : 0;
    environment.planeCount = static_cast<uint32_t>(packed.planes.size());
    environment.lightCount = static_cast<uint32_t>(packed.lights.size());
    environment.maxDepth = static_cast<uint32_t>(scene.maxDepth);
}

}  // namespace

SceneFeatures allFeatures() {
    SceneFeatures f;
#define GLINT_SET(ID, NAME, field) f.field = true;
    GLINT_FEATURES(GLINT_SET)
#undef GLINT_SET
    return f;
}

PackedScene packScene(const Scene& scene, unsigned threads) {
    const PrimitiveNumbers numbers(scene);
    const Region region = sceneRegion(scene, numbers, threads);
    PackedScene packed;
    packed.origin = originOf(region);
    packPlanes(scene, numbers, region, packed);

    const Frame frame{packed.origin, scene.camera.eye};
    Primitives primitives =
        collectPrimitives(scene, numbers, frame, threads, packed.statistics, packed.warnings);
    BvhOptions options;
    options.maxDepth = shared::kMaxBvhDepth;
    options.threads = threads;
    const auto kinds = std::count_if(primitives.counts.begin(), primitives.counts.end(),
                                     [](uint32_t count) { return count > 0; });
    if (kinds > 1) options.groups = &primitives.kinds;
    limitPolygonTrips(scene, options, packed);
    const Stopwatch stopwatch;
    Bvh bvh = buildBvh(primitives.boxes, options);
    packed.statistics.buildSeconds = stopwatch.seconds();
    primitives.boxes = {};
    packed.nodes = flattenBvh(bvh, primitives.kinds);
    fillStatistics(bvh, options.traversalCost, packed.statistics);
    if (!bvh.nodes.empty()) {
        packed.boundsLo = bvh.nodes[0].box.lo;
        packed.boundsHi = bvh.nodes[0].box.hi;
    }
    bvh.nodes = {};

    LeafOrderWriter writer(scene, numbers, frame, primitives, bvh.order, packed);
    writer.write(threads);
    packEnvironment(scene, packed);
    for (const shared::Plane& plane : packed.planes) writer.use(plane.material);
    packed.features = featuresOf(packed, [&](size_t material) { return writer.used(material); });
    packed.features.parallelCamera = scene.camera.projection == Projection::Orthographic;
    return packed;
}

}  // namespace glint
