// PNG row by row, by zlib: stb_image_write, which writes whole pictures, counts their bytes in an int.
#include <zlib.h>

#include <algorithm>
#include <array>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kPieceBytes = 1 << 18;  // of the compressed samples in one chunk
constexpr size_t kFillBytes = 1 << 22;   // of the samples that are compressed once for many rows alike
constexpr uint8_t kFilterUp = 2;

void appendWord(Bytes& bytes, uint32_t value) {
    const auto byte = [value](int shift) { return static_cast<uint8_t>(value >> shift); };
    const std::array<uint8_t, 4> word = {byte(24), byte(16), byte(8), byte(0)};
    bytes.insert(bytes.end(), word.begin(), word.end());
}

// By channels: grey, grey and alpha, RGB, RGBA.
constexpr std::array<uint8_t, 5> kColorTypes = {0, 0, 4, 2, 6};

}  // namespace

struct PngRows::State {
    State(ByteSink& to, size_t bytesInRow) : sink(to), rowBytes(bytesInRow), above(bytesInRow, 0) {
        // Same compression as encodePng (stb_encoders.cpp). zlib's header and checksum are written here,
        // since one compressed block may be written several times.
        if (deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
            throw CodecError("not enough memory to compress the picture");
        piece[0] = 0x78;
        piece[1] = 0x01;
    }
    ~State() { deflateEnd(&stream); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void put(const Bytes& bytes) {
        sink.write(bytes, position);
        position += bytes.size();
        if (copy) copy->insert(copy->end(), bytes.begin(), bytes.end());
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
    void endPiece() {
        if (filled > 0) chunk("IDAT", ByteView(piece.data(), filled));
        filled = 0;
    }
    // Writes what is compressed in whole pieces.
    void compress(ByteView bytes, int flush) {
        if (!bytes.empty()) sum = adler32_z(sum, bytes.data(), bytes.size());
        stream.next_in = const_cast<uint8_t*>(bytes.data());
        stream.avail_in = static_cast<uInt>(bytes.size());
        int result = Z_OK;
        do {
            stream.next_out = piece.data() + filled;
            stream.avail_out = static_cast<uInt>(piece.size() - filled);
            result = deflate(&stream, flush);
            filled = piece.size() - stream.avail_out;
            if (filled == piece.size()) endPiece();
        } while (stream.avail_out == 0 || (flush == Z_FINISH && result != Z_STREAM_END));
    }
    void compressRow(ByteView row) {
        filtered.resize(row.size() + 1);
        filtered[0] = kFilterUp;
        for (size_t k = 0; k < row.size(); ++k) filtered[k + 1] = static_cast<uint8_t>(row[k] - above[k]);
        above.assign(row.begin(), row.end());
        compress(filtered, Z_NO_FLUSH);
    }

    ByteSink& sink;
    uint64_t position = 0;
    size_t rowBytes;
    Bytes above, filtered;
    z_stream stream{};
    Bytes piece = Bytes(kPieceBytes);
    size_t filled = 2;      // zlib's header
    uLong sum = 1;          // Adler-32 of all bytes before compression
    Bytes* copy = nullptr;  // takes what is written
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
    for (size_t at = 0; at < samples.size(); at += s.rowBytes) s.compressRow(samples.subspan(at, s.rowBytes));
}

// Below the first of these rows every filtered one is zeros. A block that begins and ends with a full flush
// stands on whole bytes and refers to none before it, so that its chunks can be written any number of times.
void PngRows::fill(int rows, ByteView row) {
    State& s = *state_;
    if (rows-- > 0) s.compressRow(row);
    const int inBlock = static_cast<int>(std::max<size_t>(kFillBytes / (s.rowBytes + 1), 1));
    if (rows >= 2 * inBlock) {
        s.compress({}, Z_FULL_FLUSH);
        s.endPiece();
        Bytes block(static_cast<size_t>(inBlock) * (s.rowBytes + 1), 0), chunks;
        for (size_t k = 0; k < block.size(); k += s.rowBytes + 1) block[k] = kFilterUp;
        s.copy = &chunks;
        s.compress(block, Z_FULL_FLUSH);
        s.endPiece();
        s.copy = nullptr;
        const uLong blockSum = adler32_z(1, block.data(), block.size());
        for (rows -= inBlock; rows >= inBlock; rows -= inBlock) {
            s.put(chunks);
            s.sum = adler32_combine(s.sum, blockSum, static_cast<z_off_t>(block.size()));
        }
    }
    for (; rows > 0; --rows) s.compressRow(row);
}

void PngRows::finish() {
    State& s = *state_;
    s.compress({}, Z_FINISH);
    if (s.filled + sizeof(uint32_t) > s.piece.size()) s.endPiece();
    for (const int shift : {24, 16, 8, 0}) s.piece[s.filled++] = static_cast<uint8_t>(s.sum >> shift);
    s.endPiece();
    s.chunk("IEND", {});
}

}  // namespace glint
