// PNG row by row, by zlib: stb_image_write, which writes whole images, counts their bytes in an int.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kPieceBytes = 1 << 18;  // of the compressed samples in one chunk, about
constexpr size_t kRoomBytes = 1 << 14;   // that the compressed samples grow by
constexpr size_t kFillBytes = 1 << 22;   // of the samples that are compressed once for many rows alike
constexpr uint8_t kFilterUp = 2;

void appendWord(Bytes& bytes, uint32_t value) {
    const auto byte = [value](int shift) { return static_cast<uint8_t>(value >> shift); };
    const std::array<uint8_t, 4> word = {byte(24), byte(16), byte(8), byte(0)};
    bytes.insert(bytes.end(), word.begin(), word.end());
}

// By channels: grey, grey and alpha, RGB, RGBA.
constexpr std::array<uint8_t, 5> kColorTypes = {0, 0, 4, 2, 6};

Bytes chunkOf(const char* name, ByteView data) {
    Bytes bytes;
    bytes.reserve(data.size() + 12);
    appendWord(bytes, static_cast<uint32_t>(data.size()));
    bytes.insert(bytes.end(), name, name + 4);
    bytes.insert(bytes.end(), data.begin(), data.end());
    appendWord(bytes, static_cast<uint32_t>(crc32(0, bytes.data() + 4, static_cast<uInt>(data.size() + 4))));
    return bytes;
}

// The compression of encodePng (stb_encoders.cpp). PngRows writes zlib's header and checksum itself, since
// one compressed block may be written several times.
struct Deflater {
    Deflater() {
        if (deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
            throw CodecError("not enough memory to compress the image");
    }
    ~Deflater() { deflateEnd(&stream); }
    Deflater(const Deflater&) = delete;
    Deflater& operator=(const Deflater&) = delete;
    z_stream stream{};
};

class PngRows : public RowEncoder {
  public:
    PngRows(ByteSink& to, int width, int height, int channels)
        : sink_(to),
          rowBytes_(static_cast<size_t>(width) * static_cast<size_t>(channels)),
          above_(rowBytes_, 0) {
        put({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'});
        Bytes header;
        appendWord(header, static_cast<uint32_t>(width));
        appendWord(header, static_cast<uint32_t>(height));
        header.insert(header.end(), {8, kColorTypes[static_cast<size_t>(channels)], 0, 0, 0});
        put(chunkOf("IHDR", header));
    }

    void add(const std::vector<Layer>& rows) override {
        const Bytes samples = pngSamples(rows);
        for (size_t at = 0; at < samples.size(); at += rowBytes_)
            compressRow(ByteView(samples).subspan(at, rowBytes_));
    }

    // Below the first of these rows every filtered one is zeros. A block that begins and ends with a full
    // flush stands on whole bytes and refers to none before it, so that its chunk can be written any number
    // of times.
    void fill(int rows, const std::vector<Layer>& layers) override {
        const Bytes row = pngSamples(layers);
        if (rows-- > 0) compressRow(row);
        const int inBlock = static_cast<int>(std::max<size_t>(kFillBytes / (rowBytes_ + 1), 1));
        if (rows >= 2 * inBlock) {
            compress({}, Z_FULL_FLUSH);
            put(chunkOf("IDAT", std::exchange(packed_, {})));
            Bytes block(static_cast<size_t>(inBlock) * (rowBytes_ + 1), 0);
            for (size_t k = 0; k < block.size(); k += rowBytes_ + 1) block[k] = kFilterUp;
            const uLong sumBefore = sum_;
            compress(block, Z_FULL_FLUSH);
            sum_ = sumBefore;
            const Bytes chunk = chunkOf("IDAT", std::exchange(packed_, {}));
            const uLong blockSum = adler32_z(1, block.data(), block.size());
            for (; rows >= inBlock; rows -= inBlock) {
                put(chunk);
                sum_ = adler32_combine(sum_, blockSum, static_cast<z_off_t>(block.size()));
            }
        }
        for (; rows > 0; --rows) compressRow(row);
    }

    void finish() override {
        compress({}, Z_FINISH);
        appendWord(packed_, static_cast<uint32_t>(sum_));
        put(chunkOf("IDAT", packed_));
        put(chunkOf("IEND", {}));
    }

  private:
    void put(const Bytes& bytes) {
        sink_.write(bytes, position_);
        position_ += bytes.size();
    }
    // Appends the compressed bytes to `packed_`.
    void compress(ByteView bytes, int flush) {
        if (!bytes.empty()) sum_ = adler32_z(sum_, bytes.data(), bytes.size());
        z_stream& stream = deflater_.stream;
        stream.next_in = const_cast<uint8_t*>(bytes.data());
        stream.avail_in = static_cast<uInt>(bytes.size());
        do {
            const size_t packed = packed_.size();
            packed_.resize(packed + kRoomBytes);
            stream.next_out = packed_.data() + packed;
            stream.avail_out = kRoomBytes;
            deflate(&stream, flush);
            packed_.resize(packed_.size() - stream.avail_out);
        } while (stream.avail_out == 0);
    }
    void compressRow(ByteView row) {
        filtered_.resize(row.size() + 1);
        filtered_[0] = kFilterUp;
        for (size_t k = 0; k < row.size(); ++k) filtered_[k + 1] = static_cast<uint8_t>(row[k] - above_[k]);
        above_.assign(row.begin(), row.end());
        compress(filtered_, Z_NO_FLUSH);
        if (packed_.size() >= kPieceBytes) put(chunkOf("IDAT", std::exchange(packed_, {})));
    }

    ByteSink& sink_;
    uint64_t position_ = 0;
    size_t rowBytes_;
    Bytes above_, filtered_;
    Deflater deflater_;
    Bytes packed_ = {0x78, 0x01};  // zlib's header; then compressed bytes that are not written yet
    uLong sum_ = 1;                // Adler-32 of all bytes before compression
};

}  // namespace

std::unique_ptr<RowEncoder> pngRows(ByteSink& sink, int width, int height, const std::vector<Layer>& shape) {
    return std::make_unique<PngRows>(sink, width, height, pngChannels(shape));
}

}  // namespace glint
