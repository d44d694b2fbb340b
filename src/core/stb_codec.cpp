// PNG, JPEG and Radiance HDR by the stb libraries (Sean Barrett and others, public domain). They are compiled
// here, and static: other libraries in the process (Assimp, say) export copies of their own.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "core/codecs.h"
#include "core/quantize.h"

namespace {

// stb's own deflate is replaced by zlib at level 1. Measured on one core, 1024x1024 RGB, three pictures
// (smooth; the same with noise of +-4; flat squares), filter Up:
//   stb level 8 (its default)   107, 149, 47 ms    740, 2645, 31 KiB
//   stb level 1                  84, 137, 35 ms    761, 2652, 31 KiB
//   zlib level 1                 25,  41,  5 ms    577, 1786, 16 KiB
//   zlib level 6                167, 148, 10 ms    419, 1717,  5 KiB
//   libpng level 1               23,  35,  5 ms    577, 1789, 16 KiB
// Choosing the filter for each row (stb's default) costs 10 to 20 ms more and changed the sizes by
// +7, -4 and +6 %. With quantizeColor and the file itself, writeImage takes 50 ms of processor time.
unsigned char* compressWithZlib(unsigned char* data, int size, int* compressedSize, int /*quality*/) {
    uLongf bound = compressBound(static_cast<uLong>(size));
    auto* out = static_cast<unsigned char*>(std::malloc(bound));
    if (out == nullptr || compress2(out, &bound, data, static_cast<uLong>(size), 1) != Z_OK) {
        std::free(out);
        return nullptr;
    }
    *compressedSize = static_cast<int>(bound);
    return out;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS compressWithZlib
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_HDR
#define STBI_FAILURE_USERMSG
#include <stb_image.h>

namespace glint {
namespace {

// Written once, before main: encodePng may run in several threads.
[[maybe_unused]] const int kPngFilter = stbi_write_force_png_filter = 2;  // Up

void appendBytes(void* context, void* data, int size) {
    auto& bytes = *static_cast<Bytes*>(context);
    const auto* begin = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
}

// A file in memory that notices when stb asks for more than there is: by itself stb takes a missing end for
// zeros and returns a picture that is partly black (JPEG, HDR).
struct ByteSource {
    ByteView bytes;
    bool endless = false;  // past the end, supply bytes of 255
    size_t position = 0;
    bool overrun = false;
};

constexpr int kStbBuffer = sizeof(stbi__context::buffer_start);

int readBytes(void* user, char* data, int size) {
    auto& source = *static_cast<ByteSource*>(user);
    const size_t available = source.bytes.size() - source.position;
    const size_t taken = std::min(available, static_cast<size_t>(size));
    std::copy_n(source.bytes.begin() + source.position, taken, reinterpret_cast<uint8_t*>(data));
    source.position += taken;
    // stb fills its buffer as far as the file goes; any other request is for exactly that many bytes.
    source.overrun = source.overrun || (taken < static_cast<size_t>(size) && size != kStbBuffer);
    if (taken > 0) {
        return static_cast<int>(taken);
    }
    source.overrun = true;
    if (!source.endless) {
        return 0;
    }
    std::memset(data, 255, static_cast<size_t>(size));
    return size;
}

void skipBytes(void* user, int count) {
    auto& source = *static_cast<ByteSource*>(user);
    const auto target = static_cast<long long>(source.position) + count;
    source.overrun = source.overrun || target > static_cast<long long>(source.bytes.size());
    source.position = static_cast<size_t>(std::clamp<long long>(target, 0, source.bytes.size()));
}

int atEnd(void* user) {
    const auto& source = *static_cast<ByteSource*>(user);
    return source.position >= source.bytes.size() ? 1 : 0;
}

constexpr stbi_io_callbacks kCallbacks{readBytes, skipBytes, atEnd};

struct StbFree {
    void operator()(void* samples) const { stbi_image_free(samples); }
};

// Runs stbi_load, stbi_load_16 or stbi_loadf and hands over its samples with two channels widened to four.
template <typename Sample, typename Load>
std::unique_ptr<Sample, StbFree> load(ByteSource& source, Load stbLoad, Image& size) {
    // The file's channels are known only afterwards, but have to be chosen before.
    ByteSource probe = source;
    int channels = 0;
    const bool known =
        stbi_info_from_callbacks(&kCallbacks, &probe, &size.width, &size.height, &channels) != 0;
    size.channels = known && channels == 2 ? 4 : channels;
    std::unique_ptr<Sample, StbFree> samples(
        known ? stbLoad(&kCallbacks, &source, &size.width, &size.height, &channels, size.channels) : nullptr);
    if (source.overrun || probe.overrun) {
        throw CodecError("the file is truncated");
    }
    if (!samples || size.width <= 0 || size.height <= 0) {
        throw CodecError("the file is damaged or of a kind that is not supported (" +
                         (samples ? "no pixels" : std::string(stbi_failure_reason())) + ")");
    }
    size.pixels.resize(static_cast<size_t>(size.width) * static_cast<size_t>(size.height) *
                       static_cast<size_t>(size.channels));
    return samples;
}

template <typename Sample>
void linearize(const Sample* samples, double maximum, Image& image) {
    std::vector<float> linear(static_cast<size_t>(maximum) + 1);
    for (size_t i = 0; i < linear.size(); ++i) {
        linear[i] = static_cast<float>(linearFromSrgb(static_cast<double>(i) / maximum));
    }
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const bool isAlpha = image.channels == 4 && i % 4 == 3;
        image.pixels[i] = isAlpha ? static_cast<float>(samples[i] / maximum) : linear[samples[i]];
    }
}

Image decode8(ByteView file) {
    ByteSource source{file};
    Image image;
    const auto samples = load<stbi_uc>(source, stbi_load_from_callbacks, image);
    linearize(samples.get(), 255.0, image);
    return image;
}

}  // namespace

Bytes encodePng(int width, int height, int channels, const Bytes& samples) {
    // stb counts the bytes before and after compression in an int.
    if ((static_cast<double>(width) * channels + 1) * height > 2.0e9) {
        throw CodecError("the picture is too large for PNG (2 GB), use EXR or PFM");
    }
    Bytes file;
    if (stbi_write_png_to_func(appendBytes, &file, width, height, channels, samples.data(),
                               width * channels) == 0) {
        throw CodecError("not enough memory to compress the picture");
    }
    return file;
}

Bytes encodeHdr(const Image& image) {
    // Mantissa 255/256, exponent byte 255, that is 2^127 (Ward, "Real Pixels", Graphics Gems II, 1991).
    const float greatest = std::ldexp(255.0f / 256.0f, 127);
    const int kept = std::min(image.channels, 3);
    std::vector<float> samples;
    samples.reserve(image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (static_cast<int>(i % static_cast<size_t>(image.channels)) < kept) {
            const float value = image.pixels[i];
            samples.push_back(value > 0.0f ? std::min(value, greatest) : 0.0f);
        }
    }
    Bytes file;
    if (stbi_write_hdr_to_func(appendBytes, &file, image.width, image.height, kept, samples.data()) == 0) {
        throw CodecError("not enough memory to encode the picture");
    }
    return file;
}

Image decodePng(ByteView file) {
    ByteSource probe{file};
    if (stbi_is_16_bit_from_callbacks(&kCallbacks, &probe) == 0) {
        return decode8(file);
    }
    ByteSource source{file};
    Image image;
    const auto samples = load<stbi_us>(source, stbi_load_16_from_callbacks, image);
    linearize(samples.get(), 65535.0, image);
    return image;
}

Image decodeJpeg(ByteView file) {
    return decode8(file);
}

Image decodeHdr(ByteView file) {
    // In stb 2.27 a scanline that ends with the file never ends: it is read as zeros, runs of length 0. Bytes
    // of 255 are long runs or pixels, which come to an end; the header, which they would extend for ever, is
    // checked before.
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (text.find("\n\n") == std::string_view::npos) {
        throw CodecError("the file is truncated");
    }
    ByteSource source{file, true};
    Image image;
    const auto samples = load<float>(source, stbi_loadf_from_callbacks, image);
    std::copy_n(samples.get(), image.pixels.size(), image.pixels.begin());
    return image;
}

}  // namespace glint
