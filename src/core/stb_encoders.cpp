// stb_image_write (Sean Barrett and others, public domain) writes PNG and Radiance HDR. It is compiled here,
// and static: other libraries in the process (Assimp, say) export copies of their own. png_codec.cpp and
// hdr_decoder.cpp read these formats.
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/codecs.h"

namespace {

// stb's own deflate is replaced by zlib at level 1. Measured on one core, 1024x1024 RGB, three images
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

namespace glint {
namespace {

// Written once, before main: encodePng may run in several threads.
[[maybe_unused]] const int kPngFilter = stbi_write_force_png_filter = 2;  // Up

void appendBytes(void* context, void* data, int size) {
    auto& bytes = *static_cast<Bytes*>(context);
    const auto* begin = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
}

}  // namespace

Bytes encodePng(int width, int height, int channels, const Bytes& samples) {
    // stb counts the bytes before and after compression in an int.
    if ((static_cast<double>(width) * channels + 1) * height > 2.0e9) {
        throw CodecError("the image is too large for PNG (2 GB), use EXR or PFM");
    }
    Bytes file;
    if (stbi_write_png_to_func(appendBytes, &file, width, height, channels, samples.data(),
                               width * channels) == 0) {
        throw CodecError("not enough memory to compress the image");
    }
    return file;
}

Bytes encodeHdr(const Image& image) {
    // Mantissa 255/256, exponent byte 255, that is 2^127 (Ward, "Real Pixels", Graphics Gems II, 1991).
    const float greatest = std::ldexp(255.0f / 256.0f, 127);
    const auto from = static_cast<size_t>(image.channels), kept = size_t{from == 1 ? 1u : 3u};
    std::vector<float> samples(image.pixels.size() / from * kept, 0.0f);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const float value = image.pixels[i];
        if (i % from < kept && value > 0.0f) samples[i / from * kept + i % from] = std::min(value, greatest);
    }
    Bytes file;
    if (stbi_write_hdr_to_func(appendBytes, &file, image.width, image.height, static_cast<int>(kept),
                               samples.data()) == 0) {
        throw CodecError("not enough memory to encode the image");
    }
    return file;
}

}  // namespace glint
