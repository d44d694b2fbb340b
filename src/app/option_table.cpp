#include "app/option_table.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "core/error.h"

namespace glint::app {

namespace {

using Text = std::string;

// "--output" of "-o,--output".
Text longName(const Text& names) {
    return names.substr(names.rfind(',') + 1);
}

// The names in "auto|bar|none"; nothing for other forms, such as "NAME|INDEX" and "x,y".
std::vector<Text> namesIn(const Text& form) {
    std::vector<Text> names;
    for (size_t start = 0, end = 0; end != Text::npos; start = end + 1) {
        end = form.find('|', start);
        names.push_back(form.substr(start, end - start));
        const Text& name = names.back();
        if (name.empty() || !std::islower(static_cast<unsigned char>(name.front())) ||
            !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c); }))
            return {};
    }
    return names;
}

// All arguments that are known by their place are names of files.
void checkNamed(const Text& name, const Text& text) {
    if (text.empty()) throw Error(ErrorKind::Argument, name + " is empty; give a file name");
}

}  // namespace

void OptionTable::value(const Text& names, const Text& form, const Text& help, Read read, Need need) {
    OptionFacts facts{.names = names,
                      .form = form,
                      .help = help,
                      .choices = namesIn(form),
                      .value = OptionFacts::Value::Text};
    facts.required = need == Need::Required;
    if (facts.positional()) facts.value = OptionFacts::Value::File;
    value(std::move(facts), std::move(read));
}

void OptionTable::value(OptionFacts facts, Read read) {
    const auto use = [name = longName(facts.names),
                      file = facts.positional() && facts.value == OptionFacts::Value::File,
                      read = std::move(read)](const Text& text) {
        if (file) checkNamed(name, text);
        try {
            read(text);
        } catch (const Error& e) {
            throw Error(e.kind(), name + ": " + e.what());
        }
    };
    command_.add_option_function<Text>(facts.names, use, facts.help)
        ->type_name(facts.form)
        ->required(facts.required);
    options_.push_back(std::move(facts));
}

void OptionTable::arguments(const Text& name, const Text& help, std::vector<std::filesystem::path>& target) {
    const auto use = [name, &target](const std::vector<Text>& list) {
        for (const Text& text : list) checkNamed(name, text);
        target.assign(list.begin(), list.end());
    };
    command_.add_option_function<std::vector<Text>>(name, use, help)->type_name("")->required();
    options_.push_back(
        {.names = name, .help = help, .value = OptionFacts::Value::File, .required = true, .many = true});
}

void OptionTable::flag(const Text& names, const Text& help, bool& target) {
    command_.add_flag(names, target, help)->disable_flag_override();
    options_.push_back({.names = names, .help = help});
}

}  // namespace glint::app
