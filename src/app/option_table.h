// The options of one command, each declared once: names, form of the value, help text, and what reads the
// value. An error that reading throws reaches the user with the option's name in front.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/option_values.h"
#include "core/enum_names.h"

namespace CLI {
class App;
}

namespace glint::app {

// Facts about an option for man pages and shell completions.
struct OptionFacts {
    enum class Value { None, Text, File, Folder };

    std::string names;      // "-o,--output"; of an argument known by its place "SCENE"
    std::string form = "";  // of the value
    std::string help = "";
    std::vector<std::string> choices = {};  // if the value is one of few
    Value value = Value::None;
    bool required = false, many = false;

    bool positional() const { return !names.starts_with('-'); }
};

class OptionTable {
  public:
    enum class Need { Optional, Required };

    // Given the option's text, empty or not; throws Error(Argument) for what it cannot be.
    using Read = std::function<void(const std::string& text)>;

    // Declares options of `command`, which must outlive the parsing, as must all that is referred to below.
    explicit OptionTable(CLI::App& command) : command_(command) {}

    // An option, `names` being such as "--size" or "-o,--output"; or, with a name in capitals and no form, an
    // argument known by its place.
    void value(const std::string& names, const std::string& form, const std::string& help, Read read,
               Need need = Need::Optional);
    void value(OptionFacts facts, Read read);

    // One or more arguments known by their place.
    void arguments(const std::string& name, const std::string& help,
                   std::vector<std::filesystem::path>& target);

    // Takes no value.
    void flag(const std::string& names, const std::string& help, bool& target);

    // A whole number from `least` to `greatest`.
    template <typename Target>
    void whole(const std::string& names, const std::string& form, const std::string& help, int least,
               int greatest, Target& target) {
        value(names, form, help, [&target, least, greatest](const std::string& text) {
            target = static_cast<Number<Target>>(parseWhole(text, least, greatest));
        });
    }

    // One of an enumeration's names.
    template <NamedEnum E, typename Target>
    void choice(const std::string& names, const std::string& help, Target& target,
                const std::string& form = alternatives<E>()) {
        value({.names = names,
               .form = form,
               .help = help,
               .choices = {kEnumNames<E>.begin(), kEnumNames<E>.end()},
               .value = OptionFacts::Value::Text},
              [&target](const std::string& text) { target = parseNamed<E>(text); });
    }

    // The path of a file or a folder (a form that ends in FOLDER), `what` in the error for an empty one ("the
    // file name").
    template <typename Target>
    void path(const std::string& names, const std::string& form, const std::string& help,
              const std::string& what, Target& target, Need need = Need::Optional) {
        const bool folder = form.ends_with("FOLDER") || names.ends_with("FOLDER");
        value({.names = names,
               .form = form,
               .help = help,
               .value = folder ? OptionFacts::Value::Folder : OptionFacts::Value::File,
               .required = need == Need::Required},
              [&target, what](const std::string& text) { target = parsePath(what, text); });
    }

    // In the order of declaration.
    const std::vector<OptionFacts>& options() const { return options_; }

  private:
    template <typename T>
    struct Unwrapped {
        using Type = T;
    };
    template <typename T>
    struct Unwrapped<std::optional<T>> {
        using Type = T;
    };
    template <typename T>
    using Number = typename Unwrapped<T>::Type;

    CLI::App& command_;
    std::vector<OptionFacts> options_;
};

}  // namespace glint::app
