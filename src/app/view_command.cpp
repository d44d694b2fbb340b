
#include "app/commands.h"
#include "app/options.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "gpu/swapchain.h"
#ifdef GLINT_WINDOW
#include "view/view.h"
#endif

namespace glint::app {

namespace {

struct ViewCommand {
    SceneOptions scene;
    DeviceChoice device;
    ErrorTarget target;
    int frames = 0;
    gpu::PresentMode present = gpu::PresentMode::Fifo;
    int pace = 0;  // milliseconds; 0: by the device
    double scale = 0;
};

void declare(OptionTable& table, ViewCommand& c) {
    addScene(table, c.scene);
    addSceneOverrides(table, c.scene);
    addError(table, c.target);
    addDevice(table, c.device);
    table.whole("--frames", "N", "close after N frames", 1, 1'000'000, c.frames);
    table.choice<gpu::PresentMode>(
        "--present", explainedChoices<gpu::PresentMode>() + "; fifo where the screen has no other",
        c.present);
    table.whole("--target", "MS", "milliseconds a frame to aim for while the camera moves", 1, 10'000,
                c.pace);
    table.real("--scale", "X", "text and controls X times as large, 0.5 to 4 (default: as the screen asks)",
               0.5, 4, c.scale);
}

#ifdef GLINT_WINDOW
ExitCode run(const ViewCommand& command, std::ostream& out, std::ostream& err) {
    if (command.scene.scene == "-")
        throw Error(ErrorKind::Argument, "SCENE: the window needs a file, which it watches for changes");
    view::Options options;
    options.until = command.target.limits;
    options.until.error = command.target.error.value_or(0);
    options.until.depthCounts = !command.target.withinDepth;
    options.scene = command.scene.scene;
    options.loading.allowOutside = command.scene.allowOutside;
    options.loading.camera = command.scene.camera;
    options.loading.up = command.scene.up;
    options.time = command.scene.time;
    options.loading.quality = command.scene.buildQuality;
    if (command.scene.size) {
        options.width = command.scene.size->width;
        options.height = command.scene.size->height;
    }
    options.loading.depth = command.scene.limits.depth;
    options.loading.samplesPerPixel = command.scene.spp;
    options.device = command.device.selector;
    options.validation = command.device.validation;
    options.frames = static_cast<uint64_t>(command.frames);
    options.presentMode = command.present;
    options.scale = command.scale;
    options.targetSeconds = command.pace * 1e-3;
    view::view(options, out, err);
    return interrupted() ? ExitCode::Interrupted : ExitCode::Done;
}
#else
ExitCode run(const ViewCommand&, std::ostream&, std::ostream&) {
    throw Error(
        ErrorKind::Argument,
        "view: this glint was built without the window (GLINT_WINDOW is OFF, or GLFW or Dear ImGui was "
        "missing); glint render SCENE draws to a file");
}
#endif

}  // namespace

Run viewCommand(OptionTable& table) {
    return commandOf<ViewCommand>(table, declare, run);
}

}  // namespace glint::app
