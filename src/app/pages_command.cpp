#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <ostream>

#include "app/common.h"
#include "app/output_check.h"
#include "app/pages.h"
#include "core/error.h"
#include "core/file_io.h"

namespace glint::app {

namespace {

using Text = std::string;

// Text for roff: escaped backslashes and hyphens, and no line that begins with a request.
Text roff(const Text& plain) {
    Text made;
    for (const char c : plain) {
        const bool starts = made.empty() || made.back() == '\n';
        if (starts && (c == '.' || c == '\'')) made += "\\&";
        made += c == '\\' ? "\\e" : c == '-' ? "\\-" : Text(1, c);
    }
    return made;
}

Text bold(const Text& plain) {
    return "\\fB" + roff(plain) + "\\fR";
}

Text italic(const Text& plain) {
    return "\\fI" + roff(plain) + "\\fR";
}

// "-o, --output FILE" and its help.
Text entry(const Argument& argument) {
    Text tag;
    for (const Text& name : argument.names)
        tag += (tag.empty() ? "" : ", ") + (argument.positional ? italic(name) : bold(name));
    if (!argument.form.empty()) tag += " " + italic(argument.form);
    return ".TP\n" + tag + "\n" + roff(argument.help) + "\n";
}

// A page of one command or, for the program itself, of all. Without a date: the same source makes the same
// page.
Text manPage(const Text& name, const CLI::App& command) {
    Text title = name, synopsis = bold(command.get_parent() ? "glint " + command.get_name() : name), options,
         commands;
    std::transform(title.begin(), title.end(), title.begin(),
                   [](unsigned char c) { return std::toupper(c); });
    for (const Argument& argument : argumentsOf(command)) {
        options += entry(argument);
        if (argument.positional) synopsis += " " + italic(argument.names[0]) + (argument.many ? " ..." : "");
    }
    for (const CLI::App* each : commandsOf(command))
        commands += ".TP\n" + bold(each->get_name()) + "\n" + roff(each->get_description()) + "\n";
    Text description = command.get_description();
    if (description.starts_with("glint: ")) description.erase(0, 7);
    Text made = ".TH " + roff(title) + " 1 \"\" \"glint " GLINT_VERSION "\" \"User Commands\"\n.SH NAME\n" +
                roff(name) + " \\- " + roff(description) + "\n.SH SYNOPSIS\n" + synopsis +
                (commands.empty() ? "" : " " + italic("COMMAND")) + " [" + italic("OPTIONS") + "]\n";
    if (!commands.empty()) made += ".SH COMMANDS\n" + commands;
    if (!options.empty()) made += ".SH OPTIONS\n" + options;
    if (!command.get_footer().empty()) made += ".SH NOTES\n.nf\n" + roff(command.get_footer()) + "\n.fi\n";
    return made + ".SH SEE ALSO\n" +
           (commands.empty() ? bold("glint") + "(1), for the exit codes"
                             : bold("glint-render") + "(1) and the pages of the other commands") +
           "\n";
}

struct Page {
    Text path, text;
};

std::vector<Page> allPages() {
    CLI::App program;
    bool verbose = false;
    declareProgram(program, verbose);
    // Folders below /usr/share that each shell reads; bash and fish also read them below ~/.local/share.
    std::vector<Page> pages = {{"bash-completion/completions/glint", bashCompletion(program)},
                               {"zsh/vendor-completions/_glint", zshCompletion(program)},
                               {"fish/vendor_completions.d/glint.fish", fishCompletion(program)},
                               {"man/man1/glint.1", manPage("glint", program)}};
    for (const CLI::App* command : commandsOf(program)) {
        const Text name = "glint-" + command->get_name();
        pages.push_back({"man/man1/" + name + ".1", manPage(name, *command)});
    }
    return pages;
}

struct PagesCommand {
    std::filesystem::path folder;
};

void declare(OptionTable& table, PagesCommand& c) {
    table.name("FOLDER", "", "where man/, bash-completion/, zsh/ and fish/ go, such as ~/.local/share",
               c.folder, OptionTable::Need::Required);
}

ExitCode run(const PagesCommand& command, std::ostream& out, std::ostream&) {
    checkOutputFolder(command.folder);
    std::vector<OutputFile> files;
    for (const Page& page : allPages()) {
        files.push_back({command.folder / page.path, {page.text.begin(), page.text.end()}});
        makeFolder(files.back().path.parent_path());
    }
    writeFiles(files);
    for (const OutputFile& file : files) out << "wrote " << shown(file.path) << '\n';
    return ExitCode::Done;
}

}  // namespace

Run pagesCommand(OptionTable& table) {
    return commandOf<PagesCommand>(table, declare, run);
}

}  // namespace glint::app
