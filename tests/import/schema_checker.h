// A checker for the part of JSON Schema 2020-12 that scenes/scene.schema.json uses.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace glint::test {

// The first violation, as "POINTER: what", or empty. Throws std::logic_error for a keyword it does not know,
// so that the schema cannot come to rely on one that is not checked.
std::string schemaViolation(const nlohmann::json& schema, const nlohmann::json& instance);

nlohmann::json loadSceneSchema();

}  // namespace glint::test
