// `glint bench`: rays a second by class, and what every stage takes.
#include <cstdlib>
#include <optional>
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/version.h"
#include "bench/measure.h"
#include "bench/write.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"

namespace glint::app {

namespace {

// What compiling takes is what it takes the first time. Whoever sets these himself has reasons.
void switchShaderCachesOff() {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
    setenv("__GL_SHADER_DISK_CACHE", "0", 0);
}

bench::Options optionsOf(const BenchCommand& command) {
    bench::Options options;
    options.tracing.methods = command.common.methods;
    options.tracing.minContribution = command.common.minContribution;
    options.renderer.traversal = command.device.traversal;
    options.renderer.leaveOut = !command.full;
    options.renderer.also = command.with;
    options.renderer.compaction = command.compaction;
    options.repeats = command.repeats;
    options.everyWalk = command.everyWalk;
    options.cancelled = interrupted;
    return options;
}

bench::Result measureScene(const BenchCommand& command, const std::filesystem::path& path,
                           const gpu::Device* device, std::ostream& err) {
    // One for each scene: its bar is gone when the table comes.
    Progress progress("bench " + path.filename().string(), command.progress, err, isTerminal(err));
    SceneOptions scene = command.common;
    scene.scene = path;
    bench::Options options = optionsOf(command);
    options.progress = [&](double fraction) { progress.update(fraction); };
    bench::Result result = bench::measure(path.string(), loadAndPack(scene, err), device, options);
    progress.finish();
    return result;
}

}  // namespace

int runBench(const BenchCommand& command, std::ostream& out, std::ostream& err) {
    for (const std::filesystem::path& path : command.scenes)
        if (path.empty()) throw Error(ErrorKind::Argument, "SCENE is empty; give a file name");
    switchShaderCachesOff();
    installInterruptHandler();
    std::optional<gpu::Device> device;
    double openSeconds = 0;
    if (command.backend == Backend::Gpu) {
        const Stopwatch watch;
        device.emplace(openDevice(command.device, true, false));
        openSeconds = watch.seconds();
    }
    const bool json = command.stats == "json";
    const bench::Program program = {GLINT_VERSION, builtCommit()};
    std::vector<bench::Result> results;
    const auto finish = [&] {
        if (json && !results.empty()) out << bench::json(results, program);
    };
    try {
        for (const std::filesystem::path& path : command.scenes) {
            results.push_back(measureScene(command, path, device ? &*device : nullptr, err));
            results.back().open = openSeconds;
            if (!json)
                out << (results.size() > 1 ? "\n" : "") << bench::table(results.back(), program)
                    << std::flush;
        }
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Interrupted) throw;
        finish();
        throw Error(ErrorKind::Interrupted, "interrupted: " + std::to_string(results.size()) + " of " +
                                                counted(command.scenes.size(), "scene") + " measured");
    }
    finish();
    if (device) reportValidation(*device, command.device, err);
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
