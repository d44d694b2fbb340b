#include "app/common.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "core/error.h"
#include "core/stopwatch.h"
#include "scene/load.h"

namespace glint::app {

LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet) {
    if (options.scene.empty()) throw Error(ExitCode::Usage, "SCENE is empty; give a file name");
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
    loaded.packed.methods = options.methods;
    loaded.packSeconds = watch.seconds();
    if (!quiet) {
        for (const std::string& w : loaded.scene.warnings) err << "glint: warning: " << w << '\n';
        for (const std::string& w : loaded.packed.warnings) {
            err << "glint: warning: " << options.scene.string() << ": " << w << '\n';
        }
    }
    return loaded;
}

shared::Camera cameraOf(const LoadedScene& loaded) {
    const Scene& scene = loaded.scene;
    return packCamera(scene.camera, scene.image.width, scene.image.height, loaded.packed.origin);
}

void reportValidation(const gpu::Device& device, const DeviceChoice& choice, std::ostream& err) {
    if (!choice.validation) return;
    if (!device.validationActive()) {
        throw Error(ExitCode::Device,
                    "--validation: the layer VK_LAYER_KHRONOS_validation is not installed (Debian package "
                    "vulkan-validationlayers)");
    }
    const auto messages = device.validationMessages();
    for (const std::string& message : messages) err << "glint: validation: " << message << '\n';
    if (!messages.empty()) throw Error(ExitCode::Device, "the validation layer found faults (listed above)");
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

std::string counted(uint64_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace glint::app
