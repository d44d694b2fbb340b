#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <ostream>

#include "app/common.h"
#include "app/pages.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"

namespace glint::app {

using Text = std::string;

Argument::Argument(const CLI::Option& option)
    : positional(option.get_positional()),
      many(option.get_expected_max() > 1),
      takesValue(option.get_items_expected_max() != 0),
      form(option.get_type_name()),
      help(option.get_description()) {
    if (positional) names.push_back(option.get_name());
    for (const Text& name : option.get_snames()) names.push_back("-" + name);
    for (const Text& name : option.get_lnames()) names.push_back("--" + name);
    folder = form == "FOLDER" || names[0] == "FOLDER";
    file = form.starts_with("FILE") || (positional && !folder);
    const auto isName = [](const Text& text) {
        return !text.empty() && std::islower(static_cast<unsigned char>(text[0])) &&
               std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c); });
    };
    choices = split(form, '|');
    if (!std::all_of(choices.begin(), choices.end(), isName)) choices.clear();
}

std::vector<Argument> argumentsOf(const CLI::App& command) {
    std::vector<Argument> arguments;
    for (const CLI::Option* option : command.get_options()) arguments.emplace_back(*option);
    return arguments;
}

std::vector<const CLI::App*> commandsOf(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

namespace {

constexpr const char* kMadeBy = "# Made by glint pages; not to be edited.\n";

Text commandNames(const CLI::App& program) {
    std::vector<Text> names;
    for (const CLI::App* command : commandsOf(program)) names.push_back(command->get_name());
    return joined(names, " ");
}

Text optionNames(const std::vector<Argument>& arguments) {
    std::vector<Text> names;
    for (const Argument& argument : arguments)
        if (!argument.positional) names.insert(names.end(), argument.names.begin(), argument.names.end());
    return joined(names, " ");
}

// In single quotes, for all three shells; `special` characters get a backslash.
Text quotedFor(const Text& plain, const Text& special, const Text& apostrophe) {
    Text made = "'";
    for (const char c : plain) {
        if (special.find(c) != Text::npos) made += '\\';
        made += c == '\'' ? apostrophe : Text(1, c);
    }
    return made + "'";
}

// Completion after an option: a line of bash's `case`.
Text bashCase(const Text& command, const Argument& argument) {
    std::vector<Text> patterns;
    for (const Text& name : argument.names) patterns.push_back("'" + command + " " + name + "'");
    Text then = "return";
    if (!argument.choices.empty()) then = "words='" + joined(argument.choices, " ") + "'";
    if (argument.file) then = "compopt -o default; return";
    if (argument.folder) then = "compopt -o dirnames; return";
    return "        " + joined(patterns, " | ") + ") " + then + " ;;\n";
}

// One argument of zsh's _arguments.
Text zshSpec(const Argument& argument) {
    const auto inner = [](const Text& plain) {
        const Text quoted = quotedFor(plain, "[]:\\", "'\\''");
        return quoted.substr(1, quoted.size() - 2);
    };
    const Text action = !argument.choices.empty() ? "(" + joined(argument.choices, " ") + ")"
                        : argument.file           ? "_files"
                        : argument.folder         ? "_files -/"
                                                  : " ";
    if (argument.positional)
        return "'" + Text(argument.many ? "*:" : ":") + inner(argument.names[0]) + ":" + action + "'";
    const Text rest = "[" + inner(argument.help) + "]" +
                      (argument.takesValue ? ":" + argument.form + ":" + action : "") + "'";
    if (argument.names.size() == 1) return "'" + argument.names[0] + rest;
    return "'(" + joined(argument.names, " ") + ")'{" + joined(argument.names, ",") + "}'" + rest;
}

Text fishQuoted(const Text& plain) {
    return quotedFor(plain, "\\", "\\'");
}

Text fishLine(const Text& condition, const Argument& argument) {
    Text made = "complete -c glint -n '" + condition + "'";
    if (!argument.positional)
        for (const Text& name : argument.names)
            made += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!argument.choices.empty())
        made += " -x -a '" + joined(argument.choices, " ") + "'";
    else if (argument.file)
        made += argument.positional ? " -F" : " -r -F";
    else if (argument.folder)
        made += " -x -a '(__fish_complete_directories)'";
    else if (argument.takesValue)
        made += " -x";
    return made + " -d " + fishQuoted(argument.help) + "\n";
}

Text bashCompletion(const CLI::App& program) {
    Text values, cases;
    for (const CLI::App* command : commandsOf(program)) {
        const std::vector<Argument> arguments = argumentsOf(*command);
        cases +=
            "        " + command->get_name() + ")\n            options='" + optionNames(arguments) + "'\n";
        bool first = true;
        for (const Argument& argument : arguments) {
            if (argument.positional && first)
                cases += Text("            files=") + (argument.folder ? "dirnames" : "default") + "\n";
            first = first && !argument.positional;
            if (!argument.positional && argument.takesValue)
                values += bashCase(command->get_name(), argument);
        }
        cases += "            ;;\n";
    }
    const Text names = commandNames(program);
    return kMadeBy + Text(R"(_glint() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]}
    local words='' options='' files=''
    COMPREPLY=()
    if [[ $COMP_CWORD -eq 1 ]]; then
        mapfile -t COMPREPLY < <(compgen -W ')") +
           names + " help " + optionNames(argumentsOf(program)) + R"(' -- "$current")
        return
    fi
    case "$command $previous" in
)" + values +
           R"(    esac
    case $command in
)" + cases +
           "        help) words='" + names + R"(' ;;
    esac
    if [[ -z $words && $current == -* ]]; then words=$options; fi
    if [[ -n $words ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    elif [[ -n $files ]]; then
        compopt -o "$files"
    fi
}
complete -F _glint glint
)";
}

Text zshCompletion(const CLI::App& program) {
    const auto specs = [](const CLI::App& command, const Text& indent) {
        Text text;
        for (const Argument& argument : argumentsOf(command)) text += " \\\n" + indent + zshSpec(argument);
        return text;
    };
    Text names, cases;
    for (const CLI::App* command : commandsOf(program)) {
        names += "        " +
                 quotedFor(command->get_name() + ":" + command->get_description(), "[]\\", "'\\''") + "\n";
        cases += "            " + command->get_name() + ")\n                _arguments -s" +
                 specs(*command, "                    ") + "\n                ;;\n";
    }
    return "#compdef glint\n" + Text(kMadeBy) + R"(_glint() {
    local curcontext=$curcontext state line
    local -a commands
    commands=(
)" + names +
           "    )\n    _arguments -C" + specs(program, "        ") + R"( \
        '1:command:->command' '*::argument:->argument'
    case $state in
        command) _describe -t commands command commands ;;
        argument)
            case $words[1] in
)" + cases +
           R"(            esac
            ;;
    esac
}
_glint "$@"
)";
}

Text fishCompletion(const CLI::App& program) {
    Text made = kMadeBy + Text("complete -c glint -f\n");
    for (const Argument& argument : argumentsOf(program)) made += fishLine("__fish_use_subcommand", argument);
    for (const CLI::App* command : commandsOf(program)) {
        made += "complete -c glint -n __fish_use_subcommand -a " + command->get_name() + " -d " +
                fishQuoted(command->get_description()) + "\n";
        for (const Argument& argument : argumentsOf(*command))
            made += fishLine("__fish_seen_subcommand_from " + command->get_name(), argument);
    }
    return made;
}

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
    std::vector<Text> names;
    for (const Text& name : argument.names) names.push_back(argument.positional ? italic(name) : bold(name));
    Text tag = joined(names);
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
    Run chosen;
    declareProgram(program, verbose, chosen);
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
