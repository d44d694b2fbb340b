// A place in a JSON tree that knows its JSON pointer (RFC 6901): typed reading, errors that say where.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/enum_names.h"
#include "import/json_document.h"

namespace glint {

// The keys of one kind of JSON object. `later` holds those of the format that this version lacks.
struct KeyTable {
    std::string_view what;  // the path of the object in the schema, e.g. "objects/sphere"
    std::span<const std::string_view> keys;
    std::span<const std::string_view> later;
};

// Children hold pointers to their parents: a cursor must not outlive the one it came from. Every reading
// function throws Error(Scene) "FILE: POINTER: what is wanted (got what)".
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
