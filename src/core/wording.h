// Small phrases of messages and tables, and texts without what surrounds them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/text_file.h"

namespace glint {

// "1 light", "2 lights"
inline std::string counted(uint64_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

// User's text for a message: in quotes, on one line, of at most 60 bytes.
inline std::string quoted(const std::string& text) {
    constexpr size_t kLongest = 60;
    return '"' + printable(text.substr(0, kLongest)) + (text.size() > kLongest ? "...\"" : "\"");
}

// Without the blanks, tabs and carriage returns around it.
inline std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// The parts between separators, at least one.
inline std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    size_t start = 0;
    for (size_t end = 0; end != std::string::npos; start = end + 1) {
        end = text.find(separator, start);
        parts.push_back(text.substr(start, end - start));
    }
    return parts;
}

}  // namespace glint
