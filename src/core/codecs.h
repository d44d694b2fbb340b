// Encoders and decoders between images and the bytes of a file; core/image_io.h is the public face.
// Encoders take images whose sizes have been checked. Everything here throws CodecError with the bare
// reason.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/context.h"
#include "core/file_io.h"
#include "core/image.h"

namespace glint {

using Bytes = std::vector<uint8_t>;
using ByteView = std::span<const uint8_t>;

class CodecError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// "the file is damaged or of a kind that is not supported (REASON)"
[[noreturn]] void failDamaged(const std::string& reason);

class MemorySink : public ByteSink {
  public:
    void write(ByteView added, uint64_t offset) override {
        if (offset + added.size() > bytes.size()) bytes.resize(offset + added.size());
        std::memcpy(bytes.data() + offset, added.data(), added.size());
    }
    Bytes bytes;
};

// 1 to 4 interleaved 8-bit channels: grey, grey and alpha, RGB, RGBA.
Bytes encodePng(int width, int height, int channels, const Bytes& samples);

// RGBE shares one exponent: a stored sample lies below the given one by less than 1/128 of the pixel's
// greatest channel. Negative samples and NaN become 0, +inf the greatest value that RGBE holds. 1 to 4
// channels; 2 get a third of zeros, a fourth is dropped.
Bytes encodeHdr(const Image& image);

// 1 to 4 channels; 2 get a third of zeros, a fourth is dropped. Every bit of a sample is kept, NaN included.
Bytes encodePfm(const Image& image);

// By OpenEXR. 32-bit float channels in one part, named as writeLayers (core/image_io.h) states. Every bit of
// a sample is kept. Notes become attributes of the header, numbers as doubles.
Bytes encodeExr(const std::vector<Layer>& layers, const PictureNotes& notes = {});

// The layer with that name, or null.
const Layer* findLayer(const std::vector<Layer>& layers, std::string_view name);

// The 8-bit samples of a PNG and their channels: of the layer "color", whose alpha a layer "alpha" replaces,
// or of "alpha" alone.
Bytes pngSamples(const std::vector<Layer>& layers);
int pngChannels(const std::vector<Layer>& layers);

// Encodes an image of any size as its rows arrive from the top.
class RowEncoder {
  public:
    RowEncoder() = default;
    virtual ~RowEncoder() = default;
    RowEncoder(const RowEncoder&) = delete;
    RowEncoder& operator=(const RowEncoder&) = delete;

    virtual void add(const std::vector<Layer>& rows) = 0;
    // The last `rows` rows of the image, all like the one given.
    virtual void fill(int rows, const std::vector<Layer>& row) {
        for (; rows > 0; --rows) add(row);
    }
    virtual void finish() = 0;
};

// `shape`: the layers as add() will get them; their images may be empty but for the channels. The sink must
// outlive the encoder.
std::unique_ptr<RowEncoder> exrRows(ByteSink& sink, int width, int height, const std::vector<Layer>& shape,
                                    const PictureNotes& notes = {});
// The pixels of encodePng; the bytes need not be the same.
std::unique_ptr<RowEncoder> pngRows(ByteSink& sink, int width, int height, const std::vector<Layer>& shape);
// The layer of that name, in a file of its own. Last rows of zeros are not written: the file system keeps no
// bytes of them.
std::unique_ptr<RowEncoder> pfmRows(ByteSink& sink, int width, int height, const Layer& shape);

// Pixels along a side of the largest image that is decoded.
inline constexpr uint64_t kMostPictureSide = 65536;

// For decoders, before they take memory: refuses an empty image, a size beyond the limits above, and one that
// the file is too short for, if each byte stands for at most `pixelsPerByte` pixels.
void checkDeclaredSize(uint64_t width, uint64_t height, size_t fileBytes, double pixelsPerByte,
                       uint64_t mostPixels);

// Takes memory only as rows arrive: a file that ends early costs only the rows that it held.
class RowCollector {
  public:
    // The context must outlive it.
    RowCollector(const Context& context, int width, int height, int channels);
    // Space for the samples of the next `count` rows.
    float* next(int count = 1);
    Image take() { return std::move(image_); }

  private:
    const Context& context_;
    Image image_;
    size_t rowSamples_;
};

// The linear value of each of the `count` codes of sRGB samples.
std::vector<float> linearOfCodes(size_t count);

// By libpng. 1 to 16 bits, grey, RGB or palette, with or without alpha; grey with alpha becomes RGBA.
Image decodePng(ByteView file, uint64_t mostPixels = kMostPixels, const Context& context = {});
// By libjpeg-turbo. Grey, or RGB from any colour space.
Image decodeJpeg(ByteView file, uint64_t mostPixels = kMostPixels, const Context& context = {});
Image decodeHdr(ByteView file, uint64_t mostPixels = kMostPixels, const Context& context = {});
// By libwebp: sRGB, with or without alpha, no animations. Refused in builds without it.
Image decodeWebp(ByteView file, uint64_t mostPixels = kMostPixels, const Context& context = {});
Image decodePfm(ByteView file, uint64_t mostPixels = kMostPixels, const Context& context = {});

// By OpenEXR. Of the first part: the channels R, G, B and A if there is colour, else Y, else the channels of
// the only layer. Tiles, scanlines and every compression; no deep pixels.
Image decodeExr(ByteView file, uint64_t mostPixels = kMostPixels, const Context& context = {});

}  // namespace glint
