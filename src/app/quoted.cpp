#include <string>

#include "app/option_values.h"

namespace glint::app {

std::string quoted(const std::string& text) {
    constexpr size_t kLongest = 60;
    std::string shown = "\"";
    for (const char c : text.substr(0, kLongest)) {
        const auto code = static_cast<unsigned char>(c);
        shown += code < 32 || code == 127 ? '?' : c;
    }
    return shown + (text.size() > kLongest ? "...\"" : "\"");
}

}  // namespace glint::app
