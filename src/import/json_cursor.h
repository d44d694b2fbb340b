// A place in a JSON tree with its JSON pointer (RFC 6901): typed reading, errors with the place.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/enum_names.h"
#include "import/json_document.h"

namespace glint {

// The keys of one kind of JSON object.
struct KeyTable {
    std::string_view what;                   // the path of the object in the schema, e.g. "object/sphere"
    std::array<std::string_view, 13> names;  // then empty

    constexpr std::span<const std::string_view> keys() const {
        return std::span(names).first(
            static_cast<size_t>(std::ranges::find(names, std::string_view()) - names.begin()));
    }
};

// Children hold pointers to their parents: a cursor must not outlive its parent. Every reading function
// throws Error(Scene) "FILE: POINTER: what is wanted (got what)".
class JsonCursor {
  public:
    JsonCursor(const JsonValue& root, const std::string& file) : value_(&root), file_(&file) {}

    const JsonValue& value() const { return *value_; }
    std::string pointer() const;
    [[noreturn]] void fail(const std::string& what) const;
    [[noreturn]] void failWanted(const std::string& wanted) const;  // adds "(got ...)"

    void expectObject() const;
    void expectKeys(const KeyTable& table) const;  // an object without other keys
    size_t size() const;                           // of an array; fails for anything else
    JsonCursor item(size_t index) const;
    size_t memberCount() const;
    std::string_view memberName(size_t index) const;
    JsonCursor member(size_t index) const;
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

  private:
    JsonCursor(const JsonCursor& parent, const JsonValue& value, std::string_view key, size_t index)
        : parent_(&parent), value_(&value), key_(key), index_(index), file_(parent.file_) {}

    const JsonCursor* parent_ = nullptr;
    const JsonValue* value_;
    std::string_view key_;
    size_t index_ = 0;
    const std::string* file_;
};

// The value of an enumeration by its name; fails with the names that there are.
template <NamedEnum E>
E readNamed(const JsonCursor& value) {
    const std::optional<E> found = named<E>(value.string());
    if (!found) value.failWanted("must be " + quotedChoices<E>());
    return *found;
}

}  // namespace glint
