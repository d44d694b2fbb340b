// `glint bench`: rays a second by class, and what every stage takes.
#include <cstdlib>
#include <optional>
#include <ostream>

#include "app/commands.h"
#include "app/render_command.h"
#include "app/rendering.h"
#include "bench/measure.h"
#include "bench/write.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

struct BenchCommand {
    std::vector<std::filesystem::path> scenes;
    SceneOptions common;
    DeviceChoice device;
    bench::Options options;  // the values on the command line
    bool full = false;       // the code of every feature
    bool wholePaths = false;
    bool json = false;  // --stats
    ProgressMode progress = ProgressMode::Auto;
};

void declare(OptionTable& table, BenchCommand& c) {
    addScenes(table, c.scenes, c.common);
    addSceneOverrides(table, c.common);
    addMethods(table, c.common);
    addMinContribution(table, c.common);
    addBackend(table, c.device);
    addDevice(table, c.device);
    table.read("--traversal", alternatives<render::Traversal>() + "|all",
               "one ray per lane (lane) or 32 rays together (packet); all: also measure each",
               [&](const std::string& t) {
                   c.options.everyWalk = t == "all";
                   if (t != "all") c.device.traversal = parseNamed<render::Traversal>(t);
               });
    table.whole("--repeat", "N", "measure N images after the warm-up (default 7)", 1, 1000,
                c.options.repeats);
    table.value("--with", "LIST",
                "also compile these features, with commas, into the pipeline (names: glint info)",
                c.options.renderer.also, parseFeatures);
    table.flag("--full", "compile every feature into the pipeline", c.full);
    table.flag("--whole-paths", "use one kernel for whole paths, not one per step", c.wholePaths);
    table.requireGpu({"--device", "--validation", "--traversal", "--with", "--full", "--whole-paths"});
    addStats(table, "print the results as JSON instead of tables", c.json);
    addProgress(table, c.progress);
}

// Measure the first compilation: switch the drivers' caches off, unless the user set these variables.
void switchShaderCachesOff() {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
    setenv("__GL_SHADER_DISK_CACHE", "0", 0);
}

bench::Result measureScene(const BenchCommand& command, const std::filesystem::path& path,
                           const gpu::Device* device, std::ostream& err) {
    // One for each scene: its bar is gone when the table comes.
    Progress progress = progressOf("bench " + path.filename().string(), command.progress, err);
    SceneOptions scene = command.common;
    scene.scene = path;
    bench::Options options = command.options;
    options.context.cancelled = interrupted;
    options.context.progress = [&](double fraction) { progress.update(fraction); };
    const LoadedScene loaded = loadAndPack(scene, err);
    options.request = requestOf(loaded, scene);
    options.renderer.traversal = command.device.traversal;
    options.renderer.leaveOut = !command.full;
    if (command.wholePaths) options.renderer.wholePaths = render::WholePaths::On;
    if (alsoFor(loaded, options.request).mirrors) options.renderer.also.mirrors = true;
    checkMemory(options.request.width, options.request.height, bytesPerPixel(std::vector<Aov>()),
                availableMemory(), "");
    bench::Result result = bench::measure(path.string(), loaded, device, options);
    progress.finish();
    return result;
}

ExitCode run(const BenchCommand& command, std::ostream& out, std::ostream& err) {
    checkStandardOutput(out);
    switchShaderCachesOff();
    installInterruptHandler();
    std::optional<gpu::Device> device;
    double openSeconds = 0;
    if (command.device.backend == Backend::Gpu) {
        const Stopwatch watch;
        device.emplace(openDevice(command.device, false));
        openSeconds = watch.seconds();
    }
    const bench::Program program = {GLINT_VERSION, builtCommit()};
    std::vector<bench::Result> results;
    const auto finish = [&] {
        if (command.json && !results.empty()) out << bench::json(results, program);
    };
    try {
        for (const std::filesystem::path& path : command.scenes) {
            results.push_back(measureScene(command, path, device ? &*device : nullptr, err));
            results.back().open = openSeconds;
            if (!command.json)
                out << (results.size() > 1 ? "\n" : "") << bench::table(results.back(), program)
                    << std::flush;
        }
    } catch (const Cancelled&) {
        finish();
        throw Error(ErrorKind::Interrupted, "interrupted: " + std::to_string(results.size()) + " of " +
                                                counted(command.scenes.size(), "scene") + " measured");
    } catch (...) {
        finish();
        throw;
    }
    finish();
    if (device) checkValidation(*device, command.device);
    return ExitCode::Done;
}

}  // namespace

Run benchCommand(OptionTable& table) {
    return commandOf<BenchCommand>(table, declare, run);
}

}  // namespace glint::app
