// Encoders and decoders between pictures and the bytes of a file; core/image_io.h is the public face.
// Encoders take pictures whose sizes have been checked. Everything here throws CodecError with the bare
// reason.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/context.h"
#include "core/image_io.h"

namespace glint {

using Bytes = std::vector<uint8_t>;
using ByteView = std::span<const uint8_t>;

class CodecError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// Receives the bytes of a file, in any order.
class ByteSink {
  public:
    virtual ~ByteSink() = default;
    virtual void write(ByteView bytes, uint64_t offset) = 0;
};

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
// greatest channel. Negative samples and NaN become 0, +inf the greatest value that RGBE holds. 1, 3 or 4
// channels, a fourth is dropped.
Bytes encodeHdr(const Image& image);

// 1, 3 or 4 channels, a fourth is dropped. Every bit of a sample is kept, NaN included.
Bytes encodePfm(const Image& image);

// One plane of an EXR file.
struct ExrChannel {
    std::string name;
    std::vector<float> samples;  // row 0 at the top
};

// By OpenEXR. 32-bit float channels in one part; sorts them by name as the format asks. Every bit of a sample
// is kept. Notes become attributes of the header, numbers as doubles.
Bytes encodeExr(int width, int height, std::vector<ExrChannel> channels, const PictureNotes& notes = {});

// The same, written as rows arrive from the top.
class ExrRows {
  public:
    ExrRows(ByteSink& sink, int width, int height, const std::vector<std::string>& channels,
            const PictureNotes& notes = {});
    ~ExrRows();
    ExrRows(const ExrRows&) = delete;
    ExrRows& operator=(const ExrRows&) = delete;

    void add(int rows, std::vector<ExrChannel>& channels);
    // The last `rows` rows of the picture, all like the one given, which is encoded once.
    void fill(int rows, std::vector<ExrChannel>& row);
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// encodePng as rows arrive from the top, of any size. The pixels are the same, the bytes need not be.
class PngRows {
  public:
    PngRows(ByteSink& sink, int width, int height, int channels);
    ~PngRows();
    PngRows(const PngRows&) = delete;
    PngRows& operator=(const PngRows&) = delete;

    void add(ByteView samples);  // of whole rows
    // So many rows like the one given, which are compressed by the block.
    void fill(int rows, ByteView row);
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// encodePfm as rows arrive from the top.
class PfmRows {
  public:
    PfmRows(ByteSink& sink, int width, int height, int channels);
    void add(const Image& rows);
    // The last rows of the picture, all like the one given. Those that are zeros are not written: the file
    // system keeps no bytes of them.
    void fill(const Image& row);

  private:
    uint64_t positionOf(int rowsBelow) const;

    ByteSink& sink_;
    int width_, kept_, left_;  // rows that are still to come
    uint64_t first_;           // byte behind the header
};

// The largest picture that is decoded: 16,384 x 16,384 pixels, 4 GiB of RGBA floats.
inline constexpr uint64_t kMostPicturePixels = kMostPixels;
inline constexpr uint64_t kMostPictureSide = 65536;

// For decoders, before memory is taken: refuses a size of nothing, beyond the limits above, or of which the
// file's bytes, each of which stands for at most `pixelsPerByte` pixels, cannot hold the pixels.
void checkDeclaredSize(uint64_t width, uint64_t height, size_t fileBytes, double pixelsPerByte,
                       uint64_t mostPixels);

// Memory that is taken only as rows arrive: a file that ends early costs what it held.
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
Image decodePng(ByteView file, uint64_t mostPixels = kMostPicturePixels, const Context& context = {});
// By libjpeg-turbo. Grey, or RGB of whatever colour space.
Image decodeJpeg(ByteView file, uint64_t mostPixels = kMostPicturePixels, const Context& context = {});
Image decodeHdr(ByteView file, uint64_t mostPixels = kMostPicturePixels, const Context& context = {});
// By libwebp: sRGB, with or without alpha, no animations. Refused in builds without it.
Image decodeWebp(ByteView file, uint64_t mostPixels = kMostPicturePixels, const Context& context = {});
Image decodePfm(ByteView file, uint64_t mostPixels = kMostPicturePixels, const Context& context = {});

inline constexpr size_t kExrFirstHeader = 8;  // behind magic number and version

// Throws CodecError for attributes that do not have the size that their type has, or that is said: the
// library goes by the one, or takes memory by the other, whatever the file holds.
void checkExrAttributes(ByteView file, bool severalParts);

// By OpenEXR. Of the first part: the channels R, G, B and A if there is colour, else Y, else the channels of
// the only layer. Tiles, scanlines and every compression; no deep pixels.
Image decodeExr(ByteView file, uint64_t mostPixels = kMostPicturePixels, const Context& context = {});

}  // namespace glint
