// Files of finished units: parts of pictures that other machines drew, and pictures that go on later.
//
// A file is a signature and records, each with its kind, its length, its bytes and their hash (XXH3, 64
// bits): one HEAD, any number of UNITs, and DONE with their number in a file that is finished. So a reader
// tells what was cut off, changed or never finished, and a writer may append. The samples are floats, bit for
// bit, NaN in data layers included. No picture format holds scattered pieces of a picture together with what
// they were made from and a hash of all that; and nobody mistakes a part for a picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "farm/identity.h"
#include "farm/unit_result.h"

namespace glint::farm {

// Into which a picture may be cut.
inline constexpr int kMostParts = 1 << 20;

// Extension of the files that `glint render --part` writes.
inline constexpr const char* kPartExtension = ".part";

struct UnitHeader {
    Identity identity;
    Region region;          // all units together
    std::vector<Aov> aovs;  // the picture's layers in the order in which they were asked for
    int parts = 1;          // that it is cut into
};

struct UnitFileEnd {
    bool finished = false;    // has its last record
    uint64_t wholeBytes = 0;  // up to the end of the last record that is whole
};

// The bytes of a finished file, and those of one to which units will be appended.
std::vector<uint8_t> encodeUnits(const UnitHeader& header, std::span<const UnitResult> results);
std::vector<uint8_t> encodeHeader(const UnitHeader& header);
std::vector<uint8_t> encodeUnit(const UnitResult& result);

// Contents of a file, as found from the starts of its records.
struct UnitOutline {
    UnitHeader header;
    std::vector<int> parts;
    uint64_t bytes = 0;  // of the file
};
// Throws as forEachUnit, but does not check that the samples are whole.
UnitOutline outlineOf(const std::filesystem::path& path);

// Decode the output of encodeHeader and encodeUnit. `name`: the source, for messages. Both throw
// Error(Failed).
UnitHeader decodeHeader(std::span<const uint8_t> bytes, const std::string& name);
UnitResult decodeUnit(std::span<const uint8_t> bytes, const UnitHeader& header, const std::string& name);

// Reads a file unit by unit, so that one at a time is in memory; `begin` is called first. Throws
// Error(Failed) "a.part: damaged: ..." for a file that was changed or is no such file, and unless
// `unfinished` for one that ends early; with it, an incomplete record at the end is left out.
UnitFileEnd forEachUnit(const std::filesystem::path& path, bool unfinished,
                        const std::function<void(const UnitHeader&)>& begin,
                        const std::function<void(UnitResult)>& add);

}  // namespace glint::farm
