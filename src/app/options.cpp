#include "app/options.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "core/error.h"
#include "core/parallel.h"
#include "scene/limits.h"

namespace glint::app {

void OptionTable::read(const std::string& names, const std::string& form, const std::string& help,
                       const std::function<void(const std::string& text)>& use, Need need) {
    // "--output" of "-o,--output".
    const auto named = [name = names.substr(names.rfind(',') + 1), use](const std::string& text) {
        try {
            use(text);
        } catch (const Error& e) {
            throw Error(e.kind(), name + ": " + e.what());
        }
    };
    command_.add_option_function<std::string>(names, named, help)
        ->type_name(form)
        ->required(need == Need::Required);
}

void OptionTable::files(const std::string& name, const std::string& help,
                        std::vector<std::filesystem::path>& target) {
    const auto use = [name, &target](const std::vector<std::string>& list) {
        for (const std::string& text : list)
            if (text.empty()) throw Error(ErrorKind::Argument, name + ": the name is empty");
        target.assign(list.begin(), list.end());
    };
    command_.add_option_function<std::vector<std::string>>(name, use, help)->type_name("")->required();
}

void OptionTable::flag(const std::string& names, const std::string& help, bool& target) {
    command_.add_flag(names, target, help)->disable_flag_override();
}

namespace {

void addOutside(OptionTable& table, bool& allowed) {
    table.flag("--allow-outside", "allow files outside the scene's folder", allowed);
}

}  // namespace

void addScene(OptionTable& table, SceneOptions& options) {
    table.name(
        "SCENE", "",
        "a scene (.json .gltf .glb .nff) or a model alone (.obj .ply .stl); - reads JSON from standard input",
        options.scene, OptionTable::Need::Required);
    addOutside(table, options.allowOutside);
}

void addScenes(OptionTable& table, std::vector<std::filesystem::path>& scenes, bool& allowOutside) {
    table.files("SCENE", "scenes or models", scenes);
    addOutside(table, allowOutside);
}

void addSceneOverrides(OptionTable& table, SceneOptions& options) {
    table.value("--size", "WxH", "size in pixels instead of the scene's", options.size, parseSize);
    table.whole("--spp", "N", "samples for each pixel instead of the scene's", 1, kMaxSamplesPerPixel,
                options.spp);
    table.whole("--max-depth", "N",
                "greatest number of reflections and refractions in a row instead of the scene's", 0,
                kMaxBounces, options.limits.depth);
    table.choice<BuildQuality>("--build-quality",
                               "time spent on the BVH: " + explainedChoices<BuildQuality>(),
                               options.buildQuality);
    addCamera(table, options);
    table.value("--time", "SECONDS",
                "the scene at this moment of its animation (default: as its file says it)", options.time,
                parseNotNegative);
}

void addCamera(OptionTable& table, std::string& name) {
    table.name("--camera", "NAME", "the scene's camera of this name (glint info lists them)", name);
}

void addCamera(OptionTable& table, SceneOptions& options) {
    addCamera(table, options.camera);
    table.choice<UpAxis>("--up", "axis that points up in a model without a camera (default y)", options.up);
}

void addMethods(OptionTable& table, SceneOptions& options) {
    table.choice<TriangleMethod>(
        "--intersector",
        "test for triangles (default watertight); the others are textbook methods, with their faults",
        options.methods.triangles);
    table.choice<SphereMethod>(
        "--sphere", "test for spheres (default robust); the others are textbook methods, with their faults",
        options.methods.spheres);
}

void addMinContribution(OptionTable& table, SceneOptions& options) {
    table.value("--min-contribution", "X",
                "cut reflected and refracted rays that add less than X to a pixel (default 0)",
                options.limits.minContribution, parseNotNegative);
}

void addSampling(OptionTable& table, SceneOptions& options) {
    table.choice<Sampler>("--sampler", "placement of samples instead of the scene's", options.sampler);
    table.value("--filter", "NAME[,RADIUS]", choices<Filter>() + " instead of the scene's; radius in pixels",
                options.filter, parseFilter);
    table.value("--seed", "N", "seed of the random samplers instead of the scene's", options.seed, parseSeed);
    table.value("--adaptive", "MAX[,THRESHOLD]",
                "take up to MAX samples in pixels whose samples differ, see docs/guide/sampling.md",
                options.adaptive, parseAdaptive);
}

void addExposure(OptionTable& table, std::optional<double>& stops) {
    table.real("--exposure", "STOPS", "multiply the colours of a .png by 2^STOPS (default 0)", -100, 100,
               stops);
}

void addBackend(OptionTable& table, Backend& backend) {
    table.choice<Backend>("--backend",
                          "gpu (default), or cpu: the double-precision reference, needs no Vulkan", backend);
}

void addDevice(OptionTable& table, DeviceChoice& device) {
    table.name("--device", "NAME|INDEX", "index or part of the name, see glint devices (default: the best)",
               device.selector);
    table.read("--threads", "N",
               "host threads, of the reference and of lavapipe too (default: one a processor)",
               [](const std::string& text) {
                   limitThreads(static_cast<unsigned>(parseWhole(text, 1, 1024)));
                   setenv("LP_NUM_THREADS", text.c_str(), 1);
               });
    table.flag("--validation", "run the Vulkan validation layer; its messages are errors", device.validation);
}

void addTraversal(OptionTable& table, DeviceChoice& device) {
    table.choice<render::Traversal>(
        "--traversal",
        "trace each ray alone (lane) or 32 rays together (packet); default auto: see glint info",
        device.traversal);
}

void addFallback(OptionTable& table, DeviceChoice& device) {
    table.choice<Fallback>("--fallback",
                           "if the device fails or cannot be opened: " + explainedChoices<Fallback>(),
                           device.fallback);
}

void addProgress(OptionTable& table, ProgressMode& mode) {
    table.choice<ProgressMode>("--progress", "on standard error (default auto: a bar on a terminal)", mode);
}

void addStats(OptionTable& table, const std::string& help, bool& json) {
    table.read("--stats", "json", help, [&](const std::string& text) {
        if (text != "json") refuse("json", text);
        json = true;
    });
}

void checkDeviceOptions(Backend backend, const DeviceChoice& device) {
    if (device.validation && device.fallback != Fallback::None)
        throw Error(ErrorKind::Argument,
                    "--fallback: not together with --validation, which is there to see the device fail");
    if (backend == Backend::Gpu) return;
    const std::pair<bool, const char*> given[] = {
        {device.fallback != Fallback::None, "--fallback"},
        {!device.selector.empty(), "--device"},
        {device.validation, "--validation"},
        {device.traversal != render::Traversal::Auto, "--traversal"},
        {device.reproducible, "--reproducible"}};
    for (const auto& [is, option] : given)
        if (is) throw Error(ErrorKind::Argument, std::string(option) + ": needs --backend gpu");
}

}  // namespace glint::app
