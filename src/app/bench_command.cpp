// `glint bench`: rays a second by class, and what every stage takes.
#include <cstdlib>
#include <optional>
#include <ostream>

#include "app/bench.h"
#include "app/cli.h"
#include "app/exit_code.h"
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

SceneOptions withScene(const SceneOptions& common, const std::filesystem::path& path) {
    SceneOptions options = common;
    options.scene = path;
    return options;
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
        device.emplace(gpu::DeviceOptions{command.device.selector, command.device.validation, {}, false});
        openSeconds = watch.seconds();
    }
    const bool json = command.stats == "json";
    std::vector<BenchResult> results;
    const auto finish = [&] {
        if (json && !results.empty()) out << benchJson(results);
    };
    try {
        for (const std::filesystem::path& path : command.scenes) {
            // One for each scene: its bar is gone when the table comes.
            Progress progress("bench " + path.filename().string(), command.progress, err, isTerminal(err));
            results.push_back(measureScene(
                command, withScene(command.common, path), device ? &*device : nullptr, openSeconds,
                [&](double fraction) { progress.update(fraction); }, err));
            progress.finish();
            if (!json) out << (results.size() > 1 ? "\n" : "") << benchTable(results.back()) << std::flush;
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
