// JPEG by libjpeg-turbo.
#include <csetjmp>
#include <cstddef>
#include <cstdio>  // jpeglib.h needs FILE

// clang-format off: jerror.h needs jpeglib.h before it
#include <jerror.h>
#include <jpeglib.h>
// clang-format on

#include <array>
#include <optional>

#include "core/codecs.h"

namespace glint {
namespace {

// Huffman codes have a bit at least for each block of 64 samples. Blocks are fewest where one component is
// sampled four times as finely along rows and another along columns: 8 for 32 x 32 pixels.
constexpr double kMostPixelsPerByte = 8 * 128;
// Progressive files may go over the image again and again in a few bytes each. Encoders write 10.
constexpr int kMostScans = 100;
constexpr long kMostMemory = 2L << 30;

struct Failure {
    std::jmp_buf back;
    std::array<char, JMSG_LENGTH_MAX> message{};
    bool truncated = false;
    bool cancelled = false;
    const Context* context = nullptr;
};

Failure& failureOf(j_common_ptr info) {
    return *static_cast<Failure*>(info->client_data);
}

[[noreturn]] void fail(j_common_ptr info) {
    info->err->format_message(info, failureOf(info).message.data());
    std::longjmp(failureOf(info).back, 1);
}

// Level -1 is a warning. libjpeg decodes a damaged file to an image with wrong parts: refused. Two harmless
// warnings are common in real files and let pass: a colour marker, and meaningless bytes between segments.
void onMessage(j_common_ptr info, int level) {
    if (level >= 0) return;
    switch (info->err->msg_code) {
        case JWRN_JPEG_EOF:
        case JWRN_HIT_MARKER:
            failureOf(info).truncated = true;
            fail(info);
        case JWRN_ADOBE_XFORM:
        case JWRN_EXTRANEOUS_DATA:
        case JWRN_JFIF_MAJOR:
            return;
        default:
            fail(info);
    }
}

// Progressive files are read as a whole before the first row. No exception may pass libjpeg's frames.
void onProgress(j_common_ptr info) {
    if ((failureOf(info).cancelled = failureOf(info).context->isCancelled()))
        std::longjmp(failureOf(info).back, 1);
    if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number <= kMostScans) return;
    info->err->msg_code = JERR_BAD_PROGRESSION;
    fail(info);
}

struct Decoder {
    explicit Decoder(const Context& context) {
        failure.context = &context;
        info.err = jpeg_std_error(&errors);
        errors.error_exit = fail;
        errors.emit_message = onMessage;
        info.client_data = &failure;
        progress.progress_monitor = onProgress;
    }
    ~Decoder() { jpeg_destroy_decompress(&info); }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;

    jpeg_decompress_struct info{};
    jpeg_error_mgr errors{};
    jpeg_progress_mgr progress{};
    Failure failure;
    std::optional<RowCollector> rows;
    std::vector<uint8_t> row;
    std::vector<float> linear = linearOfCodes(256);
};

// libjpeg's error handler jumps back over this function. Nothing here or in run() has a destructor that a
// jump would skip; such objects live in Decoder.
void start(Decoder& decoder, ByteView file) {
    jpeg_decompress_struct& info = decoder.info;
    jpeg_create_decompress(&info);
    info.mem->max_memory_to_use = kMostMemory;
    info.progress = &decoder.progress;
    jpeg_mem_src(&info, file.data(), static_cast<unsigned long>(file.size()));
    jpeg_read_header(&info, TRUE);
}

void startRows(Decoder& decoder) {
    jpeg_decompress_struct& info = decoder.info;
    if (info.jpeg_color_space == JCS_GRAYSCALE)
        info.out_color_space = JCS_GRAYSCALE;
    else
        info.out_color_space = info.num_components == 4 ? JCS_CMYK : JCS_RGB;
    jpeg_start_decompress(&info);
}

// Adobe's programs store inks inverted: 255 is none.
uint8_t ofInk(uint8_t ink, uint8_t black, bool inverted) {
    const unsigned a = inverted ? ink : 255u - ink, b = inverted ? black : 255u - black;
    const unsigned product = a * b + 128;  // of two fractions of 255, rounded (J. Blinn, "Three Wrongs Make a
    return static_cast<uint8_t>((product + (product >> 8)) >> 8);  // Right", IEEE CG&A 15(6), 1995)
}

void convertRow(Decoder& decoder, float* samples) {
    const jpeg_decompress_struct& info = decoder.info;
    const std::vector<float>& linear = decoder.linear;
    if (info.out_color_space == JCS_CMYK) {
        for (size_t x = 0; x < info.output_width; ++x)
            for (size_t c = 0; c < 3; ++c)
                samples[3 * x + c] = linear[ofInk(decoder.row[4 * x + c], decoder.row[4 * x + 3],
                                                  info.saw_Adobe_marker == TRUE)];
        return;
    }
    for (size_t i = 0; i < decoder.row.size(); ++i) samples[i] = linear[decoder.row[i]];
}

// Runs `step` unless it fails, then throws; step must own nothing.
template <typename Step>
void run(Decoder& decoder, Step step) {
    if (setjmp(decoder.failure.back) == 0) {
        step();
        return;
    }
    if (decoder.failure.cancelled) throw Cancelled();
    if (decoder.failure.truncated) throw CodecError("the file is truncated");
    failDamaged(decoder.failure.message.data());
}

}  // namespace

Image decodeJpeg(ByteView file, uint64_t mostPixels, const Context& context) {
    Decoder decoder(context);
    jpeg_decompress_struct& info = decoder.info;
    run(decoder, [&] { start(decoder, file); });
    checkDeclaredSize(info.image_width, info.image_height, file.size(), kMostPixelsPerByte, mostPixels);
    run(decoder, [&] { startRows(decoder); });
    const auto stored = static_cast<size_t>(info.output_components);
    decoder.row.resize(stored * info.output_width);
    decoder.rows.emplace(context, static_cast<int>(info.output_width), static_cast<int>(info.output_height),
                         stored == 1 ? 1 : 3);
    while (info.output_scanline < info.output_height) {
        uint8_t* row = decoder.row.data();
        run(decoder, [&] { jpeg_read_scanlines(&info, &row, 1); });
        convertRow(decoder, decoder.rows->next());
    }
    run(decoder, [&] { jpeg_finish_decompress(&info); });
    return decoder.rows->take();
}

}  // namespace glint
