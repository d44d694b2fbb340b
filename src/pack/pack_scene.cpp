#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "bvh/flatten.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "pack/area_vector.h"
#include "pack/build_tree.h"
#include "pack/instances.h"
#include "pack/pack_geometry.h"
#include "pack/pack_textures.h"
#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "pack/quadrics.h"
#include "pack/region.h"
#include "pack/unit_vector.h"
#include "scene/placement.h"
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

shared::Optics roundOptics(const Material& material) {
    // exp(-120) is no normal float: nothing gets through.
    constexpr double kOpaque = 120;
    shared::Optics out;
    out.transmission = glm::vec3(material.transmission);
    out.ior = static_cast<float>(material.ior);
    out.attenuation = glm::vec3(material.attenuation);
    out.rank = shared::kRankOfZero + static_cast<uint32_t>(material.priority);
    for (int i = 0; i < 3; ++i) {
        const double part = material.transmission[i];
        out.density[i] = static_cast<float>(part > 0 ? std::min(-std::log(part), kOpaque) : kOpaque);
    }
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
                    const Primitives& primitives, const std::vector<uint32_t>& order, PackedScene& packed,
                    Materials& materials)
        : scene_(scene),
          numbers_(numbers),
          frame_(frame),
          primitives_(primitives),
          order_(order),
          packed_(packed),
          materials_(materials) {}

    void write(unsigned threads);

  private:
    struct Counts {
        std::array<uint32_t, shared::kKindCount> kinds{};
        uint32_t normals = 0, polygonVertices = 0, attributes = 0;
    };
    template <class Visit>
    void visitChunk(size_t chunk, Visit&& visit) const {
        const size_t end = std::min(order_.size(), (chunk + 1) * kChunk);
        for (size_t i = chunk * kChunk; i < end; ++i) visit(order_[i], primitives_.sources[order_[i]]);
    }
    Counts count(size_t chunk) const;
    void writeChunk(size_t chunk, Counts next);
    void writeTriangle(Primitives::Source source, uint32_t slot, uint32_t normals, uint32_t& attributes);
    uint32_t materialOf(Primitives::Source source) const;
    void writeSphere(Primitives::Source source, uint32_t slot);
    void writeDisc(Primitives::Source source, uint32_t slot);
    void writeInstance(Primitives::Source source, uint32_t slot);
    void use(uint32_t material) { materials_.use(material); }
    void writePolygon(Primitives::Source source, uint32_t slot, uint32_t firstVertex);
    void writeQuadric(Primitives::Source source, uint32_t slot);

    const Scene& scene_;
    const PrimitiveNumbers& numbers_;
    const Frame& frame_;
    const Primitives& primitives_;
    const std::vector<uint32_t>& order_;
    PackedScene& packed_;
    Materials& materials_;
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
        total.attributes += here.attributes;
    }
    packed_.triangles.resize(total.kinds[shared::kKindTriangle]);
    packed_.triangleSurfaces.resize(total.kinds[shared::kKindTriangle]);
    packed_.spheres.resize(total.kinds[shared::kKindSphere]);
    packed_.discs.resize(total.kinds[shared::kKindDisc]);
    packed_.polygons.resize(total.kinds[shared::kKindPolygon]);
    packed_.quadrics.resize(total.kinds[shared::kKindQuadric]);
    packed_.polygonVertices.resize(total.polygonVertices);
    packed_.instances.resize(total.kinds[shared::kKindInstance]);
    packed_.vertexNormals.resize(total.normals);
    // At most 5 rows for each of 2^25 triangles: the number fits kAttributeFirstMask.
    packed_.vertexAttributes.resize(total.attributes);
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
            counts.attributes +=
                attributeRows(attributeFlags(scene_, triangles.mesh(), source.face, materialOf(source)));
        } else if (primitives_.kinds[primitive] == shared::kKindInstance) {
            return;
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
        if (kind == shared::kKindInstance) return writeInstance(source, slot);
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
        writeTriangle(source, slot, smooth ? next.normals++ : shared::kNone, next.attributes);
    });
}

uint32_t LeafOrderWriter::materialOf(Primitives::Source source) const {
    const Object& object = scene_.objects[source.object];
    const Mesh* mesh = TriangleSource(object).mesh();
    return mesh != nullptr && !mesh->materials.empty() ? mesh->materials[source.face] : object.material;
}

void LeafOrderWriter::writeTriangle(Primitives::Source source, uint32_t slot, uint32_t normals,
                                    uint32_t& attributes) {
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
    surface.material = materialOf(source);
    surface.vertexNormals = normals;
    const uint32_t flags = attributeFlags(scene_, mesh, source.face, surface.material);
    if (flags != 0) {
        surface.attributes = attributes | flags;
        writeAttributes(*mesh, source.face, flags, &packed_.vertexAttributes[attributes]);
        attributes += attributeRows(flags);
    }
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

void LeafOrderWriter::writeInstance(Primitives::Source source, uint32_t slot) {
    shared::Instance& instance = packed_.instances[slot];
    instance = frame_.instances->row(source.object);
    if (instance.material != shared::kNone) return use(instance.material);
    for (const uint32_t material : std::get<MeshShape>(scene_.objects[source.object].shape).mesh->materials)
        use(material);
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

void fillStatistics(const Tree& tree, PackStatistics& statistics) {
    statistics.depth = tree.bvh.depth;
    statistics.sahCost = tree.cost;
    statistics.splitTriangles = tree.splitTriangles;
    for (const BvhNode& node : tree.bvh.nodes) statistics.leaves += node.count > 0;
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
    SceneFeatures f = packed.features;  // those of packTextures
    f.triangles = !packed.triangles.empty();
    f.spheres = !packed.spheres.empty();
    for (const shared::Sphere& s : packed.spheres) f.anchoredSpheres |= s.anchorNormal != glm::vec3(0);
    f.planes = !packed.planes.empty();
    f.discs = !packed.discs.empty();
    f.polygons = !packed.polygons.empty();
    f.instances = !packed.instances.empty();
    f.splitTriangles = packed.statistics.splitTriangles > 0;
    f.quadrics = !packed.quadrics.empty();
    f.vertexNormals = !packed.vertexNormals.empty();
    for (const shared::Light& light : packed.lights) addLightKind(light, f);
    for (size_t i = 0; i < packed.materials.size(); ++i) {
        if (!used(i)) continue;
        f.specular |= packed.materials[i].specular != glm::vec3(0);
        f.mirrors |= packed.environment.maxDepth > 0 && packed.materials[i].mirror != glm::vec3(0);
        if (packed.materials[i].medium == 0) continue;
        f.transmission = true;
        f.attenuation |= packed.optics[packed.materials[i].medium - 1].attenuation != glm::vec3(0);
    }
    return f;
}

void packEnvironment(const Scene& scene, PackedScene& packed) {
    for (const Material& material : scene.materials) {
        packed.materials.push_back(roundMaterial(material));
        if (material.transmission == Color(0)) continue;
        packed.optics.push_back(roundOptics(material));
        packed.materials.back().medium = static_cast<uint32_t>(packed.optics.size());
    }
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

void packGeometry(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, uint32_t maxDepth,
                  const PackOptions& pack, PackedScene& packed, Materials& materials) {
    const unsigned threads = pack.threads;
    Primitives primitives =
        collectPrimitives(scene, numbers, frame, threads, packed.statistics, packed.warnings);
    TreeOptions tree;
    tree.quality = pack.quality;
    tree.split = pack.split;
    BvhOptions& options = tree.bvh;
    options.maxDepth = maxDepth;
    options.threads = threads;
    const auto kinds = std::count_if(primitives.counts.begin(), primitives.counts.end(),
                                     [](uint32_t count) { return count > 0; });
    if (kinds > 1) options.groups = &primitives.kinds;
    if (primitives.counts[shared::kKindInstance] > 0) {
        options.groups = &primitives.kinds;
        options.soloGroup = shared::kKindInstance;
    }
    limitPolygonTrips(scene, options, packed);
    const Stopwatch stopwatch;
    Tree built = buildTree(primitives, scene, frame, tree);
    packed.statistics.buildSeconds = stopwatch.seconds();
    Bvh& bvh = built.bvh;
    primitives.boxes = {};
    packed.nodes = flattenBvh(bvh, primitives.kinds);
    fillStatistics(built, packed.statistics);
    if (!bvh.nodes.empty()) {
        packed.boundsLo = bvh.nodes[0].box.lo;
        packed.boundsHi = bvh.nodes[0].box.hi;
    }
    bvh.nodes = {};
    LeafOrderWriter(scene, numbers, frame, primitives, bvh.order, packed, materials).write(threads);
}

bool anyTransmits(const Scene& scene) {
    const auto transmits = [](const Material& m) { return m.transmission != Color(0); };
    return std::any_of(scene.materials.begin(), scene.materials.end(), transmits);
}

PackedScene packScene(const Scene& given, unsigned threads, BuildQuality quality) {
    PackOptions options{threads, quality};
    options.split = !anyTransmits(given);  // coloured shadows and mediaAt count surfaces
    Scene copy;
    const Scene& scene = placedScene(given, copy);
    const PrimitiveNumbers numbers(scene);
    Instances instances(scene, numbers, options);
    const Region region = sceneRegion(scene, numbers, &instances, threads);
    PackedScene packed;
    packed.origin = originOf(region);
    packPlanes(scene, numbers, region, packed);
    instances.place(scene, numbers, packed.origin, threads);

    Materials materials(scene.materials.size());
    packGeometry(scene, numbers, {packed.origin, scene.camera.eye, &instances}, instances.depthOfTop(),
                 options, packed, materials);
    packEnvironment(scene, packed);
    instances.append(packed);
    for (const shared::Plane& plane : packed.planes) materials.use(plane.material);
    packTextures(
        scene, [&](size_t material) { return materials.used(material); }, packed);
    packed.features = featuresOf(packed, [&](size_t material) { return materials.used(material); });
    if (packed.features.transmission) {
        const glm::uvec4 media = mediaAt(packed, scene.camera.eye - packed.origin);
        shared::Environment& environment = packed.environment;
        environment.eyeMedium0 = media.x;
        environment.eyeMedium1 = media.y;
        environment.eyeMedium2 = media.z;
        environment.eyeMedium3 = media.w;
        packed.features.coloredShadows =
            scene.transmissiveShadows == TransmissiveShadows::Colored && !packed.lights.empty();
    } else {
        for (shared::Material& material : packed.materials) material.medium = 0;
        packed.optics.clear();
    }
    if (packed.features.transmission || packed.features.mirrors)
        packed.environment.radianceBound = radianceBound(packed, packed.environment, packed.lights);
    packed.features.parallelCamera = scene.camera.projection == Projection::Orthographic;
    packed.features.thinLens = scene.camera.lensRadius > 0;
    return packed;
}

}  // namespace glint
