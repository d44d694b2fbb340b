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

ExitCode renderPart(const RenderCommand&, std::ostream&, std::ostream&) {
    refuse("--part");
}

ExitCode renderFromCheckpoint(const RenderCommand&, std::ostream&, std::ostream&) {
    refuse("--checkpoint");
}

bool isForRanks(const RenderCommand&) {
    return false;
}

ExitCode renderAmongRanks(const RenderCommand&, std::ostream&, std::ostream&) {
    refuse("mpirun");
}

int rankOfLauncher() {
    return 0;
}

void abortRanks(int) {}

bool hasRanksModule() {
    return false;
}

Run mergeCommand(OptionTable&) {
    return [](std::ostream&, std::ostream&) -> ExitCode { refuse("merge"); };
}

}  // namespace glint::app
