#include "app/common.h"

#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/animated_scene.h"
#include "core/error.h"
#include "core/near_names.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "scene/sampling.h"

namespace glint::app {

LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet) {
    return AnimatedScene(options, options.time, err, quiet).take();
}

void checkScene(const std::filesystem::path& scene) {
    namespace fs = std::filesystem;
    constexpr std::string_view kKinds[] = {".json", ".gltf", ".glb", ".nff", ".obj", ".ply", ".stl"};
    std::error_code failed;
    std::string nearest;
    const std::string stem = scene.stem().string();
    size_t best = stem.size() / 3 + 1;
    if (!fs::exists(scene, failed) && stem.size() < 64) {
        for (const auto& entry : fs::directory_iterator(fs::path(".") / scene.parent_path(), failed)) {
            const fs::path& path = entry.path();
            if (std::find(std::begin(kKinds), std::end(kKinds), lowerExtension(path)) == std::end(kKinds))
                continue;
            const size_t distance = editDistance(stem, path.stem().string());
            if (distance >= best) continue;
            best = distance;
            nearest = path.filename().string();
        }
    }
    if (!nearest.empty())
        throw Error(ErrorKind::Scene,
                    printable(scene.string() + ": no such file (did you mean \"" + nearest + "\"?)"));
    checkFile(scene);
}

Request requestOf(const LoadedScene& loaded, const SceneOptions& options) {
    ImageSettings image = loaded.scene.image;
    if (options.size) {
        image.width = options.size->width;
        image.height = options.size->height;
    }
    if (options.spp) image.samplesPerPixel = *options.spp;
    if (options.sampler) image.sampler = *options.sampler;
    if (options.filter) {
        image.filter = options.filter->filter;
        image.filterRadius = options.filter->radius.value_or(defaultRadius(image.filter));
    }
    if (options.seed) image.seed = *options.seed;
    if (options.adaptive) image.adaptive = options.adaptive;
    // --error ignores the scene's number of samples.
    if (options.untilError)
        image.samplesPerPixel = std::max(image.samplesPerPixel, static_cast<int>(leastSamples(image.filter)));
    if (const std::string wrong = samplingConflict(image); !wrong.empty())
        throw Error(ErrorKind::Argument, options.scene.string() + ": " + wrong);
    Request request = requestOf(image, loaded.scene.camera.lensRadius > 0);
    request.methods = options.methods;
    request.minContribution = options.minContribution;
    if (options.maxDepth) request.maxDepth = static_cast<uint32_t>(*options.maxDepth);
    return request;
}

int depthOf(const LoadedScene& loaded, const Request& request) {
    return request.maxDepth ? static_cast<int>(*request.maxDepth) : loaded.scene.maxDepth;
}

SceneFeatures alsoFor(const LoadedScene& loaded, const Request& request) {
    const auto& materials = loaded.scene.materials;
    SceneFeatures also;
    also.mirrors =
        depthOf(loaded, request) > 0 && std::any_of(materials.begin(), materials.end(),
                                                    [](const Material& m) { return m.mirror != Color(0); });
    return also;
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

std::string format(const char* form, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, form);
    std::vsnprintf(text, sizeof(text), form, arguments);
    va_end(arguments);
    return text;
}

std::string formatSeconds(double seconds) {
    return seconds < 1 ? format("%.0f ms", seconds * 1e3) : format("%.2f s", seconds);
}

void printJson(const nlohmann::json& json, std::ostream& out) {
    out << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

std::string shown(const std::filesystem::path& file) {
    return printable(file.string());
}

}  // namespace glint::app
