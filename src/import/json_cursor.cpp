#include "import/json_cursor.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/near_names.h"
#include "core/text_file.h"

namespace glint {

namespace {

// Keys as other programs have them, and what to write here. `what` is the beginning of a table's name.
struct Synonym {
    std::string_view what, key, advice;
};
constexpr Synonym kSynonyms[] = {
    {"material", "color", "the colour of a material is \"diffuse\""},
    {"material", "colour", "the colour of a material is \"diffuse\""},
    {"material", "opacity", "give \"transmission\", which is 1 - opacity"},
    {"material", "emission", "surfaces do not glow; \"ambient\" is what they show without a light"},
    {"material", "reflectivity", "give \"mirror\""},
    {"object/mesh", "file",
     "name the file in \"meshes\": {\"NAME\": {\"file\": ...}}, and give \"mesh\": \"NAME\""},
    {"object/", "color", "give a \"material\" with \"diffuse\""},
    {"object/", "colour", "give a \"material\" with \"diffuse\""},
    {"object/plane", "position", "give \"point\""},
    {"object/", "position", "give \"center\", or \"transform\""},
    {"light/", "color", "give \"intensity\", a number or [r, g, b]"},
    {"camera/", "position", "give \"eye\""},
    {"camera/", "lookAt", "give \"target\""},
    {"camera/", "fov", "give \"fovY\", in degrees"},
    {"camera/orthographic", "fovY",
     "an orthographic camera has no field of view; give \"height\" or \"window\""},
    {"camera/perspective", "height", "only an orthographic camera has a height; give \"fovY\" or \"window\""},
    {"camera/orthographic", "lensRadius", "only a perspective camera has a lens"},
    {"camera/orthographic", "focusDistance", "only a perspective camera has a lens"}};

}  // namespace

std::string JsonCursor::pointer() const {
    if (!parent_) return {};
    return parent_->pointer() + "/" +
           (parent_->value_->array() ? std::to_string(index_) : escapePointer(key_));
}

void JsonCursor::fail(const std::string& what) const {
    const std::string where = pointer();
    throw Error(ErrorKind::Scene, printable(*file_ + ": " + (where.empty() ? "" : where + ": ") + what));
}

void JsonCursor::failWanted(const std::string& wanted) const {
    fail(wanted + " (got " + describe(*value_) + ")");
}

void JsonCursor::expectObject() const {
    if (!value_->object()) failWanted("must be an object {...}");
}

void JsonCursor::expectKeys(const KeyTable& table) const {
    expectObject();
    for (size_t i = 0; i < memberCount(); i++) {
        const std::string_view key = memberName(i);
        if (std::ranges::find(table.keys(), key) != table.keys().end()) continue;
        for (const Synonym& known : kSynonyms)
            if (key == known.key && table.what.starts_with(known.what))
                member(i).fail("unknown key (" + std::string(known.advice) + ")");
        const std::string hint = suggestion(key, table.keys(), "known");
        member(i).fail("unknown key" + (hint.empty() ? "" : " (" + hint + ")"));
    }
}

size_t JsonCursor::size() const {
    if (!value_->array()) failWanted("must be an array [...]");
    return value_->array()->size();
}

JsonCursor JsonCursor::item(size_t index) const {
    return {*this, (*value_->array())[index], {}, index};
}

size_t JsonCursor::memberCount() const {
    return value_->object()->keys.size();
}

std::string_view JsonCursor::memberName(size_t index) const {
    return value_->object()->keys[index];
}

JsonCursor JsonCursor::member(size_t index) const {
    const JsonObject& object = *value_->object();
    return {*this, object.values[index], object.keys[index], index};
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
    const auto& keys = value_->object()->keys;
    const auto at = std::find(keys.begin(), keys.end(), key);
    if (at == keys.end()) return std::nullopt;
    return member(static_cast<size_t>(at - keys.begin()));
}

JsonCursor JsonCursor::require(std::string_view key) const {
    const auto found = find(key);
    if (!found) fail("missing key \"" + std::string(key) + "\"");
    return *found;
}

bool JsonCursor::boolean() const {
    const bool* value = std::get_if<bool>(&value_->data);
    if (!value) failWanted("must be true or false");
    return *value;
}

double JsonCursor::number() const {
    if (!value_->number()) failWanted("must be a number");
    return *value_->number();
}

int JsonCursor::integer(int least, int greatest) const {
    const double* number = value_->number();
    if (!number || !(*number >= least && *number <= greatest) || std::floor(*number) != *number)
        failWanted("must be a whole number from " + std::to_string(least) + " to " +
                   std::to_string(greatest));
    return static_cast<int>(*number);
}

const std::string& JsonCursor::string() const {
    if (!value_->string()) failWanted("must be a string");
    return *value_->string();
}

void JsonCursor::expectItems(size_t count, const std::string& wanted) const {
    if (!value_->array() || value_->array()->size() != count) failWanted("must be " + wanted);
}

std::vector<double> JsonCursor::numbers(size_t count, const std::string& wanted) const {
    expectItems(count, wanted);
    std::vector<double> values;
    for (size_t i = 0; i < count; i++) values.push_back(item(i).number());
    return values;
}

glm::dvec3 JsonCursor::vector3() const {
    const std::vector<double> v = numbers(3, "three numbers [x, y, z]");
    return {v[0], v[1], v[2]};
}

glm::dvec3 JsonCursor::color() const {
    if (value_->number()) return glm::dvec3(*value_->number());
    const std::vector<double> c = numbers(3, "a number or [r, g, b]");
    return {c[0], c[1], c[2]};
}

}  // namespace glint
