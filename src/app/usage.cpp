#include "app/usage.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <string_view>

#include "app/option_values.h"
#include "core/near_names.h"
#include "core/wording.h"

namespace glint::app {

namespace {

std::string withoutDashes(const std::string& name) {
    return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

std::vector<std::string> optionNames(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option :
         command.get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
        names.push_back(option->get_name());
    }
    return names;
}

// `unknown option "--siez" (did you mean "--size"?)`, or `unexpected argument "x"` for what is no option.
std::string unexpected(const CLI::App& command, const std::string& argument) {
    const std::string name = argument.substr(0, argument.find('='));
    std::vector<std::string> known = optionNames(command);
    const bool option =
        name.size() > 1 && name[0] == '-' && std::find(known.begin(), known.end(), name) == known.end();
    if (!option) return "unexpected argument " + quoted(argument);
    // Without the dashes, which any two options have in common.
    std::transform(known.begin(), known.end(), known.begin(), withoutDashes);
    const std::vector<std::string_view> views(known.begin(), known.end());
    std::string hint = suggestion(withoutDashes(name), views, "");
    constexpr std::string_view kDidYouMean = "did you mean \"";
    hint = hint.starts_with(kDidYouMean) ? " (" + hint.insert(kDidYouMean.size(), "--") + ")" : "";
    return "unknown option " + quoted(name) + hint;
}

// For CLI11's "--size: 1 required WxH missing", "--size: At Most 1 required but received 2" and the like.
std::string mismatch(const CLI::App& command, const std::string& text) {
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        if (text.starts_with(withoutDashes(name) + " was given")) return name + " takes no value";
        if (text.find(name) == std::string::npos) continue;
        if (text.find("missing") != std::string::npos)
            return name + " needs a value: " + option->get_type_name();
        return name + " is given more than once";
    }
    return text;
}

}  // namespace

std::string firstWordError(const CLI::App& app, const std::vector<std::string>& args) {
    if (args.empty()) return "";
    const std::string& word = args.front();
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (command->get_name() == word) return "";
        if (!command->get_group().empty()) names.push_back(command->get_name());
    }
    if (word == "-h" || word == "--help" || word == "--version" || word == "--verbose") return "";
    const std::string see = "; see glint --help";
    if (word.starts_with("-"))
        return "the command comes first, then its options (got " + quoted(word) + ")" + see;
    std::error_code ignored;
    if (std::filesystem::exists(word, ignored))
        return quoted(word) + " is no command; did you mean: glint render " + word;
    const std::vector<std::string_view> views(names.begin(), names.end());
    return "unknown command " + quoted(word) + " (" + suggestion(word, views, "there are") + ")" + see;
}

std::string parseErrorLine(const CLI::App& app, const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    const std::string text = error.what();
    if (chosen.empty()) return text + "; see glint --help";
    const CLI::App& command = *chosen.front();
    const std::string start = command.get_name() + ": ",
                      see = "; see glint " + command.get_name() + " --help";
    const std::vector<std::string> extras = app.remaining(true);
    // A mistyped option is the likelier reason for whatever else is missing.
    const auto option =
        std::find_if(extras.begin(), extras.end(), [](const std::string& s) { return s.starts_with("-"); });
    if (option != extras.end()) return start + unexpected(command, *option) + see;
    switch (static_cast<CLI::ExitCodes>(error.get_exit_code())) {
        case CLI::ExitCodes::ExtrasError:
            if (extras.empty()) break;
            return start + unexpected(command, extras.front()) + see;
        case CLI::ExitCodes::RequiredError:
            return start + text.substr(0, text.find(' ')) + " is missing" + see;
        case CLI::ExitCodes::ArgumentMismatch:
            return start + mismatch(command, text) + see;
        default:
            break;
    }
    return start + text + see;
}

}  // namespace glint::app
