#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <ostream>

#include "app/cli.h"
#include "core/file_io.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

using Text = std::string;

// "-o" and "--output", or "SCENE".
std::vector<Text> optionNames(const CLI::Option& option) {
    std::vector<Text> names;
    if (option.get_positional()) names.push_back(option.get_name());
    for (const Text& name : option.get_snames()) names.push_back("-" + name);
    for (const Text& name : option.get_lnames()) names.push_back("--" + name);
    return names;
}

std::vector<const CLI::App*> commandsOf(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

// The values of a form such as "gpu|cpu"; none of "x|y" names, as in "NAME|INDEX".
std::vector<Text> choicesOf(const Text& form) {
    const auto isName = [](const Text& text) {
        return !text.empty() && std::islower(static_cast<unsigned char>(text[0])) &&
               std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c); });
    };
    const std::vector<Text> choices = split(form, '|');
    return std::all_of(choices.begin(), choices.end(), isName) ? choices : std::vector<Text>();
}

// Each script runs `glint complete`; without output the shell completes file names.
constexpr const char* kBash = R"(# Made by glint pages.
_glint() {
    local line
    COMPREPLY=()
    while IFS= read -r line; do
        COMPREPLY+=("${line%%$'\t'*}")
    done < <("${COMP_WORDS[0]/#\~/$HOME}" complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
}
complete -o default -F _glint glint
)";
constexpr const char* kZsh = R"(#compdef glint
# Made by glint pages.
local -a found
found=("${(@f)$("${${(Q)words[1]}/#\~/$HOME}" complete "${(@Q)words[2,CURRENT]}" 2>/dev/null)}")
found=(${found//$'\t'/:})
if (( $#found )); then _describe glint found; else _files; fi
)";
constexpr const char* kFish = R"(# Made by glint pages.
function __glint_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct)
    set -l program (string replace -r '^~' $HOME -- $words[1])
    set -e words[1]
    $program complete $words "$current" 2>/dev/null
end
complete -c glint -n '__glint_complete | string length -q' -f -a '(__glint_complete)'
)";

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
Text entry(const CLI::Option& option) {
    std::vector<Text> names;
    for (const Text& name : optionNames(option))
        names.push_back(option.get_positional() ? italic(name) : bold(name));
    Text tag = joined(names);
    if (!option.get_type_name().empty()) tag += " " + italic(option.get_type_name());
    return ".TP\n" + tag + "\n" + roff(option.get_description()) + "\n";
}

// A page of one command or, for the program itself, of all. Without a date: the same source makes the same
// page.
Text manPage(const Text& name, const CLI::App& command) {
    Text title = name, synopsis = bold(command.get_parent() ? "glint " + command.get_name() : name), options,
         commands;
    std::transform(title.begin(), title.end(), title.begin(),
                   [](unsigned char c) { return std::toupper(c); });
    for (const CLI::Option* option : command.get_options()) {
        options += entry(*option);
        if (option->get_positional())
            synopsis += " " + italic(option->get_name()) + (option->get_expected_max() > 1 ? " ..." : "");
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
    Run chosen;
    declareProgram(program, chosen);
    std::vector<OutputFile> pages;
    const auto add = [&](const Text& path, const Text& text) {
        pages.push_back({folder / path, {text.begin(), text.end()}});
    };
    add("bash-completion/completions/glint", kBash);
    add("zsh/vendor-completions/_glint", kZsh);
    add("fish/vendor_completions.d/glint.fish", kFish);
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
    table.name("FOLDER", "", "for man/, bash-completion/, zsh/ and fish/, such as ~/.local/share", c.folder);
}

ExitCode run(const PagesCommand& command, std::ostream& out, std::ostream&) {
    const std::vector<OutputFile> files = pagesIn(command.folder);
    for (const OutputFile& file : files) makeFolder(file.path.parent_path());
    writeFiles(files);
    for (const OutputFile& file : files) out << "wrote " << shown(file.path) << '\n';
    return ExitCode::Done;
}

}  // namespace

void complete(const CLI::App& program, const std::vector<std::string>& words, std::ostream& out) {
    const Text current = words.empty() ? "" : words.back();
    const auto offer = [&](const Text& word, const Text& help) {
        if (word.starts_with(current)) out << word << '\t' << help << '\n';
    };
    const auto offerOptions = [&](const CLI::App& command) {
        for (const CLI::Option* option : command.get_options())
            for (const Text& name : optionNames(*option))
                if (current.starts_with('-')) offer(name, option->get_description());
    };
    const bool first = words.size() < 2;
    if (first) offerOptions(program);
    if (first) offer("help", "print the help of a command");
    for (const CLI::App* command : commandsOf(program)) {
        if (first || words[0] == "help") offer(command->get_name(), command->get_description());
        if (first || words[0] != command->get_name()) continue;
        for (const CLI::Option* option : command->get_options()) {
            if (option->get_items_expected_max() == 0 || !option->check_name(words.end()[-2])) continue;
            for (const Text& choice : choicesOf(option->get_type_name())) offer(choice, "");
            return;
        }
        offerOptions(*command);
    }
}

Run pagesCommand(OptionTable& table) {
    return commandOf<PagesCommand>(table, declare, run);
}

}  // namespace glint::app
