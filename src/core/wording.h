// Small phrases of messages and tables, and texts without what surrounds them.
#pragma once

#include <cstdint>
#include <string>

namespace glint {

// "1 light", "2 lights"
inline std::string counted(uint64_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

// Without the blanks, tabs and carriage returns around it.
inline std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace glint
