#include <string>

#include "app/option_values.h"
#include "core/text_file.h"

namespace glint::app {

std::string quoted(const std::string& text) {
    constexpr size_t kLongest = 60;
    return '"' + printable(text.substr(0, kLongest)) + (text.size() > kLongest ? "...\"" : "\"");
}

}  // namespace glint::app
