#include "import/json_document.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>

#include "core/call_terms.h"
#include "core/error.h"
#include "core/text_file.h"
#include "scene/limits.h"

namespace glint {

namespace {

// Tells how far the parser has read: nlohmann passes a position with syntax errors, but none with a key.
struct TrackedChar {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    const char* at = nullptr;
    const char** furthest = nullptr;
    ReadingPace* pace = nullptr;

    reference operator*() const { return *at; }
    TrackedChar& operator++() {
        *furthest = ++at;
        pace->reached(at);
        return *this;
    }
    TrackedChar operator++(int) {
        const TrackedChar before = *this;
        ++*this;
        return before;
    }
    bool operator==(const TrackedChar& other) const { return at == other.at; }
    bool operator!=(const TrackedChar& other) const { return at != other.at; }
};

std::string afterWord(const std::string& text, const std::string& word) {
    const size_t at = text.find(word);
    return at == std::string::npos ? "" : text.substr(at + word.size());
}

std::string untilWord(const std::string& text, const std::string& word) {
    return text.substr(0, text.find(word));
}

// The parser's words for tokens, in ours.
std::string readableToken(const std::string& token) {
    if (token == "string literal") return "a string";
    if (token == "number literal") return "a number";
    if (token == "end of input") return "the end of the file";
    if (token.ends_with(" literal")) return token.substr(0, token.size() - 8);  // true, false, null
    return token;
}

// From "[json.exception...] parse error at line 3, column 5: syntax error while parsing object - unexpected
// string literal; expected '}'" to "expected ',' or '}' (got a string)".
std::string readableSyntaxError(const std::string& message) {
    const std::string number = afterWord(message, "number overflow parsing '");
    if (!number.empty()) return "number out of range: " + untilWord(number, "'");

    const std::string context = untilWord(afterWord(message, "while parsing "), " - ");
    const std::string detail = afterWord(message, " - ");
    const std::string unexpected = afterWord(detail, "unexpected ");
    if (unexpected.empty() || !detail.starts_with("unexpected ")) {
        const std::string reason = untilWord(detail, "; last read");
        if (reason == "invalid literal") return "not a JSON value (text needs double quotes)";
        return reason;
    }
    const std::string got = readableToken(untilWord(unexpected, ";"));
    std::string expected = readableToken(afterWord(unexpected, "expected "));
    if (expected == "'}'" || expected == "']'")
        expected = "',' or " + expected;
    else if (expected.starts_with("'[', '{'"))
        expected = "a value";
    else if (context == "object key")
        expected = "a key in double quotes";
    return "expected " + expected + " (got " + got + ")";
}

class TreeBuilder {
  public:
    TreeBuilder(std::string_view text, const std::string& file, const char* const& furthest)
        : text_(text), file_(file), furthest_(furthest) {}

    JsonValue takeRoot() { return std::move(root_); }

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
            failAt(readSoFar(), "the key \"" + name + "\" stands here twice");
        std::get<JsonObject>(open_.back().value->data).keys.push_back(std::move(name));
        return true;
    }

    bool parse_error(size_t position, const std::string& lastToken, const nlohmann::json::exception& error) {
        const std::string what = error.what();
        // The position is that of the last character read. An unexpected token is best shown by its first
        // one; only for strings and numbers does `lastToken` hold just the token.
        size_t length = 1;
        if (what.find("unexpected string") != std::string::npos ||
            what.find("unexpected number") != std::string::npos ||
            what.find("number overflow") != std::string::npos)
            length = lastToken.size();
        else if (what.find("unexpected true") != std::string::npos ||
                 what.find("unexpected null") != std::string::npos)
            length = 4;
        else if (what.find("unexpected false") != std::string::npos)
            length = 5;
        failAt(position > text_.size() ? text_.size() : position - std::min(position, length),
               readableSyntaxError(what));
    }

  private:
    struct Open {
        JsonValue* value;
        std::set<std::string> seen;  // no hashes: whoever writes the file may make all of them equal
    };

    size_t readSoFar() const { return static_cast<size_t>(furthest_ - text_.data()); }

    [[noreturn]] void failAt(size_t offset, const std::string& what) const {
        const std::string_view before = text_.substr(0, offset);
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        const std::string_view start = before.substr(before.rfind('\n') + 1);
        const auto column =
            1 + std::count_if(start.begin(), start.end(), [](char c) { return (c & 0xc0) != 0x80; });
        throw Error(ErrorKind::Scene, printable(file_ + ":" + std::to_string(line) + ":" +
                                                std::to_string(column) + ": " + what));
    }

    JsonValue* place(JsonValue value) {
        if (++count_ > kMaxJsonValues)
            failAt(readSoFar(), "more than " + std::to_string(kMaxJsonValues) +
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
            failAt(readSoFar() - 1, "nested deeper than " + std::to_string(kMaxJsonDepth) + " levels");
        open_.push_back({place(std::move(value)), {}});
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    std::string_view text_;
    const std::string& file_;
    const char* const& furthest_;
    JsonValue root_;
    std::vector<Open> open_;
    size_t count_ = 0;
};

void describeInto(const JsonValue& value, std::string& out) {
    struct Visitor {
        std::string& out;
        void operator()(std::monostate) const { out += "null"; }
        void operator()(bool b) const { out += b ? "true" : "false"; }
        void operator()(double d) const { out += describe(d); }
        void operator()(const std::string& s) const { out += '"' + s + '"'; }
        void operator()(const JsonObject&) const { out += "an object"; }
        void operator()(const JsonArray& items) const {
            out += '[';
            for (size_t i = 0; i < items.size() && out.size() < 80; i++) {
                if (i > 0) out += ", ";
                describeInto(items[i], out);
            }
            out += ']';
        }
    };
    std::visit(Visitor{out}, value.data);
}

}  // namespace

JsonValue parseJson(std::string_view text, const std::string& file) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // the byte order mark some editors write
    if (text.size() > kMaxJsonBytes)
        throw Error(ErrorKind::Scene, file + ": larger than " + std::to_string(kMaxJsonBytes >> 20) +
                                          " MiB: put large geometry into a mesh file");
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        throw Error(ErrorKind::Scene, file + ": the file is empty");
    // As some editors write it; with its mark, or with the zero bytes that it has instead.
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
        text.substr(0, 2).find('\0') != text.npos)
        throw Error(ErrorKind::Scene, file + ": is in UTF-16, or no text; JSON must be in UTF-8");
    const char* furthest = text.data();
    TreeBuilder builder(text, file, furthest);
    ReadingPace pace(text.data(), text.data() + text.size());
    nlohmann::json::sax_parse(TrackedChar{text.data(), &furthest, &pace},
                              TrackedChar{text.data() + text.size(), &furthest, &pace}, &builder,
                              nlohmann::json::input_format_t::json, true, true);
    return builder.takeRoot();
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

}  // namespace glint
