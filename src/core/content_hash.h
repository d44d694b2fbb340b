// One number for the content of files and settings.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace glint {

// XXH3, 64 bits, seed 0 (Y. Collet, https://xxhash.com). Tells apart what differs or was damaged, not what
// was forged.
uint64_t contentHash(std::span<const uint8_t> bytes);
uint64_t contentHash(std::string_view text);

// 16 hexadecimal digits.
std::string hashText(uint64_t hash);

}  // namespace glint
