// JSON text as a tree that keeps the order of keys. Syntax by nlohmann's parser, with // and /* */ comments.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

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
    uint32_t begin = 0, end = 0;    // bytes of an object or array, behind a byte order mark

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

}  // namespace glint
