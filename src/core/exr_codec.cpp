// OpenEXR files by the library of that name.
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <optional>
#include <string_view>

#include "core/codecs.h"
#include "core/enum_names.h"

namespace glint {
namespace {

// Measured on one core, 1024x1024, three 32-bit channels (12.0 MiB raw): smooth, noise, half of it flat
// squares:
//   none     17,  56,  55 ms    12.0, 12.0, 12.0 MiB
//   RLE      34,  85,  63 ms    12.0, 12.0,  8.2 MiB
//   ZIP     386, 361, 206 ms    11.2, 12.0,  5.8 MiB
//   PIZ     381, 448, 258 ms     9.1, 12.0,  5.4 MiB
// Full float images hardly shrink, and a file with every layer has some 20 channels: RLE takes what is to
// be had (flat background, indices) for little time.
constexpr Imf::Compression kCompression = Imf::RLE_COMPRESSION;

// Deflate makes at most 1032 bytes of one, PXR24 packs 4 bytes into 3 before; runs and Huffman codes do less.
constexpr double kMostBytesPerByte = 1032 * 4.0 / 3;
// DWA deflates runs of a discrete cosine transform's coefficients: there is no such bound.
constexpr double kNoBound = 1e30;
constexpr double kMostChunkBytes = 512.0 * 1024 * 1024;
constexpr size_t kFirstHeader = 8;  // behind magic number and version
constexpr int kBand = 64;           // rows in one request to the library

// The library makes its pool of threads, which has none, when it first hands out a task. Where memory runs
// out just then, it waits for that task for ever (3.1.5); so the pool is made before there are any.
void makePool() {
    Imf::globalThreadCount();
}

constexpr size_t kMostParts = 1000;

// A part of the file that is read from its start. Throws CodecError beyond its end.
class Bounded {
  public:
    explicit Bounded(ByteView bytes) : bytes_(bytes) {}

    ByteView next(uint64_t size) {
        if (size > bytes_.size()) throw CodecError("the file is truncated");
        const ByteView part = bytes_.first(size);
        bytes_ = bytes_.subspan(size);
        return part;
    }
    uint32_t word() {
        uint32_t value = 0;
        std::memcpy(&value, next(sizeof(value)).data(), sizeof(value));
        return value;
    }
    // Up to a zero byte, which is read too.
    std::string_view text() {
        const auto end = std::find(bytes_.begin(), bytes_.end(), uint8_t{0});
        if (end == bytes_.end()) throw CodecError("the file is truncated");
        const ByteView part = next(static_cast<uint64_t>(end - bytes_.begin()));
        next(1);
        return {reinterpret_cast<const char*>(part.data()), part.size()};
    }
    bool atEnd() const { return bytes_.empty(); }

  private:
    ByteView bytes_;
};

// Types of one size (OpenEXR, "Predefined Attribute Types").
struct TypesOfSize {
    size_t bytes;
    std::array<std::string_view, 5> types;
};
constexpr TypesOfSize kFixed[] = {{1, {"compression", "deepImageState", "envmap", "lineOrder"}},
                                  {4, {"float", "int"}},
                                  {8, {"double", "rational", "timecode", "v2f", "v2i"}},
                                  {9, {"tiledesc"}},
                                  {12, {"v3f", "v3i"}},
                                  {16, {"box2f", "box2i", "v2d"}},
                                  {24, {"v3d"}},
                                  {28, {"keycode"}},
                                  {32, {"chromaticities"}},
                                  {36, {"m33f"}},
                                  {64, {"m44f"}},
                                  {72, {"m33d"}},
                                  {128, {"m44d"}}};

bool isWhole(std::string_view type, ByteView value) {
    for (const TypesOfSize& known : kFixed)
        if (!type.empty() && std::ranges::find(known.types, type) != known.types.end())
            return value.size() == known.bytes;
    Bounded in(value);
    if (type == "chlist") {  // names with 16 bytes each, and an empty one
        while (!in.text().empty()) in.next(16);
    } else if (type == "preview") {
        const uint64_t width = in.word(), height = in.word();
        if (width > value.size() || height > value.size()) return false;
        in.next(width * height * 4);
    } else if (type == "stringvector") {
        while (!in.atEnd()) in.next(in.word());
    } else {
        return true;  // of the announced length, which the library keeps to
    }
    return in.atEnd();
}

// Throws CodecError for attributes whose size differs from that of their type or from the announced one. The
// library relies on the one and takes memory by the other, even beyond the file's length.
// A header is a list of name, type, size and value that an empty name ends. A file of several parts has
// several headers, and an empty one at the end (OpenEXR, "File Layout").
void checkAttributes(ByteView file, bool severalParts) {
    Bounded in(file.subspan(kFirstHeader));
    for (size_t parts = 0; parts < kMostParts; ++parts) {
        size_t attributes = 0;
        for (;; ++attributes) {
            const std::string_view name = in.text();
            if (name.empty()) break;
            const std::string_view type = in.text();
            if (!isWhole(type, in.next(in.word())))
                throw CodecError("the EXR file is damaged (its attribute \"" + std::string(name) +
                                 "\" is not of the size that it says)");
        }
        if (!severalParts || attributes == 0) return;
    }
    throw CodecError("the EXR file has more than " + std::to_string(kMostParts) + " parts");
}

class MemoryReader : public Imf::IStream {
  public:
    explicit MemoryReader(ByteView file) : IStream("the file"), file_(file) {}

    bool read(char bytes[], int count) override {
        const size_t left = position_ < file_.size() ? file_.size() - position_ : 0;
        if (count < 0 || static_cast<size_t>(count) > left) throw CodecError("the file is truncated");
        std::memcpy(bytes, file_.data() + position_, static_cast<size_t>(count));
        position_ += static_cast<size_t>(count);
        return position_ < file_.size();
    }
    uint64_t tellg() override { return position_; }
    void seekg(uint64_t position) override { position_ = position; }

  private:
    ByteView file_;
    uint64_t position_ = 0;
};

struct ChunkShape {
    double bytesPerByte;
    int rows;  // of a chunk of scanlines
};

ChunkShape chunkShape(Imf::Compression compression) {
    switch (compression) {
        case Imf::NO_COMPRESSION:
            return {1, 1};
        case Imf::RLE_COMPRESSION:
        case Imf::ZIPS_COMPRESSION:
            return {kMostBytesPerByte, 1};
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return {kMostBytesPerByte, 16};
        case Imf::DWAB_COMPRESSION:
            return {kNoBound, 256};
        case Imf::DWAA_COMPRESSION:
            return {kNoBound, 32};
        default:  // PIZ and B44
            return {kMostBytesPerByte, 32};
    }
}

// Sizes, before the library takes memory for tables and buffers of them.
void checkPart(const Imf::Header& header, bool tiled, size_t fileBytes, uint64_t mostPixels) {
    const auto& window = header.dataWindow();
    const auto width = static_cast<int64_t>(window.max.x) - window.min.x + 1;
    const auto height = static_cast<int64_t>(window.max.y) - window.min.y + 1;
    if (width <= 0 || height <= 0) throw CodecError("the EXR file is damaged (no pixels)");
    double pixelBytes = 0;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
        pixelBytes += channel.channel().type == Imf::HALF ? 2 : 4;
    const ChunkShape shape = chunkShape(header.compression());
    checkDeclaredSize(static_cast<uint64_t>(width), static_cast<uint64_t>(height), fileBytes,
                      shape.bytesPerByte / std::max(pixelBytes, 1.0), mostPixels);
    double chunkBytes = pixelBytes * static_cast<double>(width) * shape.rows;
    double chunks = std::ceil(static_cast<double>(height) / shape.rows);
    if (tiled) {
        const Imf::TileDescription& tile = header.tileDescription();
        if (tile.xSize == 0 || tile.ySize == 0)
            throw CodecError("the EXR file is damaged (tiles of no size)");
        chunkBytes = pixelBytes * std::max<double>(static_cast<double>(width), tile.xSize) * tile.ySize;
        chunks = std::ceil(static_cast<double>(width) / tile.xSize) *
                 std::ceil(static_cast<double>(height) / tile.ySize);
    }
    if (header.hasChunkCount()) chunks = std::max<double>(chunks, header.chunkCount());
    if (chunkBytes > kMostChunkBytes) throw CodecError("the EXR file has blocks of more than 512 MiB");
    // A table at the start has the offset of each chunk.
    if (chunks * sizeof(uint64_t) > static_cast<double>(fileBytes)) throw CodecError("the file is truncated");
}

void checkHeaders(ByteView file, uint64_t mostPixels) {
    uint32_t version = 0;
    if (file.size() <= kFirstHeader) throw CodecError("the file is truncated");
    std::memcpy(&version, file.data() + 4, sizeof(version));
    const int flags = static_cast<int>(version);
    if (Imf::isNonImage(flags)) throw CodecError("EXR files with deep pixels are not supported");
    checkAttributes(file, Imf::isMultiPart(flags));
    MemoryReader stream(file);
    stream.seekg(kFirstHeader);
    do {
        Imf::Header header;
        int part = flags;
        header.readFrom(stream, part);
        if (header.readsNothing()) break;
        const bool tiled = Imf::isTiled(flags) || (header.hasType() && header.type() == Imf::TILEDIMAGE);
        checkPart(header, tiled, file.size(), mostPixels);
    } while (Imf::isMultiPart(flags));
}

// The channels of the file that become those of the image.
std::vector<std::string> chooseChannels(const Imf::Header& header) {
    const Imf::ChannelList& list = header.channels();
    std::vector<std::string> names;
    bool oneLayer = true;
    const auto layerOf = [](const std::string& name) {
        const size_t dot = name.rfind('.');
        return name.substr(0, dot == std::string::npos ? 0 : dot);
    };
    for (auto channel = list.begin(); channel != list.end(); ++channel) {
        if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
            throw CodecError("EXR files with subsampled channels are not supported");
        names.emplace_back(channel.name());
        oneLayer = oneLayer && layerOf(names.back()) == layerOf(names.front());
    }
    // The channel of this letter, in the only layer or without one; empty if there is none.
    const std::string layer = oneLayer && !names.empty() ? layerOf(names.front()) : "";
    const auto find = [&](const char* letter) {
        const std::string wanted = layer.empty() ? letter : layer + "." + letter;
        for (const std::string& name : names)
            if (::strcasecmp(name.c_str(), wanted.c_str()) == 0) return name;
        return std::string();
    };
    const std::string r = find("R"), g = find("G"), b = find("B"), y = find("Y"), a = find("A");
    if (!r.empty() && !g.empty() && !b.empty())
        return a.empty() ? std::vector{r, g, b} : std::vector{r, g, b, a};
    if (!y.empty() && (layer.empty() || find("X").empty()))
        return a.empty() ? std::vector{y} : std::vector<std::string>{y, "", "", a};
    // Sorted by name, which is the order X, Y, Z and U, V.
    if (oneLayer && (names.size() == 1 || names.size() == 3)) return names;
    throw CodecError("the EXR file has neither R, G, B nor Y, and more than one layer (channels " +
                     joined(names).substr(0, 500) + ")");
}

Image readPart(Imf::InputPart& part, const Context& context) {
    const Imf::Header& header = part.header();
    if (header.hasType() && Imf::isDeepData(header.type()))
        throw CodecError("EXR files with deep pixels are not supported");
    const std::vector<std::string> names = chooseChannels(header);
    const auto& window = header.dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    const size_t channels = names.size();
    RowCollector rows(context, width, height, static_cast<int>(channels));
    const size_t xStride = channels * sizeof(float), yStride = xStride * static_cast<size_t>(width);
    Imf::FrameBuffer target;
    for (size_t c = 0; c < channels; ++c) {
        // Addresses are counted from pixel 0, 0, which may lie outside.
        const auto first = reinterpret_cast<intptr_t>(rows.next(0) + c);
        const auto origin = first - window.min.x * static_cast<intptr_t>(xStride) -
                            window.min.y * static_cast<intptr_t>(yStride);
        if (!names[c].empty())
            target.insert(names[c],
                          Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(origin), xStride, yStride));
    }
    part.setFrameBuffer(target);
    const int band = header.hasTileDescription() ? static_cast<int>(header.tileDescription().ySize) : kBand;
    for (int y = 0; y < height; y += std::max(band, kBand)) {
        const int count = std::min(std::max(band, kBand), height - y);
        float* const samples = rows.next(count);
        part.readPixels(window.min.y + y, window.min.y + y + count - 1);
        if (channels != 4 || !names[1].empty()) continue;
        for (size_t i = 0; i < static_cast<size_t>(count) * static_cast<size_t>(width); ++i)
            samples[4 * i + 1] = samples[4 * i + 2] = samples[4 * i];
    }
    return rows.take();
}

class SinkStream : public Imf::OStream {
  public:
    explicit SinkStream(ByteSink& sink) : OStream("the file"), sink_(sink) {}

    // The library seeks back to fill in offsets that it learns late.
    void write(const char bytes[], int count) override {
        const ByteView view(reinterpret_cast<const uint8_t*>(bytes), static_cast<size_t>(count));
        try {
            sink_.write(view, position_);
        } catch (...) {
            // The library turns errors into others of its own, or drops them.
            if (!fault_) fault_ = std::current_exception();
            throw;
        }
        position_ += view.size();
    }
    void check() const {
        if (fault_) std::rethrow_exception(fault_);
    }
    uint64_t tellp() override { return position_; }
    void seekp(uint64_t position) override { position_ = position; }

  private:
    ByteSink& sink_;
    uint64_t position_ = 0;
    std::exception_ptr fault_;
};

// A channel of an EXR file, and of the image that holds its samples.
struct ExrChannel {
    std::string name;
    const Image* image;
    int index;
};

void appendExrChannels(const Layer& layer, bool withAlpha, std::vector<ExrChannel>& channels) {
    const int count = layer.image.channels;
    const auto add = [&](const std::string& name, int c) { channels.push_back({name, &layer.image, c}); };
    if (layer.name == "color") {
        const char* const names[] = {count == 1 ? "Y" : "R", "G", "B", "A"};
        for (int c = 0; c < (withAlpha ? count : std::min(count, 3)); ++c) add(names[c], c);
    } else if (layer.name == "alpha") {
        add("A", 0);
    } else {
        const char* const suffixes[] = {"Y", "UV", "XYZ"};  // for 1, 2 and 3 channels
        for (int c = 0; c < count; ++c) add(layer.name + "." + suffixes[count - 1][c], c);
    }
}

// The channels of an EXR that has all layers.
std::vector<ExrChannel> exrChannels(const std::vector<Layer>& layers) {
    const bool alphaIsLayer = findLayer(layers, "alpha") != nullptr;
    std::vector<ExrChannel> channels;
    for (const Layer& layer : layers) appendExrChannels(layer, !alphaIsLayer, channels);
    return channels;
}

class ExrRows : public RowEncoder {
  public:
    ExrRows(ByteSink& sink, int width, int height, const std::vector<Layer>& shape, const PictureNotes& notes)
        : width_(width), stream_(sink) {
        makePool();
        Imf::Header header(width, height);
        header.compression() = kCompression;
        for (const ExrChannel& channel : exrChannels(shape)) {
            if (channel.name.size() >= 256)
                throw CodecError("the layer name " + channel.name + " is too long for EXR");
            header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
        }
        for (const auto& [name, value] : notes) {
            if (const double* number = std::get_if<double>(&value))
                header.insert(name, Imf::DoubleAttribute(*number));
            else
                header.insert(name, Imf::StringAttribute(std::get<std::string>(value)));
        }
        encoding([&] { file_.emplace(stream_, header, 0); });
    }

    void add(const std::vector<Layer>& rows) override {
        const int count = rows.front().image.height;
        Imf::FrameBuffer source;
        for (const ExrChannel& channel : exrChannels(rows)) {
            const size_t xStride = static_cast<size_t>(channel.image->channels) * sizeof(float);
            const size_t yStride = xStride * static_cast<size_t>(width_);
            // The library stores row y of the image at base + y * stride.
            const auto first = reinterpret_cast<intptr_t>(channel.image->pixels.data() + channel.index);
            const auto base = first - written_ * static_cast<intptr_t>(yStride);
            source.insert(channel.name,
                          Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), xStride, yStride));
        }
        encoding([&] {
            file_->setFrameBuffer(source);
            file_->writePixels(count);
        });
        written_ += count;
    }

    void finish() override {
        encoding([&] { file_.reset(); });
    }

  private:
    template <typename Work>
    void encoding(const Work& work) {
        try {
            work();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& error) {
            stream_.check();
            throw CodecError(std::string("cannot encode EXR (") + error.what() + ")");
        }
        stream_.check();
    }

    int width_;
    int written_ = 0;  // rows
    SinkStream stream_;
    std::optional<Imf::OutputFile> file_;
};

}  // namespace

std::unique_ptr<RowEncoder> exrRows(ByteSink& sink, int width, int height, const std::vector<Layer>& shape,
                                    const PictureNotes& notes) {
    return std::make_unique<ExrRows>(sink, width, height, shape, notes);
}

Bytes encodeExr(const std::vector<Layer>& layers, const PictureNotes& notes) {
    MemorySink sink;
    ExrRows rows(sink, layers[0].image.width, layers[0].image.height, layers, notes);
    rows.add(layers);
    rows.finish();
    return std::move(sink.bytes);
}

Image decodeExr(ByteView file, uint64_t mostPixels, const Context& context) {
    try {
        makePool();
        checkHeaders(file, mostPixels);
        MemoryReader stream(file);
        Imf::MultiPartInputFile parts(stream, 0, false);
        Imf::InputPart part(parts, 0);
        return readPart(part, context);
    } catch (const CodecError&) {
        throw;
    } catch (const Cancelled&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw CodecError(std::string("the EXR file is truncated or damaged (") + error.what() + ")");
    }
}

}  // namespace glint
