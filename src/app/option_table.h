// The options of one command, each declared once: names, form of the value, help text, and the function that
// reads the value. An error that reading throws gets the option's name in front.
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

class OptionTable {
  public:
    enum class Need { Optional, Required };

    // Reads the option's text, which may be empty; throws Error(Argument) for an invalid one.
    using Read = std::function<void(const std::string& text)>;

    // Declares options of `command`, which must outlive the parsing, as must all targets below.
    explicit OptionTable(CLI::App& command) : command_(command) {}

    // An option, `names` being such as "--size" or "-o,--output"; or, with a name in capitals and no form, an
    // argument known by its place.
    void value(const std::string& names, const std::string& form, const std::string& help, const Read& read,
               Need need = Need::Optional);

    // A text that is not empty: the name of a file (form FILE), a folder (FOLDER), a camera or a device.
    template <typename Target>
    void name(const std::string& names, const std::string& form, const std::string& help, Target& target,
              Need need = Need::Optional) {
        value(
            names, form, help, [&target](const std::string& text) { target = parseName(text); }, need);
    }

    // One or more files known by their place.
    void files(const std::string& name, const std::string& help, std::vector<std::filesystem::path>& target);

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
    void choice(const std::string& names, const std::string& help, Target& target) {
        value(names, alternatives<E>(), help,
              [&target](const std::string& text) { target = parseNamed<E>(text); });
    }

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
};

}  // namespace glint::app
