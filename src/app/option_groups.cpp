#include "app/option_groups.h"

#include <cstdlib>

#include "core/error.h"
#include "core/thread_count.h"
#include "scene/limits.h"

namespace glint::app {

using Text = std::string;

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
    table.value("--size", "WxH", "size in pixels instead of the scene's",
                [&](const Text& t) { options.size = parseSize(t); });
    table.whole("--spp", "N", "samples for each pixel instead of the scene's", 1, kMaxSamplesPerPixel,
                options.spp);
    table.whole("--max-depth", "N",
                "greatest number of reflections and refractions in a row instead of the scene's", 0,
                kMaxBounces, options.maxDepth);
    table.choice<BuildQuality>("--build-quality",
                               "time spent on the BVH: " + explainedChoices<BuildQuality>(),
                               options.buildQuality);
    addCamera(table, options);
    table.value("--time", "SECONDS",
                "the scene at this moment of its animation (default: as its file says it)",
                [&](const Text& t) { options.time = parseNotNegative(t); });
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
                [&](const Text& t) { options.minContribution = parseNotNegative(t); });
}

void addSampling(OptionTable& table, SceneOptions& options) {
    table.choice<Sampler>("--sampler", "placement of samples instead of the scene's", options.sampler);
    table.value("--filter", "NAME[,RADIUS]", choices<Filter>() + " instead of the scene's; radius in pixels",
                [&](const Text& t) { options.filter = parseFilter(t); });
    table.value("--seed", "N", "seed of the random samplers instead of the scene's",
                [&](const Text& t) { options.seed = parseSeed(t); });
    table.value("--adaptive", "MAX[,THRESHOLD]",
                "take up to MAX samples in pixels whose samples differ, see docs/guide/sampling.md",
                [&](const Text& t) { options.adaptive = parseAdaptive(t); });
}

void addExposure(OptionTable& table, std::optional<double>& stops) {
    table.value("--exposure", "STOPS", "multiply the colours of a .png by 2^STOPS (default 0)",
                [&](const Text& t) { stops = parseStops(t); });
}

void addBackend(OptionTable& table, Backend& backend) {
    table.choice<Backend>("--backend",
                          "gpu (default), or cpu: the double-precision reference, needs no Vulkan", backend);
}

void addDevice(OptionTable& table, DeviceChoice& device) {
    table.name("--device", "NAME|INDEX", "index or part of the name, see glint devices (default: the best)",
               device.selector);
    table.value("--threads", "N",
                "host threads, of the reference and of lavapipe too (default: one a processor)",
                [](const Text& t) {
                    limitThreads(static_cast<unsigned>(parseWhole(t, 1, 1024)));
                    setenv("LP_NUM_THREADS", t.c_str(), 1);
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

void addStats(OptionTable& table, const Text& what, bool& json) {
    table.value("--stats", "json", what, [&](const Text& t) {
        if (t != "json") refuse("json", t);
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
