#include "app/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <new>
#include <ostream>

#include "app/commands.h"
#include "app/exit_code.h"
#include "app/usage.h"
#include "core/error.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

constexpr const char* kFooter =
    "Examples:\n"
    "  glint render scenes/spheres.json -o spheres.png --size 1280x960\n"
    "  glint render bunny.ply --backend cpu\n"
    "  glint verify scenes/spheres.json\n"
    "\n"
    "glint COMMAND --help tells a command's options.\n"
    "Exit codes: 0 done, 1 could not render or write, 2 usage, 3 the scene is at fault, 4 no usable device,\n"
    "5 difference found, 130 interrupted.";

struct Command {
    const char* name;
    const char* help;
    Run (*declare)(OptionTable& table);
};

// In the order of the help text.
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
};

class HelpFormatter : public CLI::Formatter {
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return app->get_parent() == nullptr ? "Usage: glint COMMAND [OPTIONS]\n"
                                            : Formatter::make_usage(app, name);
    }
};

// The command line without its commands.
void prepare(CLI::App& app) {
    app.formatter(std::make_shared<HelpFormatter>());  // commands added from here on inherit it
    app.set_version_flag("--version", "glint " GLINT_VERSION, "print the version and exit");
    app.set_help_flag("-h,--help", "print this help and exit");
    app.require_subcommand(0, 1);
    app.get_formatter()->label("REQUIRED", "");
    app.get_formatter()->column_width(34);
}

int parseAndRun(std::vector<std::string> args, std::ostream& out, std::ostream& err) {
    CLI::App app(
        "glint: a ray tracer in Vulkan compute shaders, checked against a double-precision reference",
        "glint");
    prepare(app);
    std::vector<Run> runs;
    for (const Command& command : kCommands) {
        CLI::App& added = *app.add_subcommand(command.name, command.help);
        added.group("Commands");
        OptionTable table(added);
        runs.push_back(command.declare(table));
    }
    app.footer(kFooter);  // after the commands, which would inherit it
    if (!args.empty() && args.front() == "help") {
        args.erase(args.begin());
        args.push_back("--help");
    }
    if (const std::string wrong = firstWordError(app, args); !wrong.empty())
        throw Error(ErrorKind::Argument, wrong);
    try {
        std::reverse(args.begin(), args.end());  // the order that CLI11 takes a vector in
        app.parse(args);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() != 0) throw Error(ErrorKind::Argument, parseErrorLine(app, e));
        app.exit(e, out, err);  // --help and --version
        return static_cast<int>(ExitCode::Done);
    }
    for (size_t i = 0; i < runs.size(); ++i)
        if (app.got_subcommand(kCommands[i].name)) return runs[i](out, err);
    err << app.help();
    return static_cast<int>(ExitCode::Usage);
}

}  // namespace

int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
    const auto failed = [&](ExitCode code, const std::string& message) {
        out.flush();  // results come before the error, whoever reads both
        err << "glint: " << printable(message) << std::endl;
        return static_cast<int>(code);
    };
    try {
        const int code = parseAndRun(args, out, err);
        if (!out.flush()) return failed(ExitCode::Failed, "cannot write to standard output");
        return code;
    } catch (const Error& e) {
        return failed(exitCodeOf(e.kind()), e.what());
    } catch (const std::bad_alloc&) {
        return failed(
            ExitCode::Failed,
            "not enough memory; for a large picture, ask for a smaller --size, or for parts with --crop");
    } catch (const std::exception& e) {
        return failed(ExitCode::Failed, e.what());
    }
}

}  // namespace glint::app
