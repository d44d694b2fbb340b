#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

using Text = std::string;

// An option of a command.
struct Argument {
    explicit Argument(const CLI::Option& option);

    bool positional = false, many = false, takesValue = false;
    bool file = false, folder = false;  // the value is the name of one
    std::vector<Text> names;            // "-o" and "--output", or "SCENE"
    Text form, help;
    std::vector<Text> choices;  // if the option has a list of values
};

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

// The options of one command: a line for each option with a list of choices, and a line for the rest. The
// shell offers files for other arguments.
Text bashCases(const CLI::App& command) {
    const std::vector<Argument> arguments = argumentsOf(command);
    Text cases;
    for (const Argument& argument : arguments) {
        if (argument.positional || !argument.takesValue) continue;
        for (const Text& name : argument.names)
            cases += "        '" + command.get_name() + " " + name + "') words='" +
                     joined(argument.choices, " ") + "' ;;\n";
    }
    return cases + "        '" + command.get_name() + " '*) [[ $current == -* ]] && words='" +
           optionNames(arguments) + "' ;;\n";
}

Text bashCompletion(const CLI::App& program) {
    const Text names = commandNames(program);
    Text made = kMadeBy + Text(R"(_glint() {
    local current=${COMP_WORDS[COMP_CWORD]} words=''
    case "${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD-1]}" in
)");
    for (const CLI::App* command : commandsOf(program)) made += bashCases(*command);
    return made + "        'help '*) words='" + names + R"(' ;;
    esac
    if [[ $COMP_CWORD -eq 1 ]]; then words=')" +
           names + " help " + optionNames(argumentsOf(program)) + R"('; fi
    COMPREPLY=($(compgen -W "$words" -- "$current"))
}
complete -o default -F _glint glint
)";
}

Text fishQuoted(const Text& plain) {
    Text made = "'";
    for (const char c : plain) made += (c == '\\' || c == '\'' ? "\\" : "") + Text(1, c);
    return made + "'";
}

// Text within single quotes of zsh, where brackets and colons end a part of a specification.
Text zshEscaped(const Text& plain) {
    Text made;
    for (const char c : plain) {
        if (Text("[]:\\").find(c) != Text::npos) made += '\\';
        made += c == '\'' ? "'\\''" : Text(1, c);
    }
    return made;
}

// A specification of zsh's _arguments for each name.
Text zshLines(const CLI::App& command) {
    Text made;
    for (const Argument& argument : argumentsOf(command)) {
        const Text values = !argument.choices.empty() ? "(" + joined(argument.choices, " ") + ")"
                            : argument.file           ? "_files"
                            : argument.folder         ? "_files -/"
                                                      : " ";
        for (const Text& name : argument.names) {
            made += " \\\n            '";
            if (argument.positional)
                made += (argument.many ? "*:" : ":") + name + ":" + values;
            else
                made += "(" + joined(argument.names, " ") + ")" + name +
                        (argument.takesValue && name.starts_with("--") ? "=" : "") + "[" +
                        zshEscaped(argument.help) + "]" +
                        (argument.takesValue ? ":" + zshEscaped(argument.form) + ":" + values : "");
            made += "'";
        }
    }
    return made;
}

// zsh runs the file as the body of a function.
Text zshCompletion(const CLI::App& program) {
    Text commands, cases;
    for (const CLI::App* command : commandsOf(program)) {
        commands += "\n    '" + command->get_name() + ":" + zshEscaped(command->get_description()) + "'";
        cases += "        " + command->get_name() + ") _arguments" + zshLines(*command) + " ;;\n";
    }
    return "#compdef glint\n" + Text(kMadeBy) + "local -a commands=(" + commands +
           "\n)\nif (( CURRENT == 2 )) && [[ $words[2] == -* ]]; then\n    _arguments" + zshLines(program) +
           "\nelif (( CURRENT == 2 )) || [[ $words[2] == help ]]; then\n    _describe command "
           "commands\nelse\n"
           "    shift words\n    (( CURRENT-- ))\n    case $words[1] in\n" +
           cases + "    esac\nfi\n";
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

// Below the folder that stands for /usr/share; bash and fish also read theirs below ~/.local/share.
std::vector<OutputFile> pagesIn(const std::filesystem::path& folder) {
    CLI::App program;
    bool verbose = false;
    Run chosen;
    declareProgram(program, verbose, chosen);
    std::vector<OutputFile> pages;
    const auto add = [&](const Text& path, const Text& text) {
        pages.push_back({folder / path, {text.begin(), text.end()}});
    };
    add("bash-completion/completions/glint", bashCompletion(program));
    add("zsh/vendor-completions/_glint", zshCompletion(program));
    add("fish/vendor_completions.d/glint.fish", fishCompletion(program));
    add("man/man1/glint.1", manPage("glint", program));
    for (const CLI::App* command : commandsOf(program)) {
        const Text name = "glint-" + command->get_name();
        add("man/man1/" + name + ".1", manPage(name, *command));
    }
    return pages;
}

struct PagesCommand {
    std::filesystem::path folder;
};

void declare(OptionTable& table, PagesCommand& c) {
    table.name("FOLDER", "", "for man/, bash-completion/, zsh/ and fish/, such as ~/.local/share", c.folder,
               OptionTable::Need::Required);
}

ExitCode run(const PagesCommand& command, std::ostream& out, std::ostream&) {
    const std::vector<OutputFile> files = pagesIn(command.folder);
    for (const OutputFile& file : files) makeFolder(file.path.parent_path());
    writeFiles(files);
    for (const OutputFile& file : files) out << "wrote " << shown(file.path) << '\n';
    return ExitCode::Done;
}

}  // namespace

Run pagesCommand(OptionTable& table) {
    return commandOf<PagesCommand>(table, declare, run);
}

}  // namespace glint::app
