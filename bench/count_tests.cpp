// count_tests SCENE...
//
// Boxes and primitives that a ray tests, by each build quality: 256x192 camera rays, a shadow ray to the
// first light and a random bounce from each hit, counted by the reference tracer; with the time to build, the
// expected cost and the triangles stored. Counts do not depend on the machine.
#include <cstdio>
#include <filesystem>
#include <random>

#include "bounce.h"
#include "core/error.h"
#include "import/load.h"
#include "pack/packed_scene.h"
#include "reference/tracer.h"

namespace glint::bench {
namespace {

struct Mean {
    uint64_t rays = 0, tests = 0;
    double value() const { return rays > 0 ? static_cast<double>(tests) / static_cast<double>(rays) : 0; }
};

struct Counts {
    Mean camera, shadow, bounce;
};

Counts count(const Scene& scene, const PackedScene& packed) {
    constexpr int kWidth = 256, kHeight = 192;
    const reference::Tracer tracer(packed);
    const shared::Camera camera = packCamera(scene.camera, kWidth, kHeight, packed.origin);
    std::mt19937 random(1);
    Counts counts;
    const auto closest = [&](const reference::Ray& ray, const reference::Source& source, Mean& mean) {
        ++mean.rays;
        return tracer.closest(ray, source, &mean.tests);
    };
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const reference::Ray ray = tracer.cameraRay(camera, x + 0.5, y + 0.5);
            const auto hit = closest(ray, {}, counts.camera);
            if (!hit) continue;
            const reference::Surface surface = tracer.surfaceAt(ray, *hit);
            if (!packed.lights.empty()) {
                const shared::Light& light = packed.lights[0];
                const bool directional = light.kind == shared::kLightDirectional;
                const glm::dvec3 at(light.position);
                ++counts.shadow.rays;
                reference::Ray shadow{surface.position, directional ? at : at - surface.position};
                if (!directional) shadow.tMax = 1;
                tracer.occluded(shadow, reference::sourceOf(*hit), &counts.shadow.tests);
            }
            const bool behind = glm::dot(surface.geometricNormal, ray.direction) > 0;
            const glm::dvec3 direction =
                bounceAbout(behind ? -surface.geometricNormal : surface.geometricNormal, random);
            closest({surface.position, direction}, reference::sourceOf(*hit), counts.bounce);
        }
    }
    return counts;
}

void report(const std::string& file) {
    const Scene scene = loadScene(file);
    std::printf("%s\n", std::filesystem::path(file).filename().string().c_str());
    const char* const names[] = {"fast", "default", "high"};
    for (const BuildQuality quality : {BuildQuality::Fast, BuildQuality::Default, BuildQuality::High}) {
        double seconds = 1e9;
        for (int i = 0; i < 3; ++i)
            seconds = std::min(seconds, packScene(scene, {quality}).statistics.buildSeconds);
        const PackedScene packed = packScene(scene, {quality});
        const Counts counts = count(scene, packed);
        std::printf(
            "  %-8s camera %7.2f  shadow %7.2f  bounce %7.2f  SAH %7.2f  build %8.2f ms  triangles %zu\n",
            names[static_cast<int>(quality)], counts.camera.value(), counts.shadow.value(),
            counts.bounce.value(), packed.statistics.sahCost, 1e3 * seconds, packed.triangles.size());
    }
}

}  // namespace
}  // namespace glint::bench

int main(int count, char** arguments) {
    try {
        for (int i = 1; i < count; ++i) glint::bench::report(arguments[i]);
    } catch (const glint::Error& error) {
        std::fprintf(stderr, "count_tests: %s\n", error.what());
        return 1;
    }
    return count > 1 ? 0 : 2;
}
