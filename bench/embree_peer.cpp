// embree_peer [--size WxH | --shrink N] [--samples N] [--rounds N] [--seconds S] [--series] [-o FOLDER]
// SCENE...
//
// Draws a scene's picture by glint's shaders, as `glint render` does, and by a plain Whitted tracer over
// Embree's single rays (peer/tracer.h), in turns, and prints for each scene a line of JSON: the seconds of
// both, on the clock and of all processors, and how far the pictures are apart. --seconds: fewer rounds where
// they would take longer, but two at least. --series: as one of many pictures, for which glint takes
// kernels that trace faster and begin later (docs/lab/speed.md). -o: writes both pictures, as PFM.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image_diff.h"
#include "core/image_io.h"
#include "import/load.h"
#include "pack/loaded_scene.h"
#include "pack/pack_samples.h"
#include "peer/tracer.h"
#include "rays.h"
#include "render/renderer.h"

namespace glint::bench {
namespace {

// One step of a PNG's darker half; single precision is 1e4 times finer.
constexpr double kTolerance = 1.0 / 255;

struct Settings {
    int width = 0, height = 0, samples = 0, rounds = 5;
    double shrink = 1, seconds = 1e9;
    bool series = false;
    std::filesystem::path output;
    std::vector<std::string> scenes;
};

struct Seconds {
    std::vector<Timing> timings;

    std::string json(double Timing::*clock) const {
        std::string text;
        for (const Timing& t : timings) {
            char number[32];
            std::snprintf(number, sizeof(number), "%s%.6f", text.empty() ? "" : ", ", t.*clock);
            text += number;
        }
        return "[" + text + "]";
    }
    std::string json() const {
        return "{\"wall\": " + json(&Timing::wall) + ", \"processors\": " + json(&Timing::cpu) + "}";
    }
};

void resize(ImageSettings& image, const Settings& settings) {
    if (settings.width > 0) {
        image.width = settings.width;
        image.height = settings.height;
    }
    const auto smaller = [&](int side) {
        return std::max(8, static_cast<int>(std::lround(side / settings.shrink)));
    };
    image.width = smaller(image.width);
    image.height = smaller(image.height);
    if (settings.samples > 0) image.samplesPerPixel = settings.samples;
}

void compare(const Settings& settings, const std::string& path, const gpu::Device& device) {
    LoadedScene loaded;
    loaded.scene = loadScene(path);
    resize(loaded.scene.image, settings);
    const std::string name = std::filesystem::path(path).stem().string();
    std::optional<peer::Tracer> tracer;
    try {
        tracer.emplace(loaded.scene);
    } catch (const std::invalid_argument& reason) {
        std::printf("{\"scene\": \"%s\", \"leftOut\": \"%s\"}\n", name.c_str(), reason.what());
        return;
    }
    loaded.packed = packScene(loaded.scene);
    Request request = requestOf(loaded.scene.image, loaded.scene.camera);
    request.ledger = loaded.packed.features.transmission;
    render::Options options;
    options.expected = &request;
    if (!settings.series) options.cameraRays = cameraRaysOf(request);
    render::Renderer renderer(device, loaded.packed, options);

    Seconds ours, theirs;
    Image a, b;
    double spent = 0;
    // The first round warms up: the driver translates kernels on first use, and slices find their size.
    for (int round = 0; round <= settings.rounds && (round < 3 || spent < settings.seconds); ++round) {
        const Timer first;
        a = renderer.render(request).color;
        const Timing one = first.elapsed();
        const Timer second;
        b = tracer->render();
        const Timing other = second.elapsed();
        spent += one.wall + other.wall;
        if (round == 0) continue;
        ours.timings.push_back(one);
        theirs.timings.push_back(other);
    }
    const ImageDifference d = compareImages(a, b, kTolerance);
    std::printf(
        "{\"scene\": \"%s\", \"width\": %d, \"height\": %d, \"samples\": %u, \"glint\": %s, \"peer\": %s, "
        "\"rmse\": %.3g, \"mean\": %.3g, \"differ\": %.6f, \"peerBuild\": %.6f}\n",
        name.c_str(), a.width, a.height, request.samples.count(), ours.json().c_str(), theirs.json().c_str(),
        d.rmse, d.mean, static_cast<double>(d.above) / static_cast<double>(d.pixels), tracer->buildSeconds());
    std::fflush(stdout);
    if (settings.output.empty()) return;
    Image colors(a.width, a.height, 3);
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x)
            for (int c = 0; c < 3; ++c) colors.at(x, y, c) = a.at(x, y, c);
    writeImage(settings.output / (name + ".glint.pfm"), colors);
    writeImage(settings.output / (name + ".peer.pfm"), b);
}

Settings parse(int argc, char** argv) {
    Settings settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool value = i + 1 < argc;
        if (word == "--size" && value) {
            if (std::sscanf(argv[++i], "%dx%d", &settings.width, &settings.height) != 2)
                throw Error(ErrorKind::Argument, "--size: expected WxH");
        } else if (word == "--shrink" && value) {
            settings.shrink = std::atof(argv[++i]);
        } else if (word == "--samples" && value) {
            settings.samples = std::atoi(argv[++i]);
        } else if (word == "--rounds" && value) {
            settings.rounds = std::max(2, std::atoi(argv[++i]));
        } else if (word == "--seconds" && value) {
            settings.seconds = std::atof(argv[++i]);
        } else if (word == "--series") {
            settings.series = true;
        } else if (word == "-o" && value) {
            settings.output = argv[++i];
        } else if (word.starts_with("-")) {
            throw Error(ErrorKind::Argument, "unknown option " + word);
        } else {
            settings.scenes.push_back(word);
        }
    }
    if (settings.scenes.empty()) throw Error(ErrorKind::Argument, "embree_peer [OPTION...] SCENE...");
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
        std::fprintf(stderr, "embree_peer: %s\n", e.what());
        return 1;
    }
}
