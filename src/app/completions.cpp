#include "app/pages.h"

namespace glint::app {

namespace {

using Text = std::string;
using Value = OptionFacts::Value;

constexpr const char* kMadeBy = "# Made by glint pages; not to be edited.\n";

std::vector<Text> split(const Text& names) {
    std::vector<Text> parts;
    for (size_t start = 0, end = 0; end != Text::npos; start = end + 1) {
        end = names.find(',', start);
        parts.push_back(names.substr(start, end - start));
    }
    return parts;
}

Text joined(const std::vector<Text>& words, const Text& between = " ") {
    Text made;
    for (const Text& word : words) made += (made.empty() ? "" : between) + word;
    return made;
}

std::vector<Text> commandNames(const std::vector<CommandFacts>& commands) {
    std::vector<Text> names;
    for (const CommandFacts& command : commands) names.push_back(command.name);
    return names;
}

std::vector<Text> optionNames(const std::vector<OptionFacts>& options) {
    std::vector<Text> names;
    for (const OptionFacts& option : options)
        if (!option.positional())
            for (Text& name : split(option.names)) names.push_back(std::move(name));
    return names;
}

// In single quotes, for all three shells; `special` characters get a backslash.
Text quotedFor(const Text& plain, const Text& special, const Text& apostrophe) {
    Text made = "'";
    for (const char c : plain) {
        if (special.find(c) != Text::npos) made += '\\';
        if (c == '\'')
            made += apostrophe;
        else
            made += c;
    }
    return made + "'";
}

// ---- bash ----

// Completion after an option: a line of its `case`.
Text bashCase(const Text& command, const OptionFacts& option) {
    std::vector<Text> patterns;
    for (const Text& name : split(option.names)) patterns.push_back("'" + command + " " + name + "'");
    const Text line = "        " + joined(patterns, " | ") + ") ";
    if (!option.choices.empty()) return line + "words='" + joined(option.choices) + "' ;;\n";
    if (option.value == Value::File) return line + "compopt -o default; return ;;\n";
    if (option.value == Value::Folder) return line + "compopt -o dirnames; return ;;\n";
    return line + "return ;;\n";
}

// ---- zsh ----

Text zshAction(const OptionFacts& option) {
    if (!option.choices.empty()) return "(" + joined(option.choices) + ")";
    if (option.value == Value::File) return "_files";
    return option.value == Value::Folder ? "_files -/" : " ";
}

Text zshQuoted(const Text& plain) {
    return quotedFor(plain, "[]:\\", "'\\''");
}

// One argument of _arguments.
Text zshSpec(const OptionFacts& option) {
    const Text inner = zshQuoted(option.help), help = inner.substr(1, inner.size() - 2);
    if (option.positional()) {
        const Text name = zshQuoted(option.names);
        return "'" + Text(option.many ? "*:" : ":") + name.substr(1, name.size() - 2) + ":" +
               zshAction(option) + "'";
    }
    const std::vector<Text> names = split(option.names);
    const Text value = option.value == Value::None ? "" : ":" + option.form + ":" + zshAction(option);
    const Text rest = "'[" + help + "]" + value + "'";
    return names.size() == 1 ? "'" + names[0] + rest.substr(1)
                             : "'(" + joined(names) + ")'{" + joined(names, ",") + "}" + rest;
}

// ---- fish ----

Text fishQuoted(const Text& plain) {
    return quotedFor(plain, "\\", "\\'");
}

Text fishOption(const Text& condition, const OptionFacts& option) {
    Text made = "complete -c glint -n '" + condition + "'";
    for (const Text& name : split(option.names))
        made += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.choices.empty())
        made += " -x -a '" + joined(option.choices) + "'";
    else if (option.value == Value::File)
        made += " -r -F";
    else if (option.value == Value::Folder)
        made += " -x -a '(__fish_complete_directories)'";
    else if (option.value == Value::Text)
        made += " -x";
    return made + " -d " + fishQuoted(option.help) + "\n";
}

// Placeholder of arguments that are files or folders.
Value positionalValue(const CommandFacts& command) {
    for (const OptionFacts& option : command.options)
        if (option.positional()) return option.value;
    return Value::None;
}

}  // namespace

Text bashCompletion(const std::vector<CommandFacts>& commands) {
    Text values, words;
    for (const CommandFacts& command : commands) {
        for (const OptionFacts& option : command.options)
            if (!option.positional() && option.value != Value::None) values += bashCase(command.name, option);
        const Value files = positionalValue(command);
        words += "        " + command.name + ")\n            options='" +
                 joined(optionNames(command.options)) + "'\n" +
                 (files == Value::None
                      ? ""
                      : Text("            files=") + (files == Value::File ? "default" : "dirnames") + "\n") +
                 "            ;;\n";
    }
    const Text first = joined(commandNames(commands)) + " help " + joined(optionNames(programOptions()));
    return kMadeBy +
           Text(
               "_glint() {\n"
               "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} "
               "command=${COMP_WORDS[1]}\n"
               "    local words='' options='' files=''\n"
               "    COMPREPLY=()\n"
               "    if [[ $COMP_CWORD -eq 1 ]]; then\n"
               "        mapfile -t COMPREPLY < <(compgen -W '") +
           first +
           "' -- \"$current\")\n        return\n    fi\n"
           "    case \"$command $previous\" in\n" +
           values +
           "    esac\n"
           "    case $command in\n" +
           words + "        help) words='" + joined(commandNames(commands)) +
           "' ;;\n"
           "    esac\n"
           "    if [[ -z $words && $current == -* ]]; then words=$options; fi\n"
           "    if [[ -n $words ]]; then\n"
           "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
           "    elif [[ -n $files ]]; then\n"
           "        compopt -o \"$files\"\n"
           "    fi\n"
           "}\n"
           "complete -F _glint glint\n";
}

Text zshCompletion(const std::vector<CommandFacts>& commands) {
    Text names, cases;
    for (const CommandFacts& command : commands) {
        names += "        " +
                 zshQuoted(command.name + ":" + command.help).replace(1 + command.name.size(), 2, ":") + "\n";
        cases += "            " + command.name + ")\n                _arguments -s";
        for (const OptionFacts& option : command.options)
            cases += " \\\n                    " + zshSpec(option);
        cases += "\n                ;;\n";
    }
    Text flags;
    for (const OptionFacts& option : programOptions()) flags += " \\\n        " + zshSpec(option);
    return "#compdef glint\n" + Text(kMadeBy) +
           "_glint() {\n"
           "    local curcontext=$curcontext state line\n"
           "    local -a commands\n"
           "    commands=(\n" +
           names + "    )\n    _arguments -C" + flags +
           " \\\n        '1:command:->command' '*::argument:->argument'\n"
           "    case $state in\n"
           "        command) _describe -t commands command commands ;;\n"
           "        argument)\n"
           "            case $words[1] in\n" +
           cases +
           "            esac\n"
           "            ;;\n"
           "    esac\n"
           "}\n"
           "_glint \"$@\"\n";
}

Text fishCompletion(const std::vector<CommandFacts>& commands) {
    Text made = kMadeBy + Text("complete -c glint -f\n");
    for (const OptionFacts& option : programOptions()) made += fishOption("__fish_use_subcommand", option);
    for (const CommandFacts& command : commands) {
        made += "complete -c glint -n __fish_use_subcommand -a " + command.name + " -d " +
                fishQuoted(command.help) + "\n";
        const Text condition = "__fish_seen_subcommand_from " + command.name;
        const Value files = positionalValue(command);
        if (files == Value::File) made += "complete -c glint -n '" + condition + "' -F\n";
        if (files == Value::Folder)
            made += "complete -c glint -n '" + condition + "' -x -a '(__fish_complete_directories)'\n";
        for (const OptionFacts& option : command.options)
            if (!option.positional()) made += fishOption(condition, option);
    }
    return made;
}

}  // namespace glint::app
