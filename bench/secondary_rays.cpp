// secondary_rays [--size WxH] [--rounds N] SCENE...
//
// Compares secondary rays by Embree's single rays and by the device's kernels, in turns. Every surface that a
// camera ray hits counts as a mirror, and as glass of index 1.5: reflected and refracted rays, rays reflected
// a second time, and from each of their hits a shadow ray to the scene's first light. Prints for each scene
// and class a line of JSON: the seconds of all rounds, on the clock and of all processors, and how many rays
// differ from Embree's in whether or where they hit.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "device_rays.h"
#include "embree_rays.h"
#include "import/load.h"

namespace glint::bench {
namespace {

using glm::vec3;

struct Settings {
    int width = 512, height = 512, rounds = 5;
    std::vector<std::string> scenes;
};

struct Contestant {
    std::string name;
    std::function<Timing(const std::vector<BenchRay>&, bool, std::vector<BenchHit>&)> trace;
    std::vector<Timing> timings = {};
    std::vector<BenchHit> hits = {};
};

std::string json(const std::vector<Timing>& timings, double Timing::*clock) {
    std::string text;
    for (const Timing& t : timings) {
        char number[32];
        std::snprintf(number, sizeof(number), "%s%.6f", text.empty() ? "" : ", ", t.*clock);
        text += number;
    }
    return "[" + text + "]";
}

// Rays of which one hits and the other misses, or whose hits are more than a rounding apart.
size_t differences(const std::vector<BenchHit>& a, const std::vector<BenchHit>& b, bool any) {
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i)
        count += a[i].hit != b[i].hit ||
                 (!any && a[i].hit && std::abs(a[i].t - b[i].t) > 1e-4f * std::abs(b[i].t));
    return count;
}

void compete(const std::string& scene, const char* kind, std::vector<Contestant>& contestants,
             const std::vector<BenchRay>& rays, bool any, int rounds) {
    if (rays.empty()) return;
    std::string text;
    for (Contestant& c : contestants) {
        c.timings.clear();
        c.trace(rays, any, c.hits);  // compiles
    }
    for (int round = 0; round < rounds; ++round)
        for (Contestant& c : contestants) c.timings.push_back(c.trace(rays, any, c.hits));
    for (const Contestant& c : contestants)
        text += ", \"" + c.name + "\": {\"wall\": " + json(c.timings, &Timing::wall) +
                ", \"processors\": " + json(c.timings, &Timing::cpu) +
                ", \"differ\": " + std::to_string(differences(c.hits, contestants.front().hits, any)) + "}";
    std::printf("{\"scene\": \"%s\", \"class\": \"%s\", \"number\": %zu%s}\n", scene.c_str(), kind,
                rays.size(), text.c_str());
    std::fflush(stdout);
}

struct Bounced {
    std::vector<BenchRay> mirrored, refracted;
};

// From a point of a surface, beside it by 1e-4 of the way there.
BenchRay leave(const vec3& point, float t, const vec3& side, const vec3& direction) {
    return {point + 1e-4f * t * side, 0, glm::normalize(direction), shared::kInfinity};
}

// In the order of the rays that they come from, without gaps.
Bounced bounce(const std::vector<BenchRay>& rays, const std::vector<WorldHit>& hits,
               const glm::dvec3& origin) {
    Bounced out;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].hit) continue;
        const vec3 d = glm::normalize(rays[i].direction), point(hits[i].point - origin);
        const bool entering = glm::dot(d, vec3(hits[i].normal)) <= 0;
        const vec3 n = entering ? vec3(hits[i].normal) : -vec3(hits[i].normal);
        const float t = static_cast<float>(hits[i].t), c = -glm::dot(n, d), e = entering ? 1 / 1.5f : 1.5f;
        const float k = 1 - e * e * (1 - c * c);
        out.mirrored.push_back(leave(point, t, n, d + 2 * c * n));
        if (k > 0) out.refracted.push_back(leave(point, t, -n, e * d + (e * c - std::sqrt(k)) * n));
    }
    return out;
}

std::vector<BenchRay> withoutGaps(std::vector<BenchRay> rays) {
    std::erase_if(rays, [](const BenchRay& ray) { return !(ray.tMax > ray.tMin); });
    return rays;
}

void compare(const Settings& settings, const std::string& path, const gpu::Device& gpu) {
    const std::string name = std::filesystem::path(path).stem().string();
    const Scene scene = loadScene(path);
    const PackedScene packed = packScene(scene);
    if (packed.lights.empty()) throw Error(ErrorKind::Scene, path + ": has no light");
    const shared::Camera camera = packCamera(scene.camera, settings.width, settings.height, packed.origin);
    const EmbreeRays embree(packed);
    DeviceRays lane(gpu, packed, render::Traversal::Lane);
    std::vector<Contestant> contestants;
    contestants.push_back({"embree", [&](const auto& rays, bool any, auto& hits) {
                               return embree.trace(rays, any, EmbreeCall::Single, hits);
                           }});
    contestants.push_back(
        {"lane", [&](const auto& rays, bool any, auto& hits) { return lane.trace(rays, any, hits); }});
    std::optional<DeviceRays> packet;
    if (hasPackets(gpu, packed)) {
        packet.emplace(gpu, packed, render::Traversal::Packet);
        contestants.push_back({"packet", [&](const auto& rays, bool any, auto& hits) {
                                   return packet->trace(rays, any, hits);
                               }});
    }
    const auto withShadows = [&](const char* kind, const char* shadows, const std::vector<BenchRay>& rays) {
        compete(name, kind, contestants, rays, false, settings.rounds);
        const auto shadow = withoutGaps(shadowRays(rays, contestants.front().hits, packed.lights[0]));
        compete(name, shadows, contestants, shadow, true, settings.rounds);
    };
    const std::vector<BenchRay> primary =
        withoutGaps(cameraRays(packed, camera, settings.width, settings.height));
    const Bounced first = bounce(primary, lane.surfaces(primary), packed.origin);
    withShadows("mirrored", "their shadows", first.mirrored);
    withShadows("refracted", "their shadows", first.refracted);
    const Bounced second = bounce(first.mirrored, lane.surfaces(first.mirrored), packed.origin);
    withShadows("mirrored twice", "their shadows", second.mirrored);
}

Settings parse(int argc, char** argv) {
    Settings settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool value = i + 1 < argc;
        if (word == "--size" && value) {
            if (std::sscanf(argv[++i], "%dx%d", &settings.width, &settings.height) != 2)
                throw Error(ErrorKind::Argument, "--size: expected WxH");
        } else if (word == "--rounds" && value) {
            settings.rounds = std::max(1, std::atoi(argv[++i]));
        } else if (word.starts_with("-")) {
            throw Error(ErrorKind::Argument, "unknown option " + word);
        } else {
            settings.scenes.push_back(word);
        }
    }
    if (settings.scenes.empty())
        throw Error(ErrorKind::Argument, "secondary_rays [--size WxH] [--rounds N] SCENE...");
    return settings;
}

}  // namespace
}  // namespace glint::bench

int main(int argc, char** argv) {
    try {
        const glint::bench::Settings settings = glint::bench::parse(argc, argv);
        const glint::gpu::Device device;
        for (const std::string& scene : settings.scenes) glint::bench::compare(settings, scene, device);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "secondary_rays: %s\n", e.what());
        return 1;
    }
}
