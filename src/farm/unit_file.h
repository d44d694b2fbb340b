// Files of finished units: parts of images that other machines rendered, and checkpoints.
// A file is a signature and records, each with its length, its bytes and their hash (XXH3, 64 bits). The
// first record is the header, the others are units: one in a part, any number in a checkpoint. So a reader
// detects missing or changed records, and a writer can append. Samples are floats with all their bits, NaN in
// data layers included. No image format holds scattered pieces of an image with their origin and a hash.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "farm/unit.h"

namespace glint::farm {

// Extension of the files that `glint render --part` writes.
inline constexpr const char* kPartExtension = ".part";

// The start of a file, and a unit after it.
std::vector<uint8_t> encodeHeader(const UnitHeader& header);
std::vector<uint8_t> encodeUnit(const UnitResult& result);

// Decode the output of encodeHeader and encodeUnit. `name`: the source, for messages. Both throw
// Error(Failed) "NAME: damaged: ...".
UnitHeader decodeHeader(std::span<const uint8_t> bytes, const std::string& name);
UnitResult decodeUnit(std::span<const uint8_t> bytes, const UnitHeader& header, const std::string& name);

// The bytes of a part.
std::vector<uint8_t> encodePart(const UnitHeader& header, const UnitResult& result);

// The unit of such a file. Throws Error(Failed) "a.part: damaged: ..." for a file that was changed, that ends
// early, or that is no such file.
UnitResult readPart(const std::filesystem::path& path);

// The start of such a file. Throws as readPart, but does not check the unit.
struct PartOutline {
    UnitHeader header;
    int part = 0;
    uint64_t bytes = 0;  // of the file
};
PartOutline outlineOf(const std::filesystem::path& path);

// Reads all units of a file, one at a time in memory, up to the first one that is incomplete or damaged;
// `begin` is called first. Returns the number of bytes up to there. Throws Error(Failed) if the header is
// damaged.
uint64_t forEachUnit(const std::filesystem::path& path, const std::function<void(const UnitHeader&)>& begin,
                     const std::function<void(const UnitResult&)>& add);

}  // namespace glint::farm
