#include "app/command_list.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "app/version.h"

namespace glint::app {

namespace {

constexpr Command kCommands[] = {
    {"render", "render a scene to an image", renderCommand},
    {"merge", "merge the parts of an image that render --part wrote", mergeCommand},
    {"view", "open a window to explore a scene", viewCommand},
    {"verify", "compare shaders and reference, pixel by pixel", verifyCommand},
    {"report", "measure error against run time, for many settings of each scene", reportCommand},
    {"bench", "measure rays per second of each class, and the time of each stage", benchCommand},
    {"trace", "trace single rays and print what they hit as CSV", traceCommand},
    {"diff", "compare two images; exit code 5 if they differ", diffCommand},
    {"info", "print the contents of a scene, and what its pipeline leaves out", infoCommand},
    {"devices", "list the Vulkan devices, chosen or refused and why", devicesCommand},
    {"pages", "write man pages and completions for bash, zsh and fish", pagesCommand},
};

constexpr const char* kDescription =
    "glint: a ray tracer in Vulkan compute shaders, checked against a double-precision reference";

constexpr const char* kFooter =
    "Examples:\n"
    "  glint render scenes/spheres.json -o spheres.png --size 1280x960\n"
    "  glint render bunny.ply --backend cpu\n"
    "  glint verify scenes/spheres.json\n"
    "\n"
    "glint COMMAND --help prints a command's options.\n"
    "Exit codes: 0 done, 1 could not render or write, 2 usage, 3 the scene is at fault,\n"
    "4 no usable device, 5 difference found, 130 interrupted.";

class HelpFormatter : public CLI::Formatter {
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return app->get_parent() == nullptr ? "Usage: glint COMMAND [OPTIONS]\n"
                                            : Formatter::make_usage(app, name);
    }
};

}  // namespace

std::span<const Command> commands() {
    return kCommands;
}

std::vector<Run> declareProgram(CLI::App& app, bool& verbose) {
    app.name("glint");
    app.description(kDescription);
    app.formatter(std::make_shared<HelpFormatter>());  // commands added from here on inherit it
    app.set_help_flag("-h,--help", "print this help and exit");
    // Before --version, whose callback ends the parsing.
    app.add_flag("--verbose", verbose, "with --version: print what was built in, too")
        ->disable_flag_override();
    app.add_flag_callback(
           "--version",
           [&verbose] {
               const std::string text = std::string("glint ") + GLINT_VERSION;
               throw CLI::CallForVersion(verbose ? text + "\n" + builtIn() : text, 0);
           },
           "print the version and exit")
        ->configurable(false);
    app.require_subcommand(0, 1);
    app.get_formatter()->label("REQUIRED", "");
    app.get_formatter()->column_width(34);
    std::vector<Run> runs;
    for (const Command& command : kCommands) {
        CLI::App& added = *app.add_subcommand(command.name, command.help);
        added.group("Commands");
        OptionTable table(added);
        runs.push_back(command.declare(table));
    }
    app.footer(kFooter);  // after the commands, which would inherit it
    return runs;
}

}  // namespace glint::app
