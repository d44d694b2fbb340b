#include "app/cli.h"
#include "app/exit_code.h"
#include "core/error.h"
#include "core/interrupt.h"
#ifdef GLINT_WINDOW
#include "view/view.h"
#endif

namespace glint::app {

#ifdef GLINT_WINDOW
int runView(const ViewCommand& command, std::ostream& out, std::ostream& err) {
    if (command.scene.scene.empty()) throw Error(ErrorKind::Argument, "SCENE is empty; give a file name");
    view::Options options;
    options.scene = command.scene.scene;
    if (command.scene.size) {
        options.width = command.scene.size->width;
        options.height = command.scene.size->height;
    }
    options.maxDepth = command.scene.maxDepth;
    options.samplesPerPixel = command.scene.spp;
    options.device = command.device.selector;
    options.validation = command.device.validation;
    options.frames = command.frames;
    options.script = command.script;
    options.presentMode = command.present;
    options.targetSeconds = command.target * 1e-3;
    view::view(options, out, err);
    return static_cast<int>(interrupted() ? ExitCode::Interrupted : ExitCode::Done);
}
#else
int runView(const ViewCommand&, std::ostream&, std::ostream&) {
    throw Error(
        ErrorKind::Argument,
        "view: this glint was built without the window (GLINT_WINDOW is OFF, or GLFW or Dear ImGui was "
        "missing); glint render SCENE draws to a file");
}
#endif

}  // namespace glint::app
