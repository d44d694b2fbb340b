// PNG by libpng; stb_image_write, which writes whole images, counts their bytes in an int.
#include <png.h>

#include <array>
#include <cstring>
#include <new>

#include "core/codecs.h"

namespace glint {
namespace {

// Deflate makes at most 1032 bytes of one (zlib, "Maximum Compression Factor"), and a pixel has a bit at
// least.
constexpr double kMostPixelsPerByte = 8 * 1032;
constexpr size_t kMostChunkBytes = 8 << 20;

// Chunks that do not change the samples are not looked at: text, profiles and suggestions, each of them a
// format of its own.
constexpr png_byte kIgnored[] =
    "bKGD\0cHRM\0eXIf\0gAMA\0hIST\0iCCP\0iTXt\0oFFs\0pCAL\0pHYs\0sBIT\0sCAL\0sPLT\0sRGB\0sTER\0tEXt\0tIME\0"
    "zTXt";

struct Decoder {
    explicit Decoder(ByteView source) : file(source) {}
    ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;

    ByteView file;
    size_t position = 0;
    png_structp png = nullptr;
    png_infop info = nullptr;
    bool truncated = false;
    std::array<char, 128> message{};
    // Shape of the samples that libpng returns.
    size_t width = 0, height = 0, channels = 0, rowBytes = 0;
    int passes = 1;  // over all rows of an interlaced image
    bool wide = false;
};

void onError(png_structp png, png_const_charp message) {
    auto& decoder = *static_cast<Decoder*>(png_get_error_ptr(png));
    std::strncpy(decoder.message.data(), message, decoder.message.size() - 1);
    png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void readBytes(png_structp png, png_bytep data, size_t size) {
    auto& decoder = *static_cast<Decoder*>(png_get_io_ptr(png));
    if (decoder.file.size() - decoder.position < size) {
        decoder.truncated = true;
        png_error(png, "truncated");
    }
    std::memcpy(data, decoder.file.data() + decoder.position, size);
    decoder.position += size;
}

// Runs `step` unless it fails, then throws. libpng jumps over step's frame, which must own nothing.
template <typename Step>
void run(Decoder& decoder, Step step) {
    if (setjmp(png_jmpbuf(decoder.png)) == 0) {
        step();
        return;
    }
    if (decoder.truncated) throw CodecError("the file is truncated");
    failDamaged(decoder.message.data());
}

void start(Decoder& decoder) {
    png_structp png = decoder.png;
    png_set_user_limits(png, kMostPictureSide, kMostPictureSide);
    png_set_chunk_malloc_max(png, kMostChunkBytes);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, kIgnored, sizeof(kIgnored) / 5);
    png_set_read_fn(png, &decoder, readBytes);
    png_read_info(png, decoder.info);
}

// Palettes and few bits become 8 bits, transparent colours an alpha channel, grey with alpha RGBA.
void startRows(Decoder& decoder) {
    png_structp png = decoder.png;
    png_set_expand(png);
    if (png_get_bit_depth(png, decoder.info) == 16) png_set_swap(png);  // to the host's little endian
    const int type = png_get_color_type(png, decoder.info);
    const bool alpha = (type & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png, decoder.info, PNG_INFO_tRNS);
    if (alpha && (type & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png);
    decoder.passes = png_set_interlace_handling(png);
    png_read_update_info(png, decoder.info);
    decoder.channels = png_get_channels(png, decoder.info);
    decoder.wide = png_get_bit_depth(png, decoder.info) == 16;
    decoder.rowBytes = png_get_rowbytes(png, decoder.info);
}

void linearize(const Decoder& decoder, const uint8_t* row, const std::vector<float>& linear, float* samples) {
    const size_t count = decoder.width * decoder.channels;
    const double greatest = static_cast<double>(linear.size() - 1);
    for (size_t i = 0; i < count; ++i) {
        uint16_t code = row[decoder.wide ? 2 * i : i];
        if (decoder.wide) code = static_cast<uint16_t>(code | row[2 * i + 1] << 8);
        const bool isAlpha = decoder.channels == 4 && i % 4 == 3;
        samples[i] = isAlpha ? static_cast<float>(code / greatest) : linear[code];
    }
}

void appendBytes(png_structp png, png_bytep data, size_t size) {
    auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
    bool added = false;
    try {
        bytes.insert(bytes.end(), data, data + size);
        added = true;
    } catch (const std::bad_alloc&) {
    }
    if (!added) png_error(png, "memory");
}

class PngRows : public RowEncoder {
  public:
    PngRows(ByteSink& sink, int width, int height, int channels)
        : sink_(sink), rowBytes_(static_cast<size_t>(width) * static_cast<size_t>(channels)) {
        constexpr int kColorTypes[] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                       PNG_COLOR_TYPE_RGB_ALPHA};  // by channels
        encode([&] {
            png_set_write_fn(out_.png, &bytes_, appendBytes, [](png_structp) {});
            png_set_IHDR(out_.png, out_.info, static_cast<png_uint_32>(width),
                         static_cast<png_uint_32>(height), 8, kColorTypes[channels], PNG_INTERLACE_NONE,
                         PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
            // Like encodePng (stb_encoders.cpp).
            png_set_compression_level(out_.png, 1);
            png_set_filter(out_.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
            png_set_compression_buffer_size(out_.png, 1 << 18);
            png_write_info(out_.png, out_.info);
        });
    }

    void add(const std::vector<Layer>& rows) override {
        const Bytes samples = pngSamples(rows);
        for (size_t at = 0; at < samples.size(); at += rowBytes_)
            encode([&] { png_write_row(out_.png, samples.data() + at); });
    }
    void fill(int rows, const std::vector<Layer>& row) override {
        const Bytes samples = pngSamples(row);  // once
        for (; rows > 0; --rows) encode([&] { png_write_row(out_.png, samples.data()); });
    }
    void finish() override {
        encode([&] { png_write_end(out_.png, nullptr); });
    }

  private:
    struct Encoder {
        Encoder() = default;
        ~Encoder() { png_destroy_write_struct(&png, &info); }
        Encoder(const Encoder&) = delete;
        Encoder& operator=(const Encoder&) = delete;
        png_structp png = png_create_write_struct(
            PNG_LIBPNG_VER_STRING, nullptr, [](png_structp p, png_const_charp) { png_longjmp(p, 1); },
            onWarning);
        png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
    };

    // Like run(), then gives the bytes to the sink.
    template <typename Step>
    void encode(Step step) {
        if (out_.info == nullptr) throw std::bad_alloc();
        if (setjmp(png_jmpbuf(out_.png)) != 0) throw CodecError("not enough memory to compress the image");
        step();
        if (bytes_.empty()) return;
        sink_.write(bytes_, position_);
        position_ += bytes_.size();
        bytes_.clear();
    }

    ByteSink& sink_;
    size_t rowBytes_;
    uint64_t position_ = 0;
    Bytes bytes_;  // that the sink does not have yet
    Encoder out_;
};

}  // namespace

std::unique_ptr<RowEncoder> pngRows(ByteSink& sink, int width, int height, const std::vector<Layer>& shape) {
    return std::make_unique<PngRows>(sink, width, height, pngChannels(shape));
}

Image decodePng(ByteView file, uint64_t mostPixels, const Context& context) {
    Decoder decoder(file);
    decoder.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder, onError, onWarning);
    decoder.info = decoder.png == nullptr ? nullptr : png_create_info_struct(decoder.png);
    if (decoder.info == nullptr) throw std::bad_alloc();
    run(decoder, [&] { start(decoder); });
    decoder.width = png_get_image_width(decoder.png, decoder.info);
    decoder.height = png_get_image_height(decoder.png, decoder.info);
    const double bits = png_get_bit_depth(decoder.png, decoder.info) *
                        static_cast<double>(png_get_channels(decoder.png, decoder.info));
    checkDeclaredSize(decoder.width, decoder.height, file.size(), kMostPixelsPerByte / bits, mostPixels);
    run(decoder, [&] { startRows(decoder); });

    RowCollector rows(context, static_cast<int>(decoder.width), static_cast<int>(decoder.height),
                      static_cast<int>(decoder.channels));
    const std::vector<float> linear = linearOfCodes(decoder.wide ? 65536 : 256);
    const bool interlaced = decoder.passes > 1;
    std::vector<uint8_t> bytes(decoder.rowBytes * (interlaced ? decoder.height : 1));
    for (int pass = 1; pass <= decoder.passes; ++pass) {
        for (size_t y = 0; y < decoder.height; ++y) {
            context.checkCancelled();
            uint8_t* const row = bytes.data() + (interlaced ? y * decoder.rowBytes : 0);
            run(decoder, [&] { png_read_row(decoder.png, row, nullptr); });
            if (pass == decoder.passes) linearize(decoder, row, linear, rows.next());
        }
    }
    run(decoder, [&] { png_read_end(decoder.png, nullptr); });
    return rows.take();
}

}  // namespace glint
