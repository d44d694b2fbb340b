#include "embree_rays.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "pack/scene_arrays.h"

namespace glint::bench {
namespace {

constexpr unsigned kThreads = 2;
constexpr size_t kBlock = 1024;  // rays that a thread takes at a time: 16 tiles

template <class Work>
Timing onThreads(size_t rays, const Work& work) {
    std::atomic<size_t> next{0};
    const Timer timer;
    const auto run = [&] {
        for (size_t first; (first = next.fetch_add(kBlock)) < rays;)
            work(first, std::min(rays, first + kBlock));
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < kThreads; ++i) threads.emplace_back(run);
    run();
    for (std::thread& thread : threads) thread.join();
    return timer.elapsed();
}

RTCIntersectContext coherentContext() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}

// Calls visit(hit, ray's t, geometry, primitive) for each ray of [first, last).
template <class Visit>
void traceSingles(RTCScene scene, const BenchRay* rays, size_t count, bool any, const Visit& visit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < count; ++i) {
        const BenchRay& ray = rays[i];
        if (!(ray.tMax > ray.tMin)) continue;
        RTCRayHit q{};
        q.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 ray.tMin,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 0.0f,
                 ray.tMax,
                 ~0u,
                 0,
                 0};
        q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (any) {
            rtcOccluded1(scene, &context, &q.ray);
            visit(i, q.ray.tfar < 0, 0.0f, 0u, 0u);
        } else {
            rtcIntersect1(scene, &context, &q);
            visit(i, q.hit.geomID != RTC_INVALID_GEOMETRY_ID, q.ray.tfar, q.hit.geomID, q.hit.primID);
        }
    }
}

template <class RayHit, unsigned N, class Intersect, class Occluded, class Visit>
void tracePackets(const BenchRay* rays, size_t count, bool any, const Intersect& intersect,
                  const Occluded& occluded, const Visit& visit) {
    for (size_t first = 0; first < count; first += N) {
        alignas(64) int valid[N];
        alignas(64) RayHit q;
        bool some = false;
        for (unsigned i = 0; i < N; ++i) {
            const BenchRay ray = first + i < count ? rays[first + i] : BenchRay{};
            valid[i] = ray.tMax > ray.tMin ? -1 : 0;
            some |= valid[i] != 0;
            q.ray.org_x[i] = ray.origin.x;
            q.ray.org_y[i] = ray.origin.y;
            q.ray.org_z[i] = ray.origin.z;
            q.ray.dir_x[i] = ray.direction.x;
            q.ray.dir_y[i] = ray.direction.y;
            q.ray.dir_z[i] = ray.direction.z;
            q.ray.tnear[i] = ray.tMin;
            q.ray.tfar[i] = ray.tMax;
            q.ray.time[i] = 0;
            q.ray.mask[i] = ~0u;
            q.ray.flags[i] = 0;
            q.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        if (!some) continue;
        any ? occluded(valid, &q.ray) : intersect(valid, &q);
        for (unsigned i = 0; i < N && first + i < count; ++i) {
            if (valid[i] == 0) continue;
            if (any) {
                visit(first + i, q.ray.tfar[i] < 0, 0.0f, 0u, 0u);
            } else {
                visit(first + i, q.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID, q.ray.tfar[i], q.hit.geomID[i],
                      q.hit.primID[i]);
            }
        }
    }
}

}  // namespace

EmbreeRays::EmbreeRays(const PackedScene& scene) {
    visitKinds(scene, [](const KindCount& kind) {
        const bool known =
            kind.kind == shared::PrimitiveKind::Triangle || kind.kind == shared::PrimitiveKind::Sphere;
        if (!known && kind.count > 0)
            throw std::invalid_argument(std::string("the scene has ") + kind.many +
                                        ", which Embree is not given here");
    });
    device_ = rtcNewDevice("threads=2,set_affinity=0");
    scene_ = rtcNewScene(device_);
    if (!scene.triangles.empty()) addTriangles(scene);
    if (!scene.spheres.empty()) addSpheres(scene);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
    const Timer timer;
    rtcCommitScene(scene_);
    buildSeconds_ = timer.elapsed().wall;
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree: error " + std::to_string(error));
}

EmbreeRays::~EmbreeRays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void EmbreeRays::addTriangles(const PackedScene& scene) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const size_t count = scene.triangles.size();
    auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * count));
    auto* const indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), count));
    for (size_t i = 0; i < count; ++i) {
        const shared::Triangle& triangle = scene.triangles[i];
        const glm::vec3* const corners[3] = {&triangle.v0, &triangle.v1, &triangle.v2};
        for (size_t k = 0; k < 3; ++k) {
            std::memcpy(vertices + 9 * i + 3 * k, corners[k], sizeof(glm::vec3));
            indices[3 * i + k] = static_cast<uint32_t>(3 * i + k);
        }
        triangleIds_.push_back(triangle.id);
    }
    rtcCommitGeometry(geometry);
    triangleGeometry_ = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
}

void EmbreeRays::addSpheres(const PackedScene& scene) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    const size_t count = scene.spheres.size();
    auto* const points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), count));
    for (size_t i = 0; i < count; ++i) {
        const shared::Sphere& sphere = scene.spheres[i];
        const float row[4] = {sphere.point.x, sphere.point.y, sphere.point.z, sphere.radius};
        std::memcpy(points + 4 * i, row, sizeof(row));
        sphereIds_.push_back(sphere.id);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
}

uint32_t EmbreeRays::idOf(uint32_t geometry, uint32_t primitive) const {
    return geometry == triangleGeometry_ ? triangleIds_[primitive] : sphereIds_[primitive];
}

Timing EmbreeRays::trace(const std::vector<BenchRay>& rays, bool any, EmbreeCall call,
                         std::vector<BenchHit>& hits) const {
    hits.assign(rays.size(), {});
    return onThreads(rays.size(), [&](size_t first, size_t last) {
        const auto visit = [&](size_t i, bool hit, float t, uint32_t geometry, uint32_t primitive) {
            if (hit) hits[first + i] = {true, t, any ? 0 : idOf(geometry, primitive)};
        };
        const BenchRay* const block = rays.data() + first;
        RTCIntersectContext context = coherentContext();
        if (call == EmbreeCall::Single) {
            traceSingles(scene_, block, last - first, any, visit);
        } else if (call == EmbreeCall::Packet8) {
            tracePackets<RTCRayHit8, 8>(
                block, last - first, any,
                [&](const int* v, RTCRayHit8* q) { rtcIntersect8(v, scene_, &context, q); },
                [&](const int* v, RTCRay8* q) { rtcOccluded8(v, scene_, &context, q); }, visit);
        } else {
            tracePackets<RTCRayHit16, 16>(
                block, last - first, any,
                [&](const int* v, RTCRayHit16* q) { rtcIntersect16(v, scene_, &context, q); },
                [&](const int* v, RTCRay16* q) { rtcOccluded16(v, scene_, &context, q); }, visit);
        }
    });
}

}  // namespace glint::bench
