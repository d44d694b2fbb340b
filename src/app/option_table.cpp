#include "app/option_table.h"

#include <CLI/CLI.hpp>

#include "core/error.h"

namespace glint::app {

namespace {

using Text = std::string;

// "--output" of "-o,--output".
Text longName(const Text& names) {
    return names.substr(names.rfind(',') + 1);
}

}  // namespace

void OptionTable::value(const Text& names, const Text& form, const Text& help, Read read, Need need) {
    const auto use = [name = longName(names), read = std::move(read)](const Text& text) {
        try {
            read(text);
        } catch (const Error& e) {
            throw Error(e.kind(), name + ": " + e.what());
        }
    };
    command_.add_option_function<Text>(names, use, help)->type_name(form)->required(need == Need::Required);
}

void OptionTable::arguments(const Text& name, const Text& help, std::vector<std::filesystem::path>& target) {
    const auto use = [&target](const std::vector<Text>& list) { target.assign(list.begin(), list.end()); };
    command_.add_option_function<std::vector<Text>>(name, use, help)->type_name("")->required();
}

void OptionTable::flag(const Text& names, const Text& help, bool& target) {
    command_.add_flag(names, target, help)->disable_flag_override();
}

}  // namespace glint::app
