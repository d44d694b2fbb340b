#include "import/json_document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <nlohmann/json.hpp>
#include <set>
#include <streambuf>

#include "import/text_scanner.h"
#include "scene/limits.h"

namespace glint {

namespace {

// Shows how far the parser has read: nlohmann gives positions of syntax errors, but not of keys.
class Tape : public std::streambuf {
  public:
    explicit Tape(std::string_view text) {
        char* const start = const_cast<char*>(text.data());  // only read
        setg(start, start, start + text.size());
    }
    size_t taken() const { return static_cast<size_t>(gptr() - eback()); }
};

class TreeBuilder {
  public:
    TreeBuilder(std::string_view text, const std::string& file, const Context& context)
        : text_(text), file_(file), tape_(text), pace_(context, text.data(), text.data() + text.size()) {}

    JsonValue parse() {
        std::istream stream(&tape_);
        nlohmann::json::sax_parse(stream, this, nlohmann::json::input_format_t::json, true, true);
        return std::move(root_);
    }

    // The interface that nlohmann::json::sax_parse calls.
    bool null() { return add({}); }
    bool boolean(bool value) { return add({value}); }
    bool number_integer(int64_t value) { return add({static_cast<double>(value)}); }
    bool number_unsigned(uint64_t value) { return add({static_cast<double>(value)}); }
    bool number_float(double value, const std::string&) { return add({value}); }
    bool string(std::string& value) { return add({std::move(value)}); }
    bool binary(nlohmann::json::binary_t&) { return false; }
    bool start_object(size_t) { return open({JsonObject{}}); }
    bool start_array(size_t) { return open({JsonArray{}}); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }

    bool key(std::string& name) {
        if (!open_.back().seen.insert(name).second)
            failAt(tape_.taken(), "the key \"", name, "\" stands here twice");
        std::get<JsonObject>(open_.back().value->data).keys.push_back(std::move(name));
        token_ = tape_.taken();
        return true;
    }

    // The position is that of the last character read. The parser's words stand behind its own position.
    bool parse_error(size_t position, const std::string&, const nlohmann::json::exception& error) {
        const size_t at = std::min(position == 0 ? 0 : position - 1, text_.size());
        const std::string_view before = text_.substr(0, at);
        const size_t last = before.find_last_not_of(" \t\r\n");
        if (at < text_.size() && (text_[at] == '}' || text_[at] == ']') && last != before.npos &&
            text_[last] == ',')
            failAt(last, "a comma must not stand before '", text_[at], "'");
        const std::string_view what = error.what();
        const size_t place = what.find(": "), kind = what.find("] ");
        std::string text(what.substr((place != what.npos ? place : kind) + 2));
        // nlohmann's parser names the end of the file, and shows all that it read since the comment began.
        if (text.find("missing closing '*/'") != text.npos)
            failAt(std::min(at, text_.find("/*", token_ - std::min<size_t>(token_, 1))),
                   "the comment is not closed by */");
        // After a value, a comma would also do; nlohmann's parser names only the bracket.
        for (const std::string_view end : {"expected '}'", "expected ']'"})
            if (text.ends_with(end)) text.insert(text.size() - 3, "',' or ");
        failAt(at, text);
    }

  private:
    struct Open {
        JsonValue* value;
        std::set<std::string> seen;  // no hashes: a hostile file may make all of them equal
    };

    template <typename... Parts>
    [[noreturn]] void failAt(size_t offset, const Parts&... what) {
        countTo(offset);
        failFile(concat(file_, ':', line_, ':', column_), what...);
    }

    void countTo(size_t offset) {
        for (; counted_ < offset; counted_++) {
            if (text_[counted_] == '\n') line_++;
            column_ = text_[counted_] == '\n' ? 1 : column_ + ((text_[counted_] & 0xc0) != 0x80);
        }
    }

    // Marks the start of the value that was just read, after the preceding blanks, commas and comments.
    void mark(JsonValue& value) {
        for (;;) {
            token_ = std::min(text_.find_first_not_of(" \t\r\n:,]}", token_), text_.size());
            const std::string_view two = text_.substr(token_, 2);
            if (two == "//")
                token_ = std::min(text_.find('\n', token_), text_.size());
            else if (two == "/*")
                token_ = std::min(text_.find("*/", token_ + 2), text_.size() - 2) + 2;
            else
                break;
        }
        countTo(token_);
        value.line = line_;
        value.column = column_;
        value.begin = static_cast<uint32_t>(token_);
        pace_.reached(text_.data() + token_);
        token_ = tape_.taken();
    }

    JsonValue* place(JsonValue value) {
        mark(value);
        if (++count_ > kMaxJsonValues)
            failAt(tape_.taken(), "more than ", kMaxJsonValues,
                   " values: put large geometry into a mesh file");
        if (open_.empty()) {
            root_ = std::move(value);
            return &root_;
        }
        // Only the innermost open container grows, so pointers to those around it stay valid.
        JsonValue& parent = *open_.back().value;
        auto* array = std::get_if<JsonArray>(&parent.data);
        auto& siblings = array ? *array : std::get<JsonObject>(parent.data).values;
        siblings.push_back(std::move(value));
        return &siblings.back();
    }
    bool add(JsonValue value) {
        place(std::move(value));
        return true;
    }
    bool open(JsonValue value) {
        if (open_.size() >= kMaxJsonDepth)
            failAt(tape_.taken() - 1, "nested deeper than ", kMaxJsonDepth, " levels");
        open_.push_back({place(std::move(value)), {}});
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    std::string_view text_;
    const std::string& file_;
    Tape tape_;
    ReadingPace pace_;
    JsonValue root_;
    std::vector<Open> open_;
    size_t count_ = 0;
    size_t token_ = 0, counted_ = 0;  // ends of the last token, and of what line_ and column_ stand for
    uint32_t line_ = 1, column_ = 1;
};

void describeInto(const JsonValue& value, std::string& out) {
    if (const JsonArray* const items = value.array()) {
        out += '[';
        for (size_t i = 0; i < items->size() && out.size() < 80; i++) {
            if (i > 0) out += ", ";
            describeInto((*items)[i], out);
        }
        out += ']';
    } else if (value.string()) {
        out += '"' + *value.string() + '"';
    } else if (value.number()) {
        out += describe(*value.number());
    } else if (value.boolean()) {
        out += *value.boolean() ? "true" : "false";
    } else {
        out += value.object() ? "an object" : "null";
    }
}

}  // namespace

const JsonValue* JsonValue::child(const std::string& step) const {
    if (const JsonObject* members = object()) {
        const auto found = std::ranges::find(members->keys, step);
        return found == members->keys.end() ? nullptr : &members->values[found - members->keys.begin()];
    }
    size_t index = 0;
    const auto [stop, error] = std::from_chars(step.data(), step.data() + step.size(), index);
    // RFC 6901 has no "01".
    const bool isIndex = error == std::errc() && std::to_string(index) == step;
    return isIndex && array() && index < array()->size() ? &(*array())[index] : nullptr;
}

std::vector<std::string> stepsOf(std::string_view pointer) {
    std::vector<std::string> steps;
    for (size_t i = 0; i < pointer.size(); ++i) {
        const std::string_view two = pointer.substr(i, 2);
        if (pointer[i] == '/' || steps.empty())
            steps.emplace_back();
        else if (two == "~0" || two == "~1")
            steps.back() += pointer[++i] == '0' ? '~' : '/';
        else
            steps.back() += pointer[i];
    }
    return steps;
}

JsonValue parseJson(std::string_view text, const std::string& file, const Context& context) {
    text = withoutByteOrderMark(text, file);
    if (text.size() > kMaxJsonBytes)
        failFile(file, "larger than ", kMaxJsonBytes >> 20, " MiB: put large geometry into a mesh file");
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) failFile(file, "the file is empty");
    return TreeBuilder(text, file, context).parse();
}

std::string describe(const JsonValue& value) {
    constexpr size_t kLongest = 60;
    std::string text;
    describeInto(value, text);
    if (text.size() <= kLongest) return text;
    if (const JsonArray* array = value.array()) return "an array of " + std::to_string(array->size());
    if (value.string()) return "a string of " + std::to_string(value.string()->size()) + " bytes";
    return text.substr(0, kLongest);
}

size_t JsonCursor::size() const {
    if (!value_->array()) failWanted("must be an array [...]");
    return value_->array()->size();
}

JsonCursor JsonCursor::item(size_t index) const {
    return {*this, (*value_->array())[index], std::to_string(index)};
}

const JsonObject& JsonCursor::object() const {
    if (!value_->object()) failWanted("must be an object {...}");
    return *value_->object();
}

JsonCursor JsonCursor::member(size_t index) const {
    return {*this, object().values[index], escapePointer(object().keys[index])};
}

std::vector<std::pair<std::string_view, JsonCursor>> JsonCursor::members() const {
    std::vector<std::pair<std::string_view, JsonCursor>> all;
    for (size_t i = 0; i < object().keys.size(); i++) all.emplace_back(object().keys[i], member(i));
    return all;
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
    const std::vector<std::string>& keys = object().keys;
    const auto at = std::ranges::find(keys, key);
    if (at == keys.end()) return std::nullopt;
    return member(static_cast<size_t>(at - keys.begin()));
}

JsonCursor JsonCursor::require(std::string_view key) const {
    const auto found = find(key);
    if (!found) fail("missing key \"", key, "\"");
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
        failWanted("must be a whole number from ", least, " to ", greatest);
    return static_cast<int>(*number);
}

const std::string& JsonCursor::string() const {
    if (!value_->string()) failWanted("must be a string");
    return *value_->string();
}

void JsonCursor::expectItems(size_t count, const std::string& wanted) const {
    if (!value_->array() || value_->array()->size() != count) failWanted("must be ", wanted);
}

std::vector<double> JsonCursor::numbers(size_t count, const std::string& wanted) const {
    expectItems(count, wanted);
    std::vector<double> values;
    for (size_t i = 0; i < count; i++) {
        const double* const number = (*value_->array())[i].number();
        values.push_back(number ? *number : item(i).number());  // which fails
    }
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

std::vector<double> JsonCursor::numbers(std::string_view key, size_t count) const {
    const auto found = find(key);
    return found ? found->numbers(count, std::to_string(count) + " numbers") : std::vector<double>();
}

}  // namespace glint
