#include "app/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <new>
#include <ostream>
#include <string_view>
#include <thread>

#include "core/enum_names.h"
#include "core/error.h"
#include "core/text_file.h"
#include "gpu/device.h"

namespace glint::app {

namespace {

struct Command {
    const char* name;
    const char* help;
    Run (*declare)(OptionTable& table);
};

// In the order of the help text.
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
    "Exit codes: 0 done, 1 could not render or write, 2 usage, 3 invalid scene,\n"
    "4 no usable device, 5 difference found, 130 interrupted.";

#if defined(__clang__)
constexpr const char* kCompiler = "Clang " __clang_version__;
#else
constexpr const char* kCompiler = "GCC " __VERSION__;
#endif

// A line for each device, without a final line end.
std::string deviceLines() {
    std::string text;
    try {
        for (const gpu::DeviceInfo& d : gpu::listDevices())
            text += "\ndevice: " + d.name + ", " + d.driver + ", Vulkan " + d.api +
                    (d.usable ? "" : ", refused: " + d.reason);
    } catch (const std::exception& e) {
        return std::string("\ndevice: none: ") + e.what();
    }
    return text.empty() ? "\ndevice: none found by the Vulkan loader" : text;
}

// The program's name, version and, if `verbose`, its build configuration and the Vulkan devices.
std::string versionText(bool verbose) {
    const std::string version = std::string("glint ") + GLINT_VERSION;
    if (!verbose) return version;
    const std::string builtMpi = GLINT_MPI_TEXT;  // the package may lack the module
    return version + "\ncommit: " + builtCommit() + "\ncompiler: " + kCompiler +
           "\nbuild type: " + GLINT_BUILD_TYPE + "\nwindow: " + GLINT_WINDOW_TEXT +
           "\nMPI: " + (builtMpi == "no" || hasRanksModule() ? builtMpi : "no glint-mpi.so") +
           "\nEXR: " + GLINT_EXR_TEXT + deviceLines();
}

class HelpFormatter : public CLI::Formatter {
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return app->get_parent() == nullptr ? "Usage: glint COMMAND [OPTIONS]\n"
                                            : Formatter::make_usage(app, name);
    }
    // Without the options that it excludes, which CLI11 lists in no fixed order.
    std::string make_option_opts(const CLI::Option* option) const override {
        const std::string form = option->get_type_name();
        return (form.empty() ? "" : " " + form) + (option->get_expected_max() > 1 ? " ..." : "");
    }
};

}  // namespace

void declareProgram(CLI::App& app, Run& chosen) {
    app.name("glint");
    app.description(kDescription);
    app.formatter(std::make_shared<HelpFormatter>());  // commands added from here on inherit it
    app.set_help_flag("-h,--help", "print this help and exit");
    app.add_flag("--verbose")->description("with --version: print what was built in, too");
    app.add_flag_callback(
           "--version", [&app] { throw CLI::CallForVersion(versionText(app.count("--verbose") > 0), 0); },
           "print the version and exit")
        ->configurable(false);
    app.require_subcommand(0, 1);
    app.get_formatter()->column_width(34);
    for (const Command& command : kCommands) {
        CLI::App& added = *app.add_subcommand(command.name, command.help);
        added.group("Commands");
        OptionTable table(added);
        added.callback([&chosen, run = command.declare(table)] { chosen = run; });
    }
    app.footer(kFooter);  // after the commands, which would inherit it
}

namespace {

// `unknown option "--siez" (did you mean "--size"?)`, or `unexpected argument "x"` for other words.
std::string unexpected(const CLI::App& command, const std::string& argument) {
    const std::string name = argument.substr(0, argument.find('='));
    if (name.size() < 2 || name[0] != '-' || command.get_option_no_throw(name))
        return "unexpected argument " + quoted(argument);
    std::vector<std::string_view> known;  // without the dashes, which any two options have in common
    for (const CLI::Option* option : command.get_options())
        if (option->nonpositional()) known.push_back(option->get_single_name());
    const std::string_view meant =
        nearest(name.substr(std::min(name.find_first_not_of('-'), name.size())), known);
    return "unknown option " + quoted(name) +
           (meant.empty() ? "" : concat(" (did you mean \"--", meant, "\"?)"));
}

// Error in the first word of a command line, which must be a command or an option that stands alone; empty if
// the word is valid.
std::string firstWordError(const std::vector<std::string>& args) {
    if (args.empty()) return "";
    const std::string& word = args.front();
    std::vector<std::string_view> names;
    for (const Command& command : kCommands) {
        if (word == command.name) return "";
        names.push_back(command.name);
    }
    if (word == "-h" || word == "--help" || word == "--version" || word == "--verbose") return "";
    const std::string see = "; see glint --help";
    if (word.starts_with("-"))
        return "the command comes first, then its options (got " + quoted(word) + ")" + see;
    std::error_code ignored;
    if (std::filesystem::exists(word, ignored))
        return quoted(word) + " is no command; did you mean: glint render " + word;
    return "unknown command " + quoted(word) + " (" + suggestion(word, names, "there are") + ")" + see;
}

// One line for a command line that CLI11 refused.
std::string parseErrorLine(const CLI::App& app, const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    if (chosen.empty()) return std::string(error.what()) + "; see glint --help";
    const CLI::App& command = *chosen.front();
    const std::vector<std::string> extras = app.remaining(true);
    // A mistyped option is the likelier reason if something else is missing too.
    auto extra = std::ranges::find_if(extras, [](const std::string& s) { return s.starts_with("-"); });
    if (extra == extras.end()) extra = extras.begin();
    const std::string text = extra == extras.end() ? error.what() : unexpected(command, *extra);
    return command.get_name() + ": " + text + "; see glint " + command.get_name() + " --help";
}

// True if the command could do its work without the device that failed.
bool hostWould(const CLI::App& command) {
    if (command.get_name() == "devices") return true;
    return command.get_option_no_throw("--backend") != nullptr && command.count("--validation") == 0;
}

ExitCode runChosen(const CLI::App& command, const Run& chosen, std::ostream& out, std::ostream& err) {
    try {
        return chosen(out, err);
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Device || !hostWould(command)) throw;
        throw Error(e.kind(), std::string(e.what()) + "; or use --backend cpu, which needs no device");
    }
}

ExitCode parseAndRun(std::vector<std::string> args, std::ostream& out, std::ostream& err) {
    CLI::App app;
    Run chosen;
    declareProgram(app, chosen);
    if (!args.empty() && args.front() == "complete") {  // for shells, see glint pages
        complete(app, {args.begin() + 1, args.end()}, out);
        return ExitCode::Done;
    }
    if (!args.empty() && args.front() == "help") {
        args.erase(args.begin());
        args.push_back("--help");
    }
    if (const std::string wrong = firstWordError(args); !wrong.empty())
        throw Error(ErrorKind::Argument, wrong);
    try {
        std::reverse(args.begin(), args.end());  // the order that CLI11 takes a vector in
        app.parse(args);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() != 0) throw Error(ErrorKind::Argument, parseErrorLine(app, e));
        app.exit(e, out, err);  // --help and --version
        return ExitCode::Done;
    }
    if (chosen) return runChosen(*app.get_subcommands().front(), chosen, out, err);
    if (app.count("--verbose") > 0) throw Error(ErrorKind::Argument, "--verbose requires --version");
    err << app.help();
    return ExitCode::Usage;
}

}  // namespace

int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
    const auto failed = [&](ExitCode code, const std::string& message) {
        out.flush();  // results come before the error, if both go to one place
        // All processes of mpirun have the same command line; rank 0 alone reports its errors.
        if (code == ExitCode::Usage && rankOfLauncher() > 0) {
            // mpirun ends all processes when the first one leaves; rank 0 must have printed the error.
            std::this_thread::sleep_for(std::chrono::seconds(2));
            return static_cast<int>(code);
        }
        // Several errors of a scene stand below each other, indented; any other line break is a character of
        // a name. In one piece, so that mpirun does not put its own lines in between.
        std::string text = "glint: ";
        for (size_t at = 0, end = 0; at <= message.size(); at = end + 3) {
            end = std::min(message.find("\n  ", at), message.size());
            text += (at == 0 ? "" : "  ") + printable(std::string_view(message).substr(at, end - at)) + "\n";
        }
        err << text << std::flush;
        abortRanks(static_cast<int>(code));
        return static_cast<int>(code);
    };
    try {
        const ExitCode code = parseAndRun(args, out, err);
        if (!out.flush()) return failed(ExitCode::Failed, "cannot write to standard output");
        return static_cast<int>(code);
    } catch (const Error& e) {
        return failed(exitCodeOf(e.kind()), e.what());
    } catch (const std::bad_alloc&) {
        return failed(
            ExitCode::Failed,
            "not enough memory; for a large image, ask for a smaller --size, or for parts with --crop");
    } catch (const std::exception& e) {
        return failed(ExitCode::Failed, e.what());
    }
}

}  // namespace glint::app
