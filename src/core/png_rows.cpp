// PNG row by row, by libpng: stb_image_write, which writes whole pictures, counts their bytes in an int.
#include <png.h>

#include <array>
#include <exception>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kPieceBytes = 1 << 18;  // of the compressed samples in one chunk

// By channels: grey, grey and alpha, RGB, RGBA.
constexpr std::array<int, 5> kColorTypes = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                            PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};

}  // namespace

struct PngRows::State {
    State(ByteSink& to, size_t bytesInRow) : sink(to), rowBytes(bytesInRow) {
        png = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, onError, nullptr);
        info = png == nullptr ? nullptr : png_create_info_struct(png);
        if (info == nullptr) throw std::bad_alloc();
    }
    ~State() { png_destroy_write_struct(&png, &info); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    // Runs `step` unless it fails, then throws. libpng jumps over step's frame, which must own nothing.
    template <typename Step>
    void run(Step step) {
        if (setjmp(png_jmpbuf(png)) == 0) return step();
        if (fault) std::rethrow_exception(fault);
        throw CodecError("cannot encode PNG (" + std::string(message.data()) + ")");
    }

    static void onError(png_structp png, png_const_charp message) {
        auto& state = *static_cast<State*>(png_get_error_ptr(png));
        std::snprintf(state.message.data(), state.message.size(), "%s", message);
        png_longjmp(png, 1);
    }
    static void writeBytes(png_structp png, png_bytep bytes, size_t size) {
        auto& state = *static_cast<State*>(png_get_io_ptr(png));
        // No exception may pass libpng's frames.
        try {
            state.sink.write(ByteView(bytes, size), state.position);
        } catch (...) {
            state.fault = std::current_exception();
        }
        if (state.fault) png_error(png, "not written");
        state.position += size;
    }

    ByteSink& sink;
    uint64_t position = 0;
    size_t rowBytes;
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::array<char, 128> message{};
    std::exception_ptr fault;  // of the sink
};

PngRows::PngRows(ByteSink& sink, int width, int height, int channels)
    : state_(std::make_unique<State>(sink, static_cast<size_t>(width) * static_cast<size_t>(channels))) {
    State& s = *state_;
    s.run([&] {
        png_set_user_limits(s.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        png_set_write_fn(s.png, &s, State::writeBytes, nullptr);
        // The compression of encodePng (stb_encoders.cpp).
        png_set_compression_level(s.png, 1);
        png_set_compression_buffer_size(s.png, kPieceBytes);
        png_set_filter(s.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
        png_set_IHDR(s.png, s.info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
                     kColorTypes[static_cast<size_t>(channels)], PNG_INTERLACE_NONE,
                     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_write_info(s.png, s.info);
    });
}

PngRows::~PngRows() = default;

void PngRows::add(ByteView samples) {
    State& s = *state_;
    s.run([&] {
        for (size_t at = 0; at < samples.size(); at += s.rowBytes) png_write_row(s.png, samples.data() + at);
    });
}

void PngRows::finish() {
    state_->run([&] { png_write_end(state_->png, nullptr); });
}

}  // namespace glint
