// Takes the place of the sources that need src/farm, if CMake's GLINT_FARM is off.
#include "app/commands.h"
#include "app/render_command.h"
#include "core/error.h"

namespace glint::app {

namespace {

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorKind::Argument, what + ": this glint was built without it (GLINT_FARM is OFF)");
}

}  // namespace

bool isInUnits(const RenderCommand& command) {
    return command.part || !command.checkpoint.empty();
}

ExitCode renderInUnits(const RenderCommand& command, std::ostream&, std::ostream&) {
    refuse(command.part ? "--part" : "--checkpoint");
}

int rankOfLauncher() {
    return 0;
}

void abortRanks(int) {}

bool hasRanksModule() {
    return false;
}

Run mergeCommand(OptionTable& table) {
    table.acceptAll();
    return [](std::ostream&, std::ostream&) -> ExitCode { refuse("merge"); };
}

}  // namespace glint::app
