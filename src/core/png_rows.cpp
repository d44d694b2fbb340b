// PNG row by row, by zlib: stb_image_write, which writes whole pictures, counts their bytes in an int.
#include <zlib.h>

#include <array>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kPieceBytes = 1 << 18;  // of the compressed samples in one chunk
constexpr uint8_t kFilterUp = 2;

void appendWord(Bytes& bytes, uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<uint8_t>(value >> shift));
}

// By channels: grey, grey and alpha, RGB, RGBA.
constexpr std::array<uint8_t, 5> kColorTypes = {0, 0, 4, 2, 6};

}  // namespace

struct PngRows::State {
    State(ByteSink& to, size_t bytesInRow) : sink(to), rowBytes(bytesInRow), above(bytesInRow, 0) {
        // As encodePng compresses (stb_encoders.cpp).
        if (deflateInit(&stream, 1) != Z_OK) throw CodecError("not enough memory to compress the picture");
    }
    ~State() { deflateEnd(&stream); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void put(const Bytes& bytes) {
        sink.write(bytes, position);
        position += bytes.size();
    }
    void chunk(const char* name, ByteView data) {
        Bytes bytes;
        bytes.reserve(data.size() + 12);
        appendWord(bytes, static_cast<uint32_t>(data.size()));
        bytes.insert(bytes.end(), name, name + 4);
        bytes.insert(bytes.end(), data.begin(), data.end());
        appendWord(bytes,
                   static_cast<uint32_t>(crc32(0, bytes.data() + 4, static_cast<uInt>(data.size() + 4))));
        put(bytes);
    }
    // Writes what is compressed in whole pieces; at the end, all.
    void compress(ByteView bytes, int flush) {
        stream.next_in = const_cast<uint8_t*>(bytes.data());
        stream.avail_in = static_cast<uInt>(bytes.size());
        int result = Z_OK;
        do {
            stream.next_out = piece.data() + filled;
            stream.avail_out = static_cast<uInt>(piece.size() - filled);
            result = deflate(&stream, flush);
            filled = piece.size() - stream.avail_out;
            if (filled == piece.size() || (result == Z_STREAM_END && filled > 0)) {
                chunk("IDAT", ByteView(piece.data(), filled));
                filled = 0;
            }
        } while (stream.avail_in > 0 || (flush == Z_FINISH && result != Z_STREAM_END));
    }

    ByteSink& sink;
    uint64_t position = 0;
    size_t rowBytes;
    Bytes above, filtered;
    z_stream stream{};
    Bytes piece = Bytes(kPieceBytes);
    size_t filled = 0;
};

PngRows::PngRows(ByteSink& sink, int width, int height, int channels)
    : state_(std::make_unique<State>(sink, static_cast<size_t>(width) * static_cast<size_t>(channels))) {
    state_->put({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'});
    Bytes header;
    appendWord(header, static_cast<uint32_t>(width));
    appendWord(header, static_cast<uint32_t>(height));
    header.insert(header.end(), {8, kColorTypes[static_cast<size_t>(channels)], 0, 0, 0});
    state_->chunk("IHDR", header);
}

PngRows::~PngRows() = default;

void PngRows::add(ByteView samples) {
    State& s = *state_;
    for (size_t at = 0; at < samples.size(); at += s.rowBytes) {
        const ByteView row = samples.subspan(at, s.rowBytes);
        s.filtered.resize(row.size() + 1);
        s.filtered[0] = kFilterUp;
        for (size_t k = 0; k < row.size(); ++k) s.filtered[k + 1] = static_cast<uint8_t>(row[k] - s.above[k]);
        s.above.assign(row.begin(), row.end());
        s.compress(s.filtered, Z_NO_FLUSH);
    }
}

void PngRows::finish() {
    state_->compress({}, Z_FINISH);
    state_->chunk("IEND", {});
}

}  // namespace glint
