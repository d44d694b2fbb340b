
#include "app/commands.h"
#include "app/options.h"
#include "core/error.h"
#include "core/interrupt.h"
#ifdef GLINT_WINDOW
#include "view/view.h"
#endif

namespace glint::app {

namespace {

struct ViewCommand {
    SceneOptions scene;
    DeviceChoice device;
    converge::Target target = {.error = 0};  // 0: without --error
    int frames = 0;
    double scale = 0;
};

void declare(OptionTable& table, ViewCommand& c) {
    addScene(table, c.scene, "");
    addSceneOverrides(table, c.scene, "a window of 1280x800 or more");
    addError(table, c.target);
    addDevice(table, c.device);
    table.whole("--frames", "N", "close after N frames", 1, 1'000'000, c.frames);
    table.real("--scale", "X", "scale of text and controls, 0.5 to 4 (default: the screen's)", 0.5, 4,
               c.scale);
}

#ifdef GLINT_WINDOW
ExitCode run(const ViewCommand& command, std::ostream& out, std::ostream& err) {
    refuseIf(command.scene.scene == "-",
             "SCENE: the window needs a file, which it watches for changes; save standard input to one");
    const SceneOptions& scene = command.scene;
    const view::Options options = {
        .scene = scene.scene,
        .loading = {scene.loading, scene.buildQuality},
        .wishes = {scene.limits.depth, scene.spp},
        .until = command.target,
        .time = scene.time,
        .width = scene.size.value_or(Size()).width,
        .height = scene.size.value_or(Size()).height,
        .scale = command.scale,
        .device = command.device.selector,
        .validation = command.device.validation,
        .frames = static_cast<uint64_t>(command.frames),
    };
    view::view(options, out, err);
    return interrupted() ? ExitCode::Interrupted : ExitCode::Done;
}
#else
ExitCode run(const ViewCommand&, std::ostream&, std::ostream&) {
    throw Error(
        ErrorKind::Argument,
        "view: this glint was built without the window (GLINT_WINDOW is OFF, or GLFW or Dear ImGui was "
        "missing); use glint render SCENE");
}
#endif

}  // namespace

Run viewCommand(OptionTable& table) {
    return commandOf<ViewCommand>(table, declare, run);
}

}  // namespace glint::app
