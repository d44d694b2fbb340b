// Small phrases of messages and tables.
#pragma once

#include <cstdint>
#include <string>

namespace glint {

// "1 light", "2 lights"
inline std::string counted(uint64_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace glint
