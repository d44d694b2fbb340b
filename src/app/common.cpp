#include "app/common.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>

#include "core/error.h"
#include "core/stopwatch.h"
#include "scene/load.h"

namespace glint::app {

LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet) {
    LoadedScene loaded;
    Stopwatch watch;
    loaded.scene = loadScene(options.scene);
    if (options.size) {
        loaded.scene.image.width = options.size->width;
        loaded.scene.image.height = options.size->height;
    }
    if (options.spp) loaded.scene.image.samplesPerPixel = *options.spp;
    if (options.maxDepth) loaded.scene.maxDepth = *options.maxDepth;
    loaded.loadSeconds = watch.seconds();
    watch.restart();
    loaded.packed = packScene(loaded.scene);
    loaded.packSeconds = watch.seconds();
    if (!quiet) {
        for (const std::string& w : loaded.scene.warnings) err << "glint: warning: " << w << '\n';
        for (const std::string& w : loaded.packed.warnings) {
            err << "glint: warning: " << options.scene.string() << ": " << w << '\n';
        }
    }
    return loaded;
}

bool reportValidation(const gpu::Device& device, const DeviceChoice& choice, std::ostream& err) {
    if (!choice.validation) return false;
    if (!device.validationActive()) {
        throw Error(ExitCode::Device, "--validation: the layer VK_LAYER_KHRONOS_validation is not installed (Debian package vulkan-validationlayers)");
    }
    const auto messages = device.validationMessages();
    for (const std::string& message : messages) err << "glint: validation: " << message << '\n';
    return !messages.empty();
}

bool isTerminal(const std::ostream& err) { return &err == &std::cerr && isatty(STDERR_FILENO) == 1; }

namespace {

PixelData toData(const reference::PixelResult& pixel) {
    PixelData data;
    data.position = pixel.position;
    data.depth = pixel.depth;
    data.normal = glm::vec3(pixel.normal);
    data.geometricNormal = glm::vec3(pixel.normal);
    data.u = static_cast<float>(pixel.u);
    data.v = static_cast<float>(pixel.v);
    data.object = static_cast<uint32_t>(pixel.object);
    data.primitive = static_cast<uint32_t>(pixel.primitive);
    data.material = static_cast<uint32_t>(pixel.material);
    data.bounces = pixel.bounces;
    data.cost = static_cast<uint32_t>(pixel.cost);
    data.pathHash = pixel.pathHash;
    data.shadowBits = pixel.shadowBits;
    return data;
}

}  // namespace

Picture toPicture(const reference::RenderResult& result) {
    Picture picture;
    picture.region = {result.x0, result.y0, result.x0 + result.width, result.y0 + result.height};
    picture.color = Image(result.width, result.height, 4);
    picture.complete = result.complete;
    picture.data.reserve(result.pixels.size());
    for (size_t i = 0; i < result.pixels.size(); ++i) {
        const reference::PixelResult& pixel = result.pixels[i];
        float* color = &picture.color.pixels[i * 4];
        for (int c = 0; c < 3; ++c) color[c] = static_cast<float>(pixel.color[c]);
        color[3] = static_cast<float>(pixel.alpha);
        if (!std::isfinite(color[0] + color[1] + color[2])) ++picture.notFinite;
        picture.data.push_back(toData(pixel));
        picture.done.push_back(result.rowsDone[i / result.width]);
    }
    return picture;
}

std::string formatSeconds(double seconds) {
    char text[32];
    std::snprintf(text, sizeof(text), seconds < 1 ? "%.0f ms" : "%.2f s", seconds < 1 ? seconds * 1e3 : seconds);
    return text;
}

}  // namespace glint::app
