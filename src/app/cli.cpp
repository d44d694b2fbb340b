#include "app/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <new>
#include <ostream>
#include <thread>

#include "app/command_list.h"
#include "app/exit_code.h"
#include "app/render_ranks.h"
#include "app/usage.h"
#include "core/error.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

int parseAndRun(std::vector<std::string> args, std::ostream& out, std::ostream& err) {
    CLI::App app;
    bool verbose = false;
    const std::vector<Run> runs = declareProgram(app, verbose);
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
        if (app.got_subcommand(commands()[i].name)) return static_cast<int>(runs[i](out, err));
    if (verbose) throw Error(ErrorKind::Argument, "--verbose requires --version");
    err << app.help();
    return static_cast<int>(ExitCode::Usage);
}

}  // namespace

int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
    const auto failed = [&](ExitCode code, const std::string& message) {
        out.flush();  // results come before the error, whoever reads both
        // All processes of mpirun have the same command line; rank 0 reports what is wrong with it.
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
