// OpenEXR files by tinyexr.
#include <tinyexr.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>

#include "core/codecs.h"

namespace glint {
namespace {

// Measured on one core, 1024x1024, three 32-bit channels (12.0 MiB raw): smooth, noise, half of it flat
// squares:
//   none     17,  56,  55 ms    12.0, 12.0, 12.0 MiB
//   RLE      34,  85,  63 ms    12.0, 12.0,  8.2 MiB
//   ZIP     386, 361, 206 ms    11.2, 12.0,  5.8 MiB
//   PIZ     381, 448, 258 ms     9.1, 12.0,  5.4 MiB
// Full float pictures hardly shrink, and a file with every layer has some 20 channels: RLE takes what is to
// be had (flat background, indices) for little time.
constexpr int kCompression = TINYEXR_COMPRESSIONTYPE_RLE;

struct HeaderGuard {
    EXRHeader header;
    HeaderGuard() { InitEXRHeader(&header); }
    ~HeaderGuard() { FreeEXRHeader(&header); }
    HeaderGuard(const HeaderGuard&) = delete;
    HeaderGuard& operator=(const HeaderGuard&) = delete;
};

struct ImageGuard {
    EXRImage image;
    bool loaded = false;
    ImageGuard() { InitEXRImage(&image); }
    ~ImageGuard() {
        if (loaded) {
            FreeEXRImage(&image);
        }
    }
    ImageGuard(const ImageGuard&) = delete;
    ImageGuard& operator=(const ImageGuard&) = delete;
};

std::string takeMessage(const char* message) {
    std::string text = message == nullptr ? "no reason given" : message;
    FreeEXRErrorMessage(message);
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) {
        text.pop_back();
    }
    return text;
}

float sampleAsFloat(const unsigned char* plane, int pixelType, size_t index) {
    uint32_t bits = 0;
    std::memcpy(&bits, plane + index * sizeof(bits), sizeof(bits));
    return pixelType == TINYEXR_PIXELTYPE_UINT ? static_cast<float>(bits) : std::bit_cast<float>(bits);
}

// Copies one plane, stored by scanlines or by tiles, into channel `channel` of the picture.
void copyPlane(const EXRHeader& header, const EXRImage& source, int plane, int channel, Image& target) {
    const int type = header.requested_pixel_types[plane];
    if (source.images != nullptr) {
        for (int y = 0; y < target.height; ++y) {
            for (int x = 0; x < target.width; ++x) {
                const size_t index = static_cast<size_t>(y) * target.width + x;
                target.at(x, y, channel) = sampleAsFloat(source.images[plane], type, index);
            }
        }
        return;
    }
    for (int t = 0; t < source.num_tiles; ++t) {
        const EXRTile& tile = source.tiles[t];
        const int left = tile.offset_x * header.tile_size_x;
        const int top = tile.offset_y * header.tile_size_y;
        for (int y = 0; y < std::min(tile.height, target.height - top); ++y) {
            for (int x = 0; x < std::min(tile.width, target.width - left); ++x) {
                const size_t index = static_cast<size_t>(y) * header.tile_size_x + x;
                target.at(left + x, top + y, channel) = sampleAsFloat(tile.images[plane], type, index);
            }
        }
    }
}

int findPlane(const EXRHeader& header, const std::string& name) {
    for (int i = 0; i < header.num_channels; ++i) {
        if (name == header.channels[i].name) {
            return i;
        }
    }
    return -1;
}

std::string layerOf(const char* channel) {
    const std::string name = channel;
    return name.substr(0, name.rfind('.') == std::string::npos ? 0 : name.rfind('.'));
}

// The planes of the file's only layer in the order X,Y,Z or U,V; nothing if there are several layers.
std::optional<std::vector<int>> onlyLayer(const EXRHeader& header) {
    std::vector<int> planes;
    for (int i = 0; i < header.num_channels; ++i) {
        if (layerOf(header.channels[i].name) != layerOf(header.channels[0].name)) {
            return std::nullopt;
        }
        planes.push_back(i);  // sorted by name in the file, which is that order
    }
    const bool supported = planes.size() == 1 || planes.size() == 3;
    return supported ? std::optional(planes) : std::nullopt;
}

// Which planes become the channels of the picture.
std::vector<int> choosePlanes(const EXRHeader& header) {
    const int r = findPlane(header, "R");
    const int g = findPlane(header, "G");
    const int b = findPlane(header, "B");
    const int a = findPlane(header, "A");
    if (r >= 0 && g >= 0 && b >= 0) {
        return a >= 0 ? std::vector{r, g, b, a} : std::vector{r, g, b};
    }
    if (const int y = findPlane(header, "Y"); y >= 0) {
        return a >= 0 ? std::vector{y, y, y, a} : std::vector{y};
    }
    if (auto planes = onlyLayer(header)) {
        return *planes;
    }
    std::string names;
    for (int i = 0; i < header.num_channels; ++i) {
        names += (i > 0 ? ", " : "") + std::string(header.channels[i].name);
    }
    throw CodecError("the EXR file has neither R, G, B nor Y, and more than one layer (channels " + names +
                     ")");
}

// The text at `position` up to its zero byte, which `position` then stands behind; nothing if there is no
// zero byte.
std::optional<std::string> readString(ByteView file, size_t& position) {
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(std::min(position, file.size()));
    const auto end = std::find(begin, file.end(), uint8_t{0});
    if (end == file.end()) {
        return std::nullopt;
    }
    position = static_cast<size_t>(end - file.begin()) + 1;
    return std::string(begin, end);
}

// tinyexr 1.0.1 ends the process (assert) for a "type" or "tiles" attribute that does not fit the version's
// flags. The header is a list of name, type, size and value that an empty name ends (OpenEXR, "File Layout",
// "Header").
void checkPartType(ByteView file, bool tiled) {
    constexpr size_t kTilesSize = 9;  // two 32-bit sizes and a mode
    const std::string expected = tiled ? "tiledimage" : "scanlineimage";
    bool hasTiles = false;
    size_t position = 8;  // behind magic number and version
    for (;;) {
        const auto name = readString(file, position);
        const auto valueType = name && !name->empty() ? readString(file, position) : std::nullopt;
        uint32_t size = 0;
        if (!valueType || file.size() - position < sizeof(size)) {
            break;  // the end, or damage that tinyexr finds
        }
        std::memcpy(&size, file.data() + position, sizeof(size));
        position += sizeof(size);
        if (size > file.size() - position) {
            break;
        }
        const ByteView value = file.subspan(position, size);
        const std::string text(value.begin(), std::find(value.begin(), value.end(), uint8_t{0}));
        if ((*name == "type" && !text.empty() && text != expected) ||
            (*name == "tiles" && tiled && size != kTilesSize)) {
            throw CodecError("the EXR file is damaged, or something other than a " + expected);
        }
        hasTiles = hasTiles || *name == "tiles";
        position += size;
    }
    if (tiled && !hasTiles) {
        throw CodecError("the EXR file is truncated or damaged (tiles of no size)");
    }
}

void parseHeader(ByteView file, EXRHeader& header) {
    EXRVersion version{};
    if (ParseEXRVersionFromMemory(&version, file.data(), file.size()) != TINYEXR_SUCCESS) {
        throw CodecError("the EXR file is truncated or damaged");
    }
    if (version.multipart != 0 || version.non_image != 0) {
        throw CodecError("EXR files with several parts or deep pixels are not supported");
    }
    checkPartType(file, version.tiled != 0);
    const char* message = nullptr;
    if (ParseEXRHeaderFromMemory(&header, &version, file.data(), file.size(), &message) != TINYEXR_SUCCESS) {
        throw CodecError("the EXR file is truncated or damaged (" + takeMessage(message) + ")");
    }
    for (int i = 0; i < header.num_channels; ++i) {
        if (header.channels[i].x_sampling != 1 || header.channels[i].y_sampling != 1) {
            throw CodecError("EXR files with subsampled channels are not supported");
        }
        if (header.requested_pixel_types[i] == TINYEXR_PIXELTYPE_HALF) {
            header.requested_pixel_types[i] = TINYEXR_PIXELTYPE_FLOAT;
        }
    }
}

void loadPlanes(ByteView file, const EXRHeader& header, ImageGuard& target) {
    // When it fails, tinyexr 1.0.1 frees the image itself and leaves dangling pointers in it, and it frees
    // only as many planes as num_channels says, which it sets at the very end.
    target.image.num_channels = header.tiled == 0 ? header.num_channels : 0;
    const char* message = nullptr;
    if (LoadEXRImageFromMemory(&target.image, &header, file.data(), file.size(), &message) !=
        TINYEXR_SUCCESS) {
        throw CodecError("the EXR file is truncated or damaged (" + takeMessage(message) + ")");
    }
    target.loaded = true;
}

}  // namespace

Bytes encodeExr(int width, int height, std::vector<ExrChannel> channels) {
    std::sort(channels.begin(), channels.end(),
              [](const ExrChannel& a, const ExrChannel& b) { return a.name < b.name; });
    const size_t count = channels.size();
    std::vector<EXRChannelInfo> infos(count);
    std::vector<int> types(count, TINYEXR_PIXELTYPE_FLOAT);
    std::vector<unsigned char*> planes(count);
    for (size_t i = 0; i < count; ++i) {
        infos[i] = EXRChannelInfo{};
        if (channels[i].name.size() >= sizeof(infos[i].name)) {
            throw CodecError("the layer name " + channels[i].name + " is too long for EXR");
        }
        std::copy(channels[i].name.begin(), channels[i].name.end(), infos[i].name);
        planes[i] = reinterpret_cast<unsigned char*>(channels[i].samples.data());
    }
    // The arrays belong to the vectors above, so neither struct is handed to tinyexr's Free functions.
    EXRHeader header;
    InitEXRHeader(&header);
    header.num_channels = static_cast<int>(count);
    header.channels = infos.data();
    header.pixel_types = types.data();
    header.requested_pixel_types = types.data();
    header.compression_type = kCompression;
    EXRImage image;
    InitEXRImage(&image);
    image.num_channels = static_cast<int>(count);
    image.images = planes.data();
    image.width = width;
    image.height = height;

    unsigned char* memory = nullptr;
    const char* message = nullptr;
    const size_t size = SaveEXRImageToMemory(&image, &header, &memory, &message);
    const std::unique_ptr<unsigned char, decltype(&std::free)> owner(memory, &std::free);
    if (size == 0) {
        throw CodecError("cannot encode EXR (" + takeMessage(message) + ")");
    }
    return Bytes(memory, memory + size);
}

Image decodeExr(ByteView file) {
    HeaderGuard header;
    parseHeader(file, header.header);
    const std::vector<int> planes = choosePlanes(header.header);
    ImageGuard source;
    loadPlanes(file, header.header, source);
    Image image(source.image.width, source.image.height, static_cast<int>(planes.size()));
    for (size_t i = 0; i < planes.size(); ++i) {
        copyPlane(header.header, source.image, planes[i], static_cast<int>(i), image);
    }
    return image;
}

}  // namespace glint
