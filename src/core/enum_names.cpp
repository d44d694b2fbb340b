#include "core/enum_names.h"

namespace glint {

std::string oneOf(std::span<const std::string_view> names, std::string_view quote) {
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
        text.append(quote).append(names[i]).append(quote);
    }
    return text;
}

}  // namespace glint
