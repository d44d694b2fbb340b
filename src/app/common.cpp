#include "app/common.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "app/animated_scene.h"
#include "core/error.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"

namespace glint::app {

LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet) {
    return AnimatedScene(options, options.time, err, quiet).take();
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
        return gpu::Device({choice.selector, choice.validation, {}, keepPrograms});
    } catch (const Error& error) {
        if (!hostWould) throw;
        throw withAdvice(error);
    }
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

std::string shown(const std::filesystem::path& file) {
    return printable(file.string());
}

}  // namespace glint::app
