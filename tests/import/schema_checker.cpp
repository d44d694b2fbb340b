#include "schema_checker.h"

#include "support/support.h"

#include <cmath>
#include <fstream>
#include <stdexcept>

namespace glint::test {

namespace {

using nlohmann::json;

class Checker {
  public:
    explicit Checker(const json& root) : root_(root) {}

    std::string check(const json& schema, const json& value, const std::string& where) const {
        for (const auto& [keyword, argument] : schema.items()) {
            const std::string violation = checkKeyword(keyword, argument, schema, value, where);
            if (!violation.empty()) return violation;
        }
        return {};
    }

  private:
    std::string checkKeyword(const std::string& keyword, const json& argument, const json& schema,
                             const json& value, const std::string& where) const {
        const auto wrong = [&](bool bad) {
            return bad ? where + ": " + keyword + " " + argument.dump() : std::string();
        };
        if (keyword == "$schema" || keyword == "title" || keyword == "description" || keyword == "default" ||
            keyword == "$defs")
            return {};
        if (keyword == "$ref")
            return check(root_.at(json::json_pointer(argument.get<std::string>().substr(1))), value, where);
        if (keyword == "type") return wrong(!hasType(value, argument));
        if (keyword == "const") return wrong(value != argument);
        if (keyword == "enum")
            return wrong(std::find(argument.begin(), argument.end(), value) == argument.end());
        if (keyword == "minimum") return wrong(value.is_number() && value < argument);
        if (keyword == "maximum") return wrong(value.is_number() && value > argument);
        if (keyword == "exclusiveMinimum") return wrong(value.is_number() && value <= argument);
        if (keyword == "exclusiveMaximum") return wrong(value.is_number() && value >= argument);
        if (keyword == "minItems") return wrong(value.is_array() && value.size() < argument);
        if (keyword == "maxItems") return wrong(value.is_array() && value.size() > argument);
        if (keyword == "minProperties") return wrong(value.is_object() && value.size() < argument);
        if (keyword == "maxProperties") return wrong(value.is_object() && value.size() > argument);
        if (keyword == "minLength")
            return wrong(value.is_string() && value.get<std::string>().size() < argument.get<size_t>());
        if (keyword == "propertyNames") {
            for (size_t i = 0; value.is_object() && i < value.size(); i++) {
                const std::string violation = check(argument, std::next(value.begin(), i).key(), where);
                if (!violation.empty()) return violation;
            }
            return {};
        }
        if (keyword == "items") return checkItems(argument, value, where);
        if (keyword == "properties") return checkProperties(argument, value, where);
        if (keyword == "additionalProperties") return checkAdditional(argument, schema, value, where);
        if (keyword == "required") {
            for (const json& key : argument)
                if (value.is_object() && !value.contains(key)) return where + ": required " + key.dump();
            return {};
        }
        if (keyword == "oneOf") {
            int matching = 0;
            for (const json& option : argument) matching += check(option, value, where).empty();
            return wrong(matching != 1);
        }
        throw std::logic_error("the schema checker does not know " + keyword);
    }

    static bool hasType(const json& value, const std::string& type) {
        if (type == "object") return value.is_object();
        if (type == "array") return value.is_array();
        if (type == "string") return value.is_string();
        if (type == "boolean") return value.is_boolean();
        if (type == "number") return value.is_number();
        if (type == "integer")
            return value.is_number() && std::floor(value.get<double>()) == value.get<double>();
        throw std::logic_error("the schema checker does not know the type " + type);
    }

    std::string checkItems(const json& itemSchema, const json& value, const std::string& where) const {
        for (size_t i = 0; value.is_array() && i < value.size(); i++) {
            const std::string violation = check(itemSchema, value[i], where + "/" + std::to_string(i));
            if (!violation.empty()) return violation;
        }
        return {};
    }

    std::string checkProperties(const json& properties, const json& value, const std::string& where) const {
        for (const auto& [key, propertySchema] : properties.items()) {
            if (!value.is_object() || !value.contains(key)) continue;
            const std::string violation = check(propertySchema, value[key], where + "/" + key);
            if (!violation.empty()) return violation;
        }
        return {};
    }

    std::string checkAdditional(const json& rest, const json& schema, const json& value,
                                const std::string& where) const {
        if (!value.is_object()) return {};
        for (const auto& [key, member] : value.items()) {
            if (schema.contains("properties") && schema["properties"].contains(key)) continue;
            if (rest.is_boolean()) {
                if (!rest.get<bool>()) return where + "/" + key + ": unknown key";
                continue;
            }
            const std::string violation = check(rest, member, where + "/" + key);
            if (!violation.empty()) return violation;
        }
        return {};
    }

    const json& root_;
};

}  // namespace

std::string schemaViolation(const nlohmann::json& schema, const nlohmann::json& instance) {
    return Checker(schema).check(schema, instance, "");
}

nlohmann::json loadSceneSchema() {
    std::ifstream file(glint::test::sourcePath("scenes/scene.schema.json"));
    return nlohmann::json::parse(file);
}

}  // namespace glint::test
