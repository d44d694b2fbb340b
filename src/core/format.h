// Text as of printf: the oldest supported compiler lacks std::format.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace glint {

// At most 511 bytes.
[[gnu::format(printf, 1, 2)]] inline std::string format(const char* form, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, form);
    std::vsnprintf(text, sizeof(text), form, arguments);
    va_end(arguments);
    return text;
}

}  // namespace glint
