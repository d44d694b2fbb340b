// JSON text as a tree that keeps the order of keys, and places in it with typed reading. Syntax by nlohmann's
// parser, with // and /* */ comments.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/enum_names.h"
#include "core/text_file.h"

namespace glint {

struct JsonValue;
using JsonArray = std::vector<JsonValue>;
struct JsonObject {
    std::vector<std::string> keys;  // in file order, all different; keys[i] names values[i]
    std::vector<JsonValue> values;
};

struct JsonValue {
    std::variant<std::monostate, bool, double, std::string, JsonArray, JsonObject> data;
    uint32_t line = 0, column = 0;  // of its first character, from 1; 0 for values from no file
    uint32_t begin = 0;             // its first byte, counted behind a byte order mark

    const bool* boolean() const { return std::get_if<bool>(&data); }
    const double* number() const { return std::get_if<double>(&data); }
    const std::string* string() const { return std::get_if<std::string>(&data); }
    const JsonArray* array() const { return std::get_if<JsonArray>(&data); }
    const JsonObject* object() const { return std::get_if<JsonObject>(&data); }
    // The member of that name, or the item of that number in decimal digits; null if it is missing.
    const JsonValue* child(const std::string& step) const;
};

// Throws Error(Scene) "FILE:LINE:COLUMN: ..." for anything that is not JSON, for a key that stands twice in
// one object, and for text nested or sized beyond limits.h. `file` stands for the file in messages; columns
// count characters.
JsonValue parseJson(std::string_view text, const std::string& file, const Context& context = {});

// The steps of a JSON pointer (RFC 6901), unescaped: "/a~1b/0" has the steps "a/b" and "0".
std::vector<std::string> stepsOf(std::string_view pointer);

// A value for messages: short values as JSON on one line, long values by their kind.
std::string describe(const JsonValue& value);

// A place in the tree with its JSON pointer (RFC 6901), for as long as the tree and the file's name live.
// Every reading function throws Error(Scene) "FILE: POINTER: what is wanted (got what)".
class JsonCursor {
  public:
    JsonCursor(const JsonValue& root, const std::string& file) : value_(&root), file_(&file) {}

    const JsonValue& value() const { return *value_; }
    const std::string& pointer() const { return pointer_; }
    template <typename... Parts>
    [[noreturn]] void fail(const Parts&... what) const {
        failFile(pointer_.empty() ? *file_ : *file_ + ": " + pointer_, what...);
    }
    template <typename... Parts>
    [[noreturn]] void failWanted(const Parts&... wanted) const {
        fail(wanted..., " (got ", describe(*value_), ")");
    }

    // Calls `read`, and fails here with the message of an Error that it throws.
    template <typename Read>
    auto here(const Read& read) const {
        try {
            return read();
        } catch (const Error& error) {
            fail(error.what());
        }
    }

    size_t size() const;  // of an array; fails for anything else
    JsonCursor item(size_t index) const;
    const JsonObject& object() const;  // fails for anything else, as all of the following do
    std::vector<std::pair<std::string_view, JsonCursor>> members() const;
    std::optional<JsonCursor> find(std::string_view key) const;
    JsonCursor require(std::string_view key) const;

    bool boolean() const;
    double number() const;
    int integer(int least, int greatest) const;
    const std::string& string() const;
    // An array of `count` numbers; else fails with "must be `wanted` (got ...)".
    std::vector<double> numbers(size_t count, const std::string& wanted) const;
    void expectItems(size_t count, const std::string& wanted) const;  // the same for values of any kind
    glm::dvec3 vector3() const;
    glm::dvec3 color() const;  // a number means grey

    // Members of an object that may be missing.
    template <typename T, typename Read>
    T valueOr(std::string_view key, const T& missing, const Read& read) const {
        const std::optional<JsonCursor> found = find(key);
        return found ? T(read(*found)) : missing;
    }
    double number(std::string_view key, double missing) const {
        return valueOr(key, missing, [](const JsonCursor& c) { return c.number(); });
    }
    int integer(std::string_view key, int least, int greatest, int missing) const {
        return valueOr(key, missing, [&](const JsonCursor& c) { return c.integer(least, greatest); });
    }
    glm::dvec3 vector3(std::string_view key, const glm::dvec3& missing) const {
        return valueOr(key, missing, [](const JsonCursor& c) { return c.vector3(); });
    }
    glm::dvec3 color(std::string_view key, const glm::dvec3& missing) const {
        return valueOr(key, missing, [](const JsonCursor& c) { return c.color(); });
    }
    bool flag(std::string_view key) const {
        return valueOr(key, false, [](const JsonCursor& c) { return c.boolean(); });
    }
    std::string text(std::string_view key) const {
        return valueOr(key, std::string(), [](const JsonCursor& c) { return c.string(); });
    }
    std::vector<double> numbers(std::string_view key, size_t count) const;  // or nothing

  private:
    JsonCursor member(size_t index) const;
    JsonCursor(const JsonCursor& parent, const JsonValue& value, const std::string& step)
        : value_(&value), file_(parent.file_), pointer_(parent.pointer_ + '/' + step) {}

    const JsonValue* value_;
    const std::string* file_;
    std::string pointer_;
};

// The value of an enumeration by its name; fails with the names that there are.
template <NamedEnum E>
E readNamed(const JsonCursor& value) {
    const std::string* name = value.value().string();
    const std::optional<E> found = name ? named<E>(*name) : std::nullopt;
    if (!found) value.failWanted("must be " + quotedChoices<E>());
    return *found;
}
// The same for a member that may be missing.
template <NamedEnum E>
E readNamed(const JsonCursor& object, std::string_view key, E missing) {
    return object.valueOr(key, missing, [](const JsonCursor& value) { return readNamed<E>(value); });
}

}  // namespace glint
