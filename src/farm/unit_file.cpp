#include "farm/unit_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/text_file.h"
#include "farm/bytes.h"
#include "scene/limits.h"

namespace glint::farm {

void fields(auto& io, Is<std::pair<std::string, std::string>> auto& p) {
    io(p.first, p.second);
}
void fields(auto& io, Is<Region> auto& r) {
    io(r.x0, r.y0, r.x1, r.y1);
}
void fields(auto& io, Is<UnitHeader> auto& h) {
    io(h.identity.facts, h.region, h.aovs, h.parts);
}
void fields(auto& io, Is<Image> auto& i) {
    io(i.width, i.height, i.channels, i.pixels);
}
void fields(auto& io, Is<Layer> auto& l) {
    io(l.name, l.image);
}
void fields(auto& io, Is<Block> auto& b) {
    io(b.region, b.color, b.layers);
}
void fields(auto& io, Is<Producer> auto& p) {
    io(p.device, p.driver, p.sharesBits);
}
void fields(auto& io, Is<LostBranches> auto& l) {
    io(l.count, l.sum, l.greatest);
}
void fields(auto& io, Is<TreeLosses> auto& l) {
    io(l.cut, l.depth, l.room, l.crowdedMedia);
}
void fields(auto& io, Is<UnitResult> auto& u) {
    io(u.part, u.producer, u.notFinite, u.firstNotFinite.x, u.firstNotFinite.y, u.losses, u.blocks);
}

namespace {

namespace fs = std::filesystem;

// A byte beyond ASCII and line ends of both kinds, as PNG has them: a program that treats the file as text
// changes it. The last byte is the version of the format.
constexpr std::array<uint8_t, 16> kSignature = {0x89, 'g', 'l', 'i', 'n',  't',  ' ',  'u',
                                                'n',  'i', 't', 's', '\r', '\n', 0x1a, 3};
constexpr size_t kLength = sizeof(uint64_t), kHash = sizeof(uint64_t);

[[noreturn]] void damaged(const std::string& what) {
    throw std::runtime_error(what);
}

// Appends a record: length, bytes, hash of both.
template <typename T>
void putRecord(std::vector<uint8_t>& out, const T& value, size_t room = 0) {
    const size_t start = out.size();
    ByteWriter writer(std::move(out));
    writer.reserve(start + room);
    writer(uint64_t{0}, value);
    out = writer.take();
    const uint64_t length = out.size() - start - kLength;
    std::memcpy(&out[start], &length, kLength);
    const uint64_t hash = contentHash(std::span(out).subspan(start));
    out.resize(out.size() + kHash);
    std::memcpy(&out[out.size() - kHash], &hash, kHash);
}

// Reads a record. Throws std::out_of_range for one that is not all there.
template <typename T>
T getRecord(ByteReader& in) {
    ByteReader record(in.left());
    uint64_t length = 0, hash = 0;
    record(length);
    ByteReader payload(record.next(length));
    record(hash);
    if (contentHash(in.next(kLength + length)) != hash)
        damaged("a record does not have the hash that was written with it");
    in.next(kHash);
    T value;
    payload(value);
    if (!payload.left().empty()) damaged("a record is longer than what it holds");
    return value;
}

void checkRegion(const Region& r, const Region& whole) {
    if (r.x0 < whole.x0 || r.y0 < whole.y0 || r.x1 > whole.x1 || r.y1 > whole.y1 || r.x0 >= r.x1 ||
        r.y0 >= r.y1)
        damaged("a region lies outside the image");
}

void checkImage(const Image& image, const Region& region, int channels) {
    if (image.width != region.width() || image.height != region.height() || image.channels != channels ||
        image.pixels.size() != static_cast<uint64_t>(image.width) * image.height * channels)
        damaged("an image has another size than its region");
}

// Also for the start of a signature.
void checkSignature(std::span<const uint8_t> start) {
    if (!std::equal(start.begin(), start.end(), kSignature.begin()))
        damaged("glint render --part or --checkpoint did not write it");
}

UnitHeader getHeader(ByteReader& in) {
    checkSignature(in.left().first(std::min(in.left().size(), kSignature.size())));
    in.next(kSignature.size());
    auto header = getRecord<UnitHeader>(in);
    checkRegion(header.region, {0, 0, kMaxImageSize, kMaxImageSize});
    for (const Aov aov : header.aovs)
        if (static_cast<size_t>(aov) >= kEnumEntries<Aov>.size())
            damaged("it has a layer that this version does not know");
    if (header.parts < 1 || header.parts > kMostParts)
        damaged("its header names an image of " + std::to_string(header.parts) + " parts");
    return header;
}

UnitResult getUnit(ByteReader& in, const UnitHeader& header) {
    auto result = getRecord<UnitResult>(in);
    if (result.part < 1 || result.part > header.parts) damaged("a unit lies outside the image");
    const LayerShapes shapes = layerShapes(header.aovs);
    for (const Block& block : result.blocks) {
        checkRegion(block.region, header.region);
        checkImage(block.color, block.region, 4);
        if (block.layers.size() != shapes.size()) damaged("a unit has other layers than the image");
        for (size_t i = 0; i < shapes.size(); ++i)
            checkImage(block.layers[i].image, block.region, shapes[i].second);
    }
    return result;
}

// Names the damage in errors.
template <typename Read>
auto reading(const std::string& name, const Read& read) {
    try {
        return read();
    } catch (const std::out_of_range&) {
        throw Error(ErrorKind::Failed, name + ": damaged: it ends early");
    } catch (const std::runtime_error& error) {
        throw Error(ErrorKind::Failed, name + ": damaged: " + error.what());
    }
}

// A file of units; only one record at a time is in memory.
class RecordFile {
  public:
    explicit RecordFile(const fs::path& path) {
        std::error_code failed;
        if (fs::is_regular_file(path, failed)) in_.open(path, std::ios::binary);
        if (!in_.is_open()) {
            readWholeFile(path, {}, ErrorKind::Failed);  // throws with the reason
            throw Error(ErrorKind::Failed, path.string() + ": cannot read");
        }
        size_ = left_ = fs::file_size(path);
    }
    uint64_t size() const { return size_; }
    uint64_t left() const { return left_; }
    uint64_t at() const { return size_ - left_; }

    // Throws std::out_of_range if the file has fewer.
    void append(std::vector<uint8_t>& bytes, uint64_t count) {
        if (count > left_) throw std::out_of_range("bytes");
        const size_t start = bytes.size();
        bytes.resize(start + count);
        if (!in_.read(reinterpret_cast<char*>(bytes.data() + start), static_cast<std::streamsize>(count)))
            throw std::out_of_range("bytes");
        left_ -= count;
    }

    UnitHeader header() {
        std::vector<uint8_t> bytes;
        append(bytes, std::min<uint64_t>(kSignature.size(), left_));
        checkSignature(bytes);
        appendRecord(bytes);
        ByteReader in(bytes);
        return getHeader(in);
    }
    UnitResult unit(const UnitHeader& header) {
        std::vector<uint8_t> bytes;
        appendRecord(bytes);
        ByteReader in(bytes);
        return getUnit(in, header);
    }

  private:
    void appendRecord(std::vector<uint8_t>& bytes) {
        append(bytes, kLength);
        uint64_t length = 0;
        std::memcpy(&length, &bytes[bytes.size() - kLength], kLength);
        if (length > left_) throw std::out_of_range("record");
        append(bytes, length + kHash);
    }

    std::ifstream in_;
    uint64_t size_ = 0, left_ = 0;
};

// Growing by copying would take three times the memory.
size_t roomFor(const UnitResult& result) {
    size_t floats = 0;
    for (const Block& block : result.blocks) {
        floats += block.color.pixels.size();
        for (const Layer& layer : block.layers) floats += layer.image.pixels.size() + 64;
    }
    return floats * sizeof(float) + 64 * result.blocks.size() + 1024;
}

}  // namespace

std::vector<uint8_t> encodeHeader(const UnitHeader& header) {
    std::vector<uint8_t> out(kSignature.begin(), kSignature.end());
    putRecord(out, header);
    return out;
}

std::vector<uint8_t> encodeUnit(const UnitResult& result) {
    std::vector<uint8_t> out;
    putRecord(out, result, roomFor(result));
    return out;
}

UnitHeader decodeHeader(std::span<const uint8_t> bytes, const std::string& name) {
    return reading(name, [&] {
        ByteReader in(bytes);
        return getHeader(in);
    });
}

UnitResult decodeUnit(std::span<const uint8_t> bytes, const UnitHeader& header, const std::string& name) {
    return reading(name, [&] {
        ByteReader in(bytes);
        return getUnit(in, header);
    });
}

std::vector<uint8_t> encodePart(const UnitHeader& header, const UnitResult& result) {
    std::vector<uint8_t> out = encodeHeader(header);
    putRecord(out, result, roomFor(result));
    return out;
}

UnitResult readPart(const fs::path& path) {
    RecordFile file(path);
    return reading(path.string(), [&] {
        UnitResult result = file.unit(file.header());
        if (file.left() > 0) damaged("something follows its end");
        return result;
    });
}

PartOutline outlineOf(const fs::path& path) {
    RecordFile file(path);
    return reading(path.string(), [&] {
        PartOutline outline{file.header(), 0, file.size()};
        std::vector<uint8_t> start;
        file.append(start, kLength + sizeof(outline.part));  // the number is the first field
        std::memcpy(&outline.part, &start[kLength], sizeof(outline.part));
        if (outline.part < 1 || outline.part > outline.header.parts) damaged("there is no such part");
        return outline;
    });
}

uint64_t forEachUnit(const fs::path& path, const std::function<void(const UnitHeader&)>& begin,
                     const std::function<void(const UnitResult&)>& add) {
    RecordFile file(path);
    const UnitHeader header = reading(path.string(), [&] { return file.header(); });
    begin(header);
    while (true) {
        const uint64_t whole = file.at();
        std::optional<UnitResult> result;
        try {
            result = file.unit(header);
        } catch (const std::bad_alloc&) {
            throw;  // the rest of the file may be intact
        } catch (const std::exception&) {
            return whole;
        }
        add(*result);
    }
}

}  // namespace glint::farm
