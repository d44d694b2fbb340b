#include "app/command_list.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "app/version.h"

namespace glint::app {

namespace {

constexpr Command kCommands[] = {
    {"render", "render a scene to a picture", renderCommand},
    {"merge", "put the parts of a picture together that render --part drew", mergeCommand},
    {"view", "a window to look around a scene in", viewCommand},
    {"verify", "compare the shaders' picture with the reference's, pixel by pixel", verifyCommand},
    {"report", "error against run time, for many settings of each scene", reportCommand},
    {"bench", "rays a second for each class of rays, and the time that each stage takes", benchCommand},
    {"trace", "trace single rays and print what they hit as CSV", traceCommand},
    {"diff", "how far apart two pictures are; exit code 5 if they differ", diffCommand},
    {"info", "what a scene holds, and what its pipeline leaves out", infoCommand},
    {"devices", "the Vulkan devices, chosen or refused and why", devicesCommand},
    {"pages", "write man pages and completions for bash, zsh and fish", pagesCommand},
};

constexpr const char* kExamples[] = {
    "glint render scenes/spheres.json -o spheres.png --size 1280x960",
    "glint render bunny.ply --backend cpu",
    "glint verify scenes/spheres.json",
};

constexpr ExitCodeText kExitCodes[] = {
    {0, "done"},
    {1, "could not render or write"},
    {2, "usage"},
    {3, "the scene is at fault"},
    {4, "no usable device"},
    {5, "difference found"},
    {130, "interrupted"},
};

constexpr const char* kHelpText = "print this help and exit";
constexpr const char* kVersionText = "print the version and exit";
constexpr const char* kVerboseText = "with --version: print what was built in, too";

std::string footer() {
    std::string text = "Examples:\n";
    for (const char* line : kExamples) text += std::string("  ") + line + "\n";
    text += std::string("\n") + kCommandHelpHint + "\nExit codes:";
    constexpr size_t kWidth = 105;
    size_t column = text.size() - text.rfind('\n') - 1;
    for (const ExitCodeText& exit : kExitCodes) {
        const bool last = &exit == std::end(kExitCodes) - 1;
        const std::string item = std::to_string(exit.code) + " " + exit.meaning + (last ? "." : ",");
        const bool wraps = column + 1 + item.size() > kWidth;
        text += (wraps ? "\n" : " ") + item;
        column = (wraps ? 0 : column + 1) + item.size();
    }
    return text;
}

class HelpFormatter : public CLI::Formatter {
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return app->get_parent() == nullptr ? "Usage: glint COMMAND [OPTIONS]\n"
                                            : Formatter::make_usage(app, name);
    }
};

}  // namespace

const char* const kDescription =
    "a ray tracer in Vulkan compute shaders, checked against a double-precision reference";
const char* const kCommandHelpHint = "glint COMMAND --help tells a command's options.";

std::span<const Command> commands() {
    return kCommands;
}

std::span<const char* const> exampleLines() {
    return kExamples;
}

std::span<const ExitCodeText> exitCodeTexts() {
    return kExitCodes;
}

std::vector<Run> declareProgram(CLI::App& app, ProgramFlags& flags) {
    app.name("glint");
    app.description(std::string("glint: ") + kDescription);
    app.formatter(std::make_shared<HelpFormatter>());  // commands added from here on inherit it
    app.set_help_flag("-h,--help", kHelpText);
    // Before --version, whose callback ends the parsing.
    app.add_flag("--verbose", flags.verbose, kVerboseText)->disable_flag_override();
    app.add_flag_callback(
           "--version",
           [&flags] {
               const std::string text = std::string("glint ") + GLINT_VERSION;
               throw CLI::CallForVersion(flags.verbose ? text + "\n" + builtIn() : text, 0);
           },
           kVersionText)
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
    app.footer(footer());  // after the commands, which would inherit it
    return runs;
}

std::vector<CommandFacts> commandFacts() {
    std::vector<CommandFacts> all;
    for (const Command& command : kCommands) {
        CLI::App app;
        OptionTable table(app);
        command.declare(table);
        all.push_back({command.name, command.help, table.options()});
        all.back().options.push_back({.names = "-h,--help", .help = kHelpText});
    }
    return all;
}

std::vector<OptionFacts> programOptions() {
    return {{.names = "-h,--help", .help = kHelpText},
            {.names = "--version", .help = kVersionText},
            {.names = "--verbose", .help = kVerboseText}};
}

}  // namespace glint::app
