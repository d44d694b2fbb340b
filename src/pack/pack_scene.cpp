#include <algorithm>

#include "bvh/flatten.h"
#include "core/stopwatch.h"
#include "pack/build_tree.h"
#include "pack/camera_change.h"
#include "pack/collect_primitives.h"
#include "pack/dielectric_rank.h"
#include "pack/features.h"
#include "pack/instances.h"
#include "pack/leaf_order.h"
#include "pack/object_extents.h"
#include "pack/pack_geometry.h"
#include "pack/pack_shading.h"
#include "pack/pack_textures.h"
#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "pack/tree_memory.h"
#include "pack/unit_vector.h"
#include "scene/placement.h"

namespace glint {

void packPlanes(const Scene& scene, const PrimitiveNumbers& numbers, const Extent& extent,
                PackedScene& packed) {
    packed.planes.clear();
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const auto* plane = std::get_if<PlaneShape>(&scene.objects[i].shape);
        if (plane == nullptr) continue;
        const glm::dvec3 normal = unitVector(plane->normal).value();
        shared::Plane out;
        out.point = glm::vec3(planeAnchor(plane->point, normal, extent) - packed.origin);
        out.normal = glm::vec3(normal);
        out.id = numbers.firstId(i);
        out.object = i;
        out.material = scene.objects[i].material;
        packed.planes.push_back(out);
    }
    checkLimit("planes", packed.planes.size(), shared::kMaxPlanes);
}

namespace {

std::vector<Extent> extentsOf(const Scene& scene, const PrimitiveNumbers& numbers, const Instances& instances,
                              const Context& context) {
    const auto corners = [&](uint32_t object) { return instances.corners(scene, object); };
    return objectExtents(scene, numbers, corners, context);
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

// Parts of the packing time until the primitives are collected, and until their BVH is built.
constexpr double kCollected = 0.1, kBuilt = 0.9;

void fillStatistics(const Tree& tree, PackStatistics& statistics) {
    statistics.depth = tree.bvh.depth;
    statistics.sahCost = tree.cost;
    statistics.splitTriangles = tree.splitTriangles;
    for (const BvhNode& node : tree.bvh.nodes) statistics.leaves += node.count > 0;
}

}  // namespace

void packGeometry(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, uint32_t maxLevels,
                  const PackOptions& pack, const Context& context, PackedScene& packed,
                  Materials& materials) {
    Primitives primitives =
        collectPrimitives(scene, numbers, frame, context, packed.statistics, packed.warnings);
    TreeOptions tree;
    tree.quality = pack.quality;
    tree.split = pack.split;
    tree.memory = pack.memory;
    BvhOptions& options = tree.bvh;
    options.maxLevels = maxLevels;
    const auto kinds = std::count_if(primitives.counts.begin(), primitives.counts.end(),
                                     [](uint32_t count) { return count > 0; });
    if (kinds > 1) options.groups = &primitives.kinds;
    if (primitives.counts[shared::kKindInstance] > 0) {
        options.groups = &primitives.kinds;
        options.soloGroup = shared::kKindInstance;
    }
    limitPolygonTrips(scene, options, packed);
    const Stopwatch stopwatch;
    Tree built = buildTree(primitives, scene, frame, tree, context.part(kCollected, kBuilt));
    packed.statistics.buildSeconds = stopwatch.seconds();
    Bvh& bvh = built.bvh;
    primitives.boxes = {};
    packed.nodes = flattenBvh(bvh, primitives.kinds, context);
    fillStatistics(built, packed.statistics);
    if (!bvh.nodes.empty()) {
        packed.boundsLo = bvh.nodes[0].box.lo;
        packed.boundsHi = bvh.nodes[0].box.hi;
    }
    bvh.nodes = {};
    writeInLeafOrder({scene, numbers, frame, packed, materials}, primitives, bvh.order, context);
}

bool anyTransmits(const Scene& scene) {
    const auto transmits = [](const Material& m) { return m.transmission != Color(0); };
    return std::any_of(scene.materials.begin(), scene.materials.end(), transmits);
}

PackedScene packPlaced(const Scene& scene, const PrimitiveNumbers& numbers, Instances& instances,
                       const PackOptions& options, const Context& whole) {
    const Context context = whole.part(instances.any() ? Instances::kPrototypesPart : 0, 1);
    const Geometry geometry = geometryOf(scene, extentsOf(scene, numbers, instances, context));
    const Extent extent = withCamera(geometry.extent, scene);
    PackedScene packed;
    packed.geometryLo = geometry.extent.lo;
    packed.geometryHi = geometry.extent.hi;
    packed.geometryMiddle = geometry.middle;
    packed.geometryReach = geometry.reach;
    packed.origin = originOf(geometry, scene.camera.eye);
    packPlanes(scene, numbers, extent, packed);
    instances.place(scene, numbers, packed.origin, context);

    Materials materials(scene.materials.size());
    packGeometry(scene, numbers, {packed.origin, scene.camera.eye, &instances}, instances.depthOfTop(),
                 options, context, packed, materials);
    packShading(scene, packed);
    instances.append(packed);
    for (const shared::Plane& plane : packed.planes) materials.use(plane.material);
    packTextures(
        scene, [&](size_t material) { return materials.used(material); }, packed, context);
    packed.features = featuresOf(
        packed, [&](size_t material) { return materials.used(material); }, context);
    if (packed.features.transmission) {
        setEye(packed, scene.camera.eye);
        packed.features.coloredShadows =
            scene.transmissiveShadows == TransmissiveShadows::Colored && !packed.lights.empty();
    } else {
        for (shared::Material& material : packed.materials) material.medium = 0;
        packed.optics.clear();
    }
    if (packed.features.transmission) rankDielectrics(packed, packed.nodes);
    if (packed.features.transmission || packed.features.mirrors)
        packed.environment.radianceBound = radianceBound(packed, packed.environment, packed.lights);
    packed.features.parallelCamera = scene.camera.projection == Projection::Orthographic;
    packed.features.thinLens = scene.camera.lensRadius > 0;
    return packed;
}

glm::dvec3 chooseOrigin(const Scene& given, const Context& context) {
    Scene copy;
    const Scene& scene = placedScene(given, copy);
    const PrimitiveNumbers numbers(scene);
    const Instances instances(scene, numbers, PackOptions{}, context);
    return originOf(geometryOf(scene, extentsOf(scene, numbers, instances, context)), scene.camera.eye);
}

PackedScene packScene(const Scene& given, const PackOptions& wanted, const Context& context) {
    PackOptions options = wanted;
    if (options.memory) options.memory->begin();
    options.split = options.split && !anyTransmits(given);  // coloured shadows and mediaAt count surfaces
    Scene copy;
    const Scene& scene = placedScene(given, copy);
    const PrimitiveNumbers numbers(scene);
    Instances instances(scene, numbers, options, context);
    return packPlaced(scene, numbers, instances, options, context);
}

}  // namespace glint
