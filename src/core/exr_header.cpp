#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kMostParts = 1000;

// A part of the file that is read from its start. Throws CodecError beyond its end.
class Bounded {
  public:
    explicit Bounded(ByteView bytes) : bytes_(bytes) {}

    ByteView next(uint64_t size) {
        if (size > bytes_.size()) throw CodecError("the file is truncated");
        const ByteView part = bytes_.first(size);
        bytes_ = bytes_.subspan(size);
        return part;
    }
    uint32_t word() {
        uint32_t value = 0;
        std::memcpy(&value, next(sizeof(value)).data(), sizeof(value));
        return value;
    }
    // Up to a zero byte, which is read too.
    std::string_view text() {
        const auto end = std::find(bytes_.begin(), bytes_.end(), uint8_t{0});
        if (end == bytes_.end()) throw CodecError("the file is truncated");
        const ByteView part = next(static_cast<uint64_t>(end - bytes_.begin()));
        next(1);
        return {reinterpret_cast<const char*>(part.data()), part.size()};
    }
    bool atEnd() const { return bytes_.empty(); }

  private:
    ByteView bytes_;
};

struct TypeSize {
    std::string_view type;
    size_t bytes;
};

// OpenEXR, "Predefined Attribute Types"
constexpr TypeSize kFixed[] = {{"box2i", 16},
                               {"box2f", 16},
                               {"chromaticities", 32},
                               {"compression", 1},
                               {"deepImageState", 1},
                               {"double", 8},
                               {"envmap", 1},
                               {"float", 4},
                               {"int", 4},
                               {"keycode", 28},
                               {"m33f", 36},
                               {"m33d", 72},
                               {"m44f", 64},
                               {"m44d", 128},
                               {"lineOrder", 1},
                               {"v2i", 8},
                               {"rational", 8},
                               {"tiledesc", 9},
                               {"timecode", 8},
                               {"v2f", 8},
                               {"v2d", 16},
                               {"v3i", 12},
                               {"v3f", 12},
                               {"v3d", 24}};

bool isWhole(std::string_view type, ByteView value) {
    const auto fixed = std::find_if(std::begin(kFixed), std::end(kFixed),
                                    [&](const TypeSize& known) { return known.type == type; });
    if (fixed != std::end(kFixed)) return value.size() == fixed->bytes;
    Bounded in(value);
    if (type == "chlist") {  // names with 16 bytes each, and an empty one
        while (!in.text().empty()) in.next(16);
    } else if (type == "preview") {
        const uint64_t width = in.word(), height = in.word();
        if (width > value.size() || height > value.size()) return false;
        in.next(width * height * 4);
    } else if (type == "stringvector") {
        while (!in.atEnd()) in.next(in.word());
    } else {
        return true;  // as long as is said, which the library keeps to
    }
    return in.atEnd();
}

}  // namespace

// A header is a list of name, type, size and value that an empty name ends; several parts have as many, and
// an empty one at the end (OpenEXR, "File Layout").
void checkExrAttributes(ByteView file, bool severalParts) {
    Bounded in(file.subspan(kExrFirstHeader));
    for (size_t parts = 0; parts < kMostParts; ++parts) {
        size_t attributes = 0;
        for (;; ++attributes) {
            const std::string_view name = in.text();
            if (name.empty()) break;
            const std::string_view type = in.text();
            if (!isWhole(type, in.next(in.word())))
                throw CodecError("the EXR file is damaged (its attribute \"" + std::string(name) +
                                 "\" is not of the size that it says)");
        }
        if (!severalParts || attributes == 0) return;
    }
    throw CodecError("the EXR file has more than " + std::to_string(kMostParts) + " parts");
}

}  // namespace glint
