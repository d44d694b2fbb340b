// library_rays [--count] SCENE...
//
// Compares batches by libglint's C API, from array to array, with the kernels alone: closest hits with t,
// geometry and primitive, any hits, and counts. Rays: random ones through the scene's box, chords of the
// sphere around it, and a camera's, with fp32 origins and directions. Processor time, the best of kTurns.
// --count: counts alone, and their sum, which no change may move. A build with tinybvh (GLINT_TINYBVH) adds
// its rates for the same rays and triangles, and how many rays at vertices that hit (by certified hits) each
// misses.
#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "core/error.h"
#include "glint/glint.h"
#include "gpu/device.h"
#include "import/load.h"
#include "pack/packed_scene.h"
#include "rays.h"
#include "render/ray_queries.h"
#ifdef GLINT_TINYBVH
#include "tinybvh_rays.h"
#endif

namespace glint::bench {
namespace {

constexpr size_t kRays = 1u << 20;
constexpr int kTurns = 5;

struct Rays {
    const char* name;
    std::vector<glm::vec3> origins, directions;
    bool coherent;
};

// From a sphere around the box to points in it.
Rays randomRays(const glm::dvec3& lo, const glm::dvec3& hi) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    Rays rays{"random", {}, {}, false};
    const double reach = glm::length(hi - lo);
    for (size_t i = 0; i < kRays; ++i) {
        const glm::dvec3 to = lo + (hi - lo) * glm::dvec3(uniform(random), uniform(random), uniform(random));
        const glm::dvec3 from =
            to + reach * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        rays.origins.emplace_back(from);
        rays.directions.emplace_back(to - from);
    }
    return rays;
}

// From one point of the sphere around the box to another.
Rays chords(const glm::dvec3& lo, const glm::dvec3& hi) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Rays rays{"chord", {}, {}, false};
    const auto point = [&] {
        return 0.5 * (lo + hi) +
               0.5 * glm::length(hi - lo) *
                   glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    };
    for (size_t i = 0; i < kRays; ++i) {
        const glm::dvec3 from = point();
        rays.origins.emplace_back(from);
        rays.directions.emplace_back(point() - from);
    }
    return rays;
}

// 1024 x 1024 rays from one point, in blocks of 8 x 4, which packets like.
Rays cameraRays(const glm::dvec3& lo, const glm::dvec3& hi) {
    Rays rays{"camera", {}, {}, true};
    const glm::dvec3 middle = 0.5 * (lo + hi),
                     eye = middle + glm::dvec3(0.3, 0.4, 1.0) * glm::length(hi - lo);
    const glm::dvec3 back = glm::normalize(eye - middle), right = glm::normalize(glm::cross({0, 1, 0}, back)),
                     up = glm::cross(back, right);
    for (size_t i = 0; i < kRays; ++i) {
        const size_t block = i / 32, x = block % 128 * 8 + i % 8, y = block / 128 * 4 + i / 8 % 4;
        const double u = (static_cast<double>(x) + 0.5) / 512 - 1,
                     v = (static_cast<double>(y) + 0.5) / 512 - 1;
        rays.origins.emplace_back(eye);
        rays.directions.emplace_back(-back + 0.5 * u * right + 0.5 * v * up);
    }
    return rays;
}

void check(glint_status status) {
    if (status == GLINT_OK) return;
    std::fprintf(stderr, "%s\n", glint_last_error());
    std::exit(1);
}

glint_view viewOf(const std::vector<glm::vec3>& v) {
    return {v.data(), v.size(), 0, GLINT_F32, 0};
}

using Query = render::RayTask::Query;

double kernelSeconds(render::RayQueries& queries, const Rays& rays, const glm::dvec3& origin, Query query) {
    BatchTimes times;
    render::RayTask task;
    task.count = kRays;
    task.query = query;
    task.coherent = rays.coherent;
    task.kernels = &times;
    task.fill = [&](const render::RayNumbers& numbers, std::span<render::RayInput> inputs) {
        for (size_t i = 0; i < inputs.size(); ++i)
            inputs[i] = render::roundedRay(localRay(
                {glm::dvec3(rays.origins[numbers[i]]), glm::dvec3(rays.directions[numbers[i]])}, origin));
    };
    task.take = [](const render::RayNumbers&, const render::FoundHits&) {};
    queries.run(task);
    return times.processor;
}

// crossings: receives the sum of counts.
double callSeconds(const glint_scene* scene, const Rays& rays, Query query, uint64_t& crossings) {
    static std::vector<float> t(kRays);
    static std::vector<uint32_t> geometry(kRays), primitive(kRays);
    static std::vector<uint8_t> hit(kRays);
    GLINT_INIT(glint_rays, asked);
    asked.origins = viewOf(rays.origins);
    asked.directions = viewOf(rays.directions);
    asked.flags = rays.coherent ? GLINT_RAYS_COHERENT : 0;
    GLINT_INIT(glint_hits, hits);
    hits.t = {t.data(), kRays, 0, GLINT_F32, 0};
    hits.geometry = {geometry.data(), kRays, 0, GLINT_U32, 0};
    hits.primitive = {primitive.data(), kRays, 0, GLINT_U32, 0};
    const glint_out flags = {hit.data(), kRays, 0, GLINT_U8, 0};
    const Timer timer;
    if (query == Query::Closest) check(glint_query_closest(scene, &asked, &hits, nullptr));
    if (query == Query::Any) check(glint_query_any(scene, &asked, &flags, nullptr));
    if (query == Query::Count) check(glint_query_count(scene, &asked, &hits.geometry, nullptr));
    const double seconds = timer.elapsed().cpu;
    if (query == Query::Count) crossings = std::accumulate(geometry.begin(), geometry.end(), uint64_t{0});
    return seconds;
}

#ifdef GLINT_TINYBVH
// From outside to vertices of the triangles.
Rays aimedRays(const std::vector<glm::vec3>& corners, const glm::dvec3& lo, const glm::dvec3& hi) {
    Rays rays = randomRays(lo, hi);
    std::mt19937 random(2);
    for (size_t i = 0; i < kRays; ++i)
        rays.directions[i] = corners[random() % corners.size()] - rays.origins[i];
    return rays;
}

std::vector<uint8_t> hitsOfCall(const glint_scene* scene, const Rays& rays, bool certified) {
    std::vector<uint8_t> hit(kRays), sure(kRays);
    GLINT_INIT(glint_rays, asked);
    asked.origins = viewOf(rays.origins);
    asked.directions = viewOf(rays.directions);
    GLINT_INIT(glint_hits, hits);
    hits.hit = {hit.data(), kRays, 0, GLINT_U8, 0};
    if (certified) hits.sure = {sure.data(), kRays, 0, GLINT_U8, 0};
    check(glint_query_closest(scene, &asked, &hits, nullptr));
    return hit;
}

size_t missed(const std::vector<uint8_t>& hit, const std::vector<uint8_t>& exact) {
    size_t count = 0;
    for (size_t i = 0; i < hit.size(); ++i) count += exact[i] != 0 && hit[i] == 0;
    return count;
}

// Triangles that instances show are left out.
void measureTinyBvh(const char* path, const glint_scene* scene, const PackedScene& packed,
                    const glm::dvec3& lo, const glm::dvec3& hi) {
    std::vector<glm::vec3> corners;
    for (const shared::Triangle& t : packed.triangles)
        for (const glm::vec3& corner : {t.v0, t.v1, t.v2})
            corners.emplace_back(packed.origin + glm::dvec3(corner));
    const TinyBvh peer(corners);
    std::vector<uint8_t> hit;
    for (const Rays& rays : {randomRays(lo, hi), cameraRays(lo, hi)}) {
        double closest = 1e9, any = 1e9;
        for (int turn = 0; turn < kTurns; ++turn) {
            closest = std::min(closest, peer.closest(rays.origins, rays.directions, hit));
            any = std::min(any, peer.any(rays.origins, rays.directions, hit));
        }
        std::printf("%s, %s rays, tinybvh: closest %.2f, any %.2f million rays per processor second\n", path,
                    rays.name, 1e-6 * kRays / closest, 1e-6 * kRays / any);
    }
    const Rays aimed = aimedRays(corners, lo, hi);
    const std::vector<uint8_t> exact = hitsOfCall(scene, aimed, true);
    peer.closest(aimed.origins, aimed.directions, hit);
    std::printf("%s, of %zu rays at vertices that hit: missed by tinybvh %zu, by libglint %zu\n", path,
                static_cast<size_t>(std::count(exact.begin(), exact.end(), uint8_t{1})), missed(hit, exact),
                missed(hitsOfCall(scene, aimed, false), exact));
    std::fflush(stdout);
}
#endif

void measureQuery(const char* path, const glint_scene* scene, render::RayQueries& queries,
                  const glm::dvec3& origin, const Rays& rays, Query query, const char* name) {
    double kernel = 1e9, call = 1e9;
    uint64_t crossings = 0;
    for (int turn = 0; turn < kTurns; ++turn) {
        kernel = std::min(kernel, kernelSeconds(queries, rays, origin, query));
        call = std::min(call, callSeconds(scene, rays, query, crossings));
    }
    std::printf(
        "%s, %s rays, %s: kernel %.2f, call %.2f million rays per processor second, %.2f of the kernel\n",
        path, rays.name, name, 1e-6 * kRays / kernel, 1e-6 * kRays / call, kernel / call);
    if (query == Query::Count)
        std::printf("    %.0f ns of processor time a call's ray, %" PRIu64 " crossings\n", 1e9 * call / kRays,
                    crossings);
    std::fflush(stdout);
}

void measure(const char* path, glint_device* device, const gpu::Device& vulkan, bool countAlone) {
    glint_scene* scene = nullptr;
    check(glint_scene_load(device, path, &scene));
    const PackedScene packed = packScene(loadScene(path), {.split = false});
    render::RayQueries queries(vulkan, packed);
    const glm::dvec3 lo = packed.origin + glm::dvec3(packed.boundsLo),
                     hi = packed.origin + glm::dvec3(packed.boundsHi);
    for (const Rays& rays : {randomRays(lo, hi), chords(lo, hi), cameraRays(lo, hi)}) {
        for (const auto& [query, name] : {std::pair(Query::Closest, "closest"), std::pair(Query::Any, "any"),
                                          std::pair(Query::Count, "count")})
            if (!countAlone || query == Query::Count)
                measureQuery(path, scene, queries, packed.origin, rays, query, name);
    }
#ifdef GLINT_TINYBVH
    if (!countAlone) measureTinyBvh(path, scene, packed, lo, hi);
#endif
    glint_scene_release(scene);
}

}  // namespace
}  // namespace glint::bench

int main(int count, char** arguments) try {
    glint_device* device = nullptr;
    glint::bench::check(glint_device_open(nullptr, &device));
    const glint::gpu::Device vulkan;
    const bool countAlone = count > 1 && std::strcmp(arguments[1], "--count") == 0;
    for (int i = countAlone ? 2 : 1; i < count; ++i)
        glint::bench::measure(arguments[i], device, vulkan, countAlone);
    glint_device_release(device);
} catch (const glint::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
