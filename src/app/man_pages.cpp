#include <algorithm>
#include <cctype>

#include "app/pages.h"

namespace glint::app {

namespace {

using Text = std::string;

// Text for roff: a backslash, a hyphen that is one, and no line that begins with a request.
Text roff(const Text& plain) {
    Text made;
    for (size_t i = 0; i < plain.size(); ++i) {
        const char c = plain[i];
        const bool starts = i == 0 || plain[i - 1] == '\n';
        if (starts && (c == '.' || c == '\'')) made += "\\&";
        if (c == '\\')
            made += "\\e";
        else if (c == '-')
            made += "\\-";
        else
            made += c;
    }
    return made;
}

Text upper(Text text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
    return text;
}

Text bold(const Text& plain) {
    return "\\fB" + roff(plain) + "\\fR";
}

Text italic(const Text& plain) {
    return "\\fI" + roff(plain) + "\\fR";
}

Text pageName(const Text& command) {
    return command.empty() ? "glint" : "glint-" + command;
}

// No date, so that the same source makes the same page.
Text head(const Text& command, const Text& help) {
    return ".TH " + roff(upper(pageName(command))) +
           " 1 \"\" \"glint " GLINT_VERSION "\" \"User Commands\"\n.SH NAME\n" + roff(pageName(command)) +
           " \\- " + roff(help) + "\n";
}

// "-o, --output FILE", in bold and italics.
Text tag(const OptionFacts& option) {
    if (option.positional()) return italic(option.names);
    Text made;
    for (size_t start = 0, end = 0; end != Text::npos; start = end + 1) {
        end = option.names.find(',', start);
        made += (made.empty() ? "" : ", ") + bold(option.names.substr(start, end - start));
    }
    if (option.value != OptionFacts::Value::None) made += " " + italic(option.form);
    return made;
}

Text list(const Text& title, const std::vector<OptionFacts>& options, bool positional) {
    Text made;
    for (const OptionFacts& option : options)
        if (option.positional() == positional)
            made += ".TP\n" + tag(option) + "\n" + roff(option.help) + "\n";
    return made.empty() ? made : ".SH " + title + "\n" + made;
}

Text exitStatus() {
    Text made = ".SH EXIT STATUS\n";
    for (const ExitCodeText& exit : exitCodeTexts())
        made += ".TP\n" + bold(std::to_string(exit.code)) + "\n" + roff(exit.meaning) + "\n";
    return made;
}

Text commandPage(const CommandFacts& command) {
    Text made = head(command.name, command.help) + ".SH SYNOPSIS\n" + bold("glint " + command.name);
    for (const OptionFacts& option : command.options)
        if (option.positional()) made += " " + italic(option.names) + (option.many ? " ..." : "");
    return made + " [" + italic("OPTIONS") + "]\n" + list("ARGUMENTS", command.options, true) +
           list("OPTIONS", command.options, false) + exitStatus() + ".SH SEE ALSO\n" + bold("glint") +
           "(1)\n";
}

Text programPage(const std::vector<CommandFacts>& commands) {
    Text made = head("", kDescription) + ".SH SYNOPSIS\n" + bold("glint") + " " + italic("COMMAND") + " [" +
                italic("OPTIONS") + "]\n.SH DESCRIPTION\n" + roff(kCommandHelpHint) + "\n.SH COMMANDS\n";
    Text pages;
    for (const CommandFacts& command : commands) {
        made += ".TP\n" + bold(command.name) + "\n" + roff(command.help) + "\n";
        pages += (pages.empty() ? "" : ",\n") + bold(pageName(command.name)) + "(1)";
    }
    made += list("OPTIONS", programOptions(), false) + ".SH EXAMPLES\n.nf\n";
    for (const char* line : exampleLines()) made += roff(line) + "\n";
    return made + ".fi\n" + exitStatus() + ".SH SEE ALSO\n" + pages + "\n";
}

}  // namespace

std::vector<Page> manPages(const std::vector<CommandFacts>& commands) {
    std::vector<Page> pages = {{"man/man1/glint.1", programPage(commands)}};
    for (const CommandFacts& command : commands)
        pages.push_back({"man/man1/" + pageName(command.name) + ".1", commandPage(command)});
    return pages;
}

}  // namespace glint::app
