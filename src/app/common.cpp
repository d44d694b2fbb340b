#include "app/common.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "core/available_memory.h"
#include "core/error.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "import/load.h"
#include "pack/pack_samples.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

void overrideSampling(const SceneOptions& options, ImageSettings& image) {
    if (options.sampler) image.sampler = *options.sampler;
    if (options.filter) {
        image.filter = options.filter->filter;
        image.filterRadius = options.filter->radius.value_or(defaultRadius(image.filter));
    }
    if (options.seed) image.seed = *options.seed;
    if (options.adaptive) image.adaptive = options.adaptive;
    const std::string wrong = samplingConflict(image);
    if (!wrong.empty()) throw Error(ErrorKind::Argument, options.scene.string() + ": " + wrong);
}

}  // namespace

LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet) {
    if (options.scene.empty()) throw Error(ErrorKind::Argument, "SCENE is empty; give a file name");
    LoadedScene loaded;
    Stopwatch watch;
    loaded.scene = loadScene(options.scene, {options.allowOutside, availableMemory()});
    if (options.size) {
        loaded.scene.image.width = options.size->width;
        loaded.scene.image.height = options.size->height;
    }
    if (options.spp) loaded.scene.image.samplesPerPixel = *options.spp;
    if (options.maxDepth) loaded.scene.maxDepth = *options.maxDepth;
    overrideSampling(options, loaded.scene.image);
    loaded.loadSeconds = watch.seconds();
    watch.restart();
    loaded.packed = packScene(loaded.scene, 0, options.buildQuality);
    loaded.packSeconds = watch.seconds();
    if (!quiet) {
        for (const std::string& w : loaded.scene.warnings) err << "glint: warning: " << printable(w) << '\n';
        for (const std::string& w : loaded.packed.warnings) {
            err << "glint: warning: " << options.scene.string() << ": " << w << '\n';
        }
    }
    return loaded;
}

Request requestOf(const LoadedScene& loaded, const SceneOptions& options) {
    Request request = requestOf(loaded.scene.image, loaded.scene.camera.lensRadius > 0);
    request.methods = options.methods;
    request.minContribution = options.minContribution;
    return request;
}

namespace {

bool anyUsableDevice() {
    try {
        const std::vector<gpu::DeviceInfo> devices = gpu::listDevices();
        return std::any_of(devices.begin(), devices.end(), [](const gpu::DeviceInfo& d) { return d.usable; });
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

Error withAdvice(const Error& error) {
    if (anyUsableDevice()) return error;
    return {error.kind(), std::string(error.what()) + ", or use --backend cpu"};
}

gpu::Device openDevice(const DeviceChoice& choice, bool hostWould, bool keepPrograms) {
    try {
        gpu::Device device({choice.selector, choice.validation, {}, keepPrograms});
        if (!choice.validation || device.validationActive()) return device;
    } catch (const Error& error) {
        if (!hostWould) throw;
        throw withAdvice(error);
    }
    throw Error(ErrorKind::Device,
                "--validation: the layer VK_LAYER_KHRONOS_validation is not installed (Debian package "
                "vulkan-validationlayers)");
}

void reportValidation(const gpu::Device& device, const DeviceChoice& choice, std::ostream& err) {
    if (!choice.validation) return;
    const auto messages = device.validationMessages();
    for (const std::string& message : messages) err << "glint: validation: " << message << '\n';
    if (!messages.empty()) throw Error(ErrorKind::Device, "the validation layer found faults (listed above)");
}

bool isTerminal(const std::ostream& err) {
    return &err == &std::cerr && isatty(STDERR_FILENO) == 1;
}

std::string formatSeconds(double seconds) {
    char text[32];
    std::snprintf(text, sizeof(text), seconds < 1 ? "%.0f ms" : "%.2f s",
                  seconds < 1 ? seconds * 1e3 : seconds);
    return text;
}

}  // namespace glint::app
