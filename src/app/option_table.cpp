#include "app/option_table.h"

#include <CLI/CLI.hpp>

#include "core/error.h"

namespace glint::app {

namespace {

// "--output" of "-o,--output".
std::string longName(const std::string& names) {
    return names.substr(names.rfind(',') + 1);
}

}  // namespace

void OptionTable::value(const std::string& names, const std::string& form, const std::string& help,
                        const Read& read, Need need) {
    const auto use = [name = longName(names), read](const std::string& text) {
        try {
            read(text);
        } catch (const Error& e) {
            throw Error(e.kind(), name + ": " + e.what());
        }
    };
    command_.add_option_function<std::string>(names, use, help)
        ->type_name(form)
        ->required(need == Need::Required);
}

void OptionTable::files(const std::string& name, const std::string& help,
                        std::vector<std::filesystem::path>& target) {
    const auto use = [name, &target](const std::vector<std::string>& list) {
        for (const std::string& text : list)
            if (text.empty()) throw Error(ErrorKind::Argument, name + ": the name is empty");
        target.assign(list.begin(), list.end());
    };
    command_.add_option_function<std::vector<std::string>>(name, use, help)->type_name("")->required();
}

void OptionTable::flag(const std::string& names, const std::string& help, bool& target) {
    command_.add_flag(names, target, help)->disable_flag_override();
}

}  // namespace glint::app
