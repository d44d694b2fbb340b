// compare_embree [--size WxH] [--repeat N] [--only NAME] [--kernel FILE.spv] SCENE...
//
// Traces the camera rays of a scene's picture, and shadow rays from what they hit to its first light, by
// Embree and by the device's kernels, in turn, and prints millions of rays a second of clock time and of
// processor time (the least of all repeats), ratios to Embree's single rays, and how many rays differ in what
// they hit.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/error.h"
#include "device_rays.h"
#include "embree_rays.h"
#include "import/load.h"

namespace glint::bench {
namespace {

struct Settings {
    int width = 1024, height = 1024, repeat = 7;
    std::string only;  // some contestants, with commas
    std::vector<std::string> scenes;
    Replacements replaced;
};

using Trace = std::function<Timing(const std::vector<BenchRay>&, bool, std::vector<BenchHit>&)>;

struct Contestant {
    std::string name;
    Trace trace;
    std::vector<Timing> timings = {};
    std::vector<BenchHit> hits = {};
};

// Other programs only ever add to a time.
double least(const std::vector<Timing>& timings, double Timing::*clock) {
    double best = timings.front().*clock;
    for (const Timing& t : timings) best = std::min(best, t.*clock);
    return best;
}

size_t countRays(const std::vector<BenchRay>& rays) {
    return static_cast<size_t>(
        std::count_if(rays.begin(), rays.end(), [](const BenchRay& r) { return r.tMax > r.tMin; }));
}

// Rays of which one hits and the other misses, and those whose hits are more than a rounding apart.
void printDifferences(const Contestant& c, const Contestant& reference, bool any) {
    size_t presence = 0, distance = 0, primitive = 0;
    for (size_t i = 0; i < c.hits.size(); ++i) {
        const BenchHit &a = c.hits[i], &b = reference.hits[i];
        presence += a.hit != b.hit;
        if (!a.hit || !b.hit) continue;
        distance += !any && std::abs(a.t - b.t) > 1e-4f * std::abs(b.t);
        primitive += !any && a.id != b.id;
    }
    std::printf("  %7zu %7zu %7zu\n", presence, distance, primitive);
}

void compete(std::vector<Contestant>& contestants, const std::vector<BenchRay>& rays, bool any, int repeat) {
    for (Contestant& c : contestants) {
        c.timings.clear();
        c.trace(rays, any, c.hits);  // compiles
    }
    for (int round = 0; round < repeat; ++round) {
        for (Contestant& c : contestants) c.timings.push_back(c.trace(rays, any, c.hits));
    }
    const double count = static_cast<double>(countRays(rays));
    const double single = least(contestants.front().timings, &Timing::cpu);
    std::printf("  %-10s %8s %8s %8s   differ in hit / t / primitive\n", any ? "shadow" : "primary",
                "Mrays/s", "by CPU", "ratio");
    for (const Contestant& c : contestants) {
        const double cpu = least(c.timings, &Timing::cpu);
        std::printf("  %-10s %8.2f %8.2f %8.2f ", c.name.c_str(),
                    count / least(c.timings, &Timing::wall) * 1e-6, 2 * count / cpu * 1e-6, single / cpu);
        printDifferences(c, contestants.front(), any);
    }
}

// `packet`: null where the device or the scene has no packets.
std::vector<Contestant> contestantsOf(const Settings& settings, DeviceRays& lane, DeviceRays* packet,
                                      const EmbreeRays& embree) {
    std::vector<Contestant> all;
    const auto add = [&](const std::string& name, Trace trace) {
        if (settings.only.empty() || ("," + settings.only + ",").find("," + name + ",") != std::string::npos)
            all.push_back({name, std::move(trace)});
    };
    const auto addEmbree = [&](const char* name, EmbreeCall call) {
        add(name, [&embree, call](const auto& rays, bool any, auto& hits) {
            return embree.trace(rays, any, call, hits);
        });
    };
    const auto addDevice = [&](const char* name, DeviceRays& device) {
        add(name,
            [&device](const auto& rays, bool any, auto& hits) { return device.trace(rays, any, hits); });
    };
    addEmbree("embree1", EmbreeCall::Single);
    addEmbree("embree8", EmbreeCall::Packet8);
    addEmbree("embree16", EmbreeCall::Packet16);
    addDevice("lane", lane);
    if (packet != nullptr) addDevice("packet", *packet);
    return all;
}

void compare(const Settings& settings, const std::string& path, const gpu::Device& gpu) {
    const Scene scene = loadScene(path);
    const PackedScene packed = packScene(scene);
    const shared::Camera camera = packCamera(scene.camera, settings.width, settings.height, packed.origin);
    const EmbreeRays embree(packed);
    DeviceRays lane(gpu, packed, render::Traversal::Lane, settings.replaced);
    std::optional<DeviceRays> packet;
    if (hasPackets(gpu, packed)) packet.emplace(gpu, packed, render::Traversal::Packet, settings.replaced);
    std::printf("%s: %zu triangles, %zu spheres, %dx%d; BVH %.0f ms, Embree's %.0f ms\n", path.c_str(),
                packed.triangles.size(), packed.spheres.size(), settings.width, settings.height,
                packed.statistics.buildSeconds * 1e3, embree.buildSeconds() * 1e3);
    std::vector<Contestant> contestants = contestantsOf(settings, lane, packet ? &*packet : nullptr, embree);
    if (contestants.empty())
        throw Error(ErrorKind::Argument, "--only: no contestant \"" + settings.only + "\"");
    const std::vector<BenchRay> rays = cameraRays(packed, camera, settings.width, settings.height);
    compete(contestants, rays, false, settings.repeat);
    if (packed.lights.empty()) return;
    const std::vector<BenchRay> shadows = shadowRays(rays, contestants.front().hits, packed.lights[0]);
    if (countRays(shadows) > 0) compete(contestants, shadows, true, settings.repeat);
}

std::vector<uint32_t> readWords(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
    if (words.empty()) throw Error(ErrorKind::Argument, path + ": no kernel");
    std::memcpy(words.data(), bytes.data(), words.size() * sizeof(uint32_t));
    return words;
}

// intersect.spv for the kernel of that name, and so on.
void replaceKernel(const std::string& path, Replacements& replaced) {
    const std::map<std::string, std::vector<uint32_t>*> kernels = {
        {"intersect", &replaced.intersect},
        {"intersect_any", &replaced.intersectAny},
        {"packet_intersect", &replaced.packetIntersect},
        {"packet_intersect_any", &replaced.packetIntersectAny}};
    const auto kernel = kernels.find(std::filesystem::path(path).stem().string());
    if (kernel == kernels.end()) throw Error(ErrorKind::Argument, path + ": its name is no kernel's");
    *kernel->second = readWords(path);
}

Settings parse(int argc, char** argv) {
    Settings settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool value = i + 1 < argc;
        if (word == "--size" && value) {
            if (std::sscanf(argv[++i], "%dx%d", &settings.width, &settings.height) != 2)
                throw Error(ErrorKind::Argument, "--size: expected WxH");
        } else if (word == "--repeat" && value) {
            settings.repeat = std::max(1, std::atoi(argv[++i]));
        } else if (word == "--only" && value) {
            settings.only = argv[++i];
        } else if (word == "--kernel" && value) {
            replaceKernel(argv[++i], settings.replaced);
        } else if (word.starts_with("--")) {
            throw Error(ErrorKind::Argument, "unknown option " + word);
        } else {
            settings.scenes.push_back(word);
        }
    }
    if (settings.scenes.empty())
        throw Error(ErrorKind::Argument, "compare_embree [--size WxH] [--repeat N] [--only NAME] SCENE...");
    return settings;
}

}  // namespace
}  // namespace glint::bench

int main(int argc, char** argv) {
    try {
        const glint::bench::Settings settings = glint::bench::parse(argc, argv);
        const glint::gpu::Device device;
        std::printf("%s, %s\n", device.info().name.c_str(), device.info().driver.c_str());
        for (const std::string& scene : settings.scenes) glint::bench::compare(settings, scene, device);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "compare_embree: %s\n", e.what());
        return 1;
    }
}
