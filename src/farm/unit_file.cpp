#include "farm/unit_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/staged_file.h"
#include "farm/bytes.h"
#include "scene/limits.h"

namespace glint::farm {

namespace {

namespace fs = std::filesystem;

// A byte beyond ASCII and line ends of both kinds, as PNG has them: what treats the file as text is found
// out.
constexpr std::array<uint8_t, 16> kSignature = {0x89, 'g', 'l', 'i', 'n',  't',  ' ',  'u',
                                                'n',  'i', 't', 's', '\r', '\n', 0x1a, 1};

enum class Kind : uint32_t { Head = 0x44414548, Unit = 0x54494e55, Done = 0x454e4f44 };  // "HEAD" ...

[[noreturn]] void damaged(const std::string& what) {
    throw std::runtime_error(what);
}

void putRegion(ByteWriter& out, const Region& r) {
    for (const int32_t value : {r.x0, r.y0, r.x1, r.y1}) out.put(value);
}

// Within `whole`.
Region getRegion(ByteReader& in, const Region& whole) {
    Region r;
    for (int* value : {&r.x0, &r.y0, &r.x1, &r.y1}) *value = in.get<int32_t>();
    if (r.x0 < whole.x0 || r.y0 < whole.y0 || r.x1 > whole.x1 || r.y1 > whole.y1 || r.x0 >= r.x1 ||
        r.y0 >= r.y1)
        damaged("a region lies outside of the picture");
    return r;
}

void appendRecord(std::vector<uint8_t>& file, Kind kind, const std::vector<uint8_t>& payload) {
    ByteWriter record;
    record.put(static_cast<uint32_t>(kind));
    record.put(static_cast<uint64_t>(payload.size()));
    std::vector<uint8_t> bytes = record.take();
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    ByteWriter hash;
    hash.put(contentHash(bytes));
    const std::vector<uint8_t> check = hash.take();
    file.insert(file.end(), bytes.begin(), bytes.end());
    file.insert(file.end(), check.begin(), check.end());
}

struct Record {
    Kind kind;
    std::span<const uint8_t> payload;
};

// Throws std::out_of_range for a record that is not all there.
Record nextRecord(ByteReader& in) {
    const auto start = in.next(sizeof(uint32_t) + sizeof(uint64_t));
    ByteReader head(start);
    const auto kind = static_cast<Kind>(head.get<uint32_t>());
    const auto size = head.get<uint64_t>();
    if (size > in.left()) throw std::out_of_range("record");
    const auto payload = in.next(size);
    const auto hash = in.get<uint64_t>();
    if (contentHash(std::span(start.data(), start.size() + payload.size())) != hash)
        damaged("a record does not have the hash that was written with it");
    return {kind, payload};
}

std::vector<uint8_t> headPayload(const UnitHeader& header) {
    ByteWriter out;
    out.put(static_cast<uint32_t>(header.identity.facts.size()));
    for (const auto& [name, value] : header.identity.facts) {
        out.put(name);
        out.put(value);
    }
    putRegion(out, header.region);
    out.put(static_cast<uint32_t>(header.aovs.size()));
    for (const Aov aov : header.aovs) out.put(std::string(nameOf(aov)));
    out.put(static_cast<int32_t>(header.parts));
    return out.take();
}

UnitHeader headerOf(std::span<const uint8_t> payload) {
    ByteReader in(payload);
    UnitHeader header;
    for (auto left = in.get<uint32_t>(); left > 0; --left) {
        std::string name = in.text();
        header.identity.facts.emplace_back(std::move(name), in.text());
    }
    header.region = getRegion(in, {0, 0, kMaxImageSize, kMaxImageSize});
    for (auto left = in.get<uint32_t>(); left > 0; --left) {
        const auto aov = named<Aov>(in.text());
        if (!aov) damaged("it has a layer that this version does not know");
        header.aovs.push_back(*aov);
    }
    header.parts = in.get<int32_t>();
    if (header.parts < 1 || header.parts > kMostParts)
        damaged("it says that the picture has " + std::to_string(header.parts) + " parts");
    return header;
}

template <typename Out>
void putLosses(Out& out, const TreeLosses& losses) {
    for (const LostBranches& lost : {losses.cut, losses.depth, losses.room}) {
        out.put(lost.count);
        out.put(lost.sum);
        out.put(lost.greatest);
    }
    out.put(losses.crowdedMedia);
}

TreeLosses getLosses(ByteReader& in) {
    TreeLosses losses;
    for (LostBranches* lost : {&losses.cut, &losses.depth, &losses.room}) {
        lost->count = in.get<uint64_t>();
        lost->sum = in.get<double>();
        lost->greatest = in.get<double>();
    }
    losses.crowdedMedia = in.get<uint64_t>();
    return losses;
}

std::vector<uint8_t> unitPayload(const UnitResult& result) {
    ByteWriter out;
    for (const int32_t value : {result.unit.frame, result.unit.part, result.unit.parts}) out.put(value);
    out.put(result.producer.device);
    out.put(result.producer.driver);
    out.put(static_cast<uint8_t>(result.producer.sharesBits));
    out.put(result.notFinite);
    out.put(static_cast<int32_t>(result.firstNotFinite.x));
    out.put(static_cast<int32_t>(result.firstNotFinite.y));
    putLosses(out, result.losses);
    out.put(static_cast<uint32_t>(result.blocks.size()));
    for (const Block& block : result.blocks) {
        putRegion(out, block.region);
        out.put(block.color.pixels);
        for (const Layer& layer : block.layers) out.put(layer.image.pixels);
    }
    return out.take();
}

Image getImage(ByteReader& in, const Region& region, int channels) {
    Image image;
    image.width = region.width();
    image.height = region.height();
    image.channels = channels;
    image.pixels = in.floats(static_cast<uint64_t>(image.width) * image.height * channels);
    return image;
}

UnitResult unitOf(std::span<const uint8_t> payload, const UnitHeader& header) {
    ByteReader in(payload);
    UnitResult result;
    for (int* value : {&result.unit.frame, &result.unit.part, &result.unit.parts}) *value = in.get<int32_t>();
    if (result.unit.parts != header.parts || result.unit.part < 1 || result.unit.part > header.parts)
        damaged("a unit is no part of the picture");
    result.producer.device = in.text();
    result.producer.driver = in.text();
    result.producer.sharesBits = in.get<uint8_t>() != 0;
    result.notFinite = in.get<uint64_t>();
    result.firstNotFinite.x = in.get<int32_t>();
    result.firstNotFinite.y = in.get<int32_t>();
    result.losses = getLosses(in);
    const LayerShapes shapes = layerShapes(header.aovs);
    for (auto left = in.get<uint32_t>(); left > 0; --left) {
        Block block;
        block.region = getRegion(in, header.region);
        block.color = getImage(in, block.region, 4);
        for (const auto& [name, channels] : shapes)
            block.layers.push_back({name, getImage(in, block.region, channels)});
        result.blocks.push_back(std::move(block));
    }
    if (in.left() > 0) damaged("a unit is longer than what it holds");
    return result;
}

ByteReader opened(std::span<const uint8_t> bytes) {
    ByteReader in(bytes);
    const auto start = bytes.first(std::min(bytes.size(), kSignature.size()));
    if (!std::equal(start.begin(), start.end(), kSignature.begin()))
        damaged("it is no file that glint render --part or --checkpoint wrote");
    in.next(kSignature.size());
    return in;
}

void readRecords(ByteReader& in, bool unfinished, UnitFile& file) {
    const auto last = [&] { file.wholeBytes = in.at(); };
    last();
    while (in.left() > 0 && !file.finished) {
        try {
            const Record record = nextRecord(in);
            if (record.kind == Kind::Unit)
                file.results.push_back(unitOf(record.payload, file.header));
            else if (record.kind == Kind::Done)
                file.finished = ByteReader(record.payload).get<uint64_t>() == file.results.size();
            else
                damaged("it has a record of an unknown kind");
            last();
        } catch (const std::exception&) {
            if (!unfinished) throw;
            return;
        }
    }
    if (in.left() > 0) damaged("something follows its end");
    if (!file.finished && !unfinished) throw std::out_of_range("no end");
}

}  // namespace

std::vector<uint8_t> encodeHeader(const UnitHeader& header) {
    std::vector<uint8_t> file(kSignature.begin(), kSignature.end());
    appendRecord(file, Kind::Head, headPayload(header));
    return file;
}

std::vector<uint8_t> encodeUnit(const UnitResult& result) {
    std::vector<uint8_t> bytes;
    appendRecord(bytes, Kind::Unit, unitPayload(result));
    return bytes;
}

std::vector<uint8_t> encodeUnits(const UnitHeader& header, const std::vector<UnitResult>& results) {
    std::vector<uint8_t> file = encodeHeader(header);
    for (const UnitResult& result : results) appendRecord(file, Kind::Unit, unitPayload(result));
    ByteWriter done;
    done.put(static_cast<uint64_t>(results.size()));
    appendRecord(file, Kind::Done, done.take());
    return file;
}

namespace {

// Says in errors what is damaged.
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

UnitHeader nextHeader(ByteReader& in) {
    const Record head = nextRecord(in);
    if (head.kind != Kind::Head) damaged("it does not begin with its header");
    return headerOf(head.payload);
}

}  // namespace

UnitHeader decodeHeader(std::span<const uint8_t> bytes, const std::string& name) {
    return reading(name, [&] {
        ByteReader in = opened(bytes);
        return nextHeader(in);
    });
}

UnitResult decodeUnit(std::span<const uint8_t> bytes, const UnitHeader& header, const std::string& name) {
    return reading(name, [&] {
        ByteReader in(bytes);
        const Record record = nextRecord(in);
        if (record.kind != Kind::Unit) damaged("it is no unit");
        return unitOf(record.payload, header);
    });
}

UnitOutline outlineOf(const fs::path& path) {
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    struct stat status {};
    if (!file.isOpen() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
        readFile(path);  // says what is wrong
        throw Error(ErrorKind::Failed, path.string() + ": cannot read");
    }
    return reading(path.string(), [&] {
        UnitOutline outline;
        outline.bytes = static_cast<uint64_t>(status.st_size);
        uint64_t at = 0;
        const auto bytes = [&](uint64_t size) {
            if (size > outline.bytes - std::min(outline.bytes, at)) throw std::out_of_range("bytes");
            std::vector<uint8_t> read(size);
            if (::pread(file.get(), read.data(), size, static_cast<off_t>(at)) != static_cast<ssize_t>(size))
                throw std::out_of_range("bytes");
            return read;
        };
        constexpr uint64_t kRecordHead = sizeof(uint32_t) + sizeof(uint64_t), kHash = sizeof(uint64_t);
        for (bool first = true; at < outline.bytes; first = false) {
            const uint64_t start = first ? kSignature.size() : 0;
            const std::vector<uint8_t> head = bytes(std::min(start + kRecordHead, outline.bytes - at));
            ByteReader in = first ? opened(head) : ByteReader(head);
            const auto kind = static_cast<Kind>(in.get<uint32_t>());
            const auto size = in.get<uint64_t>();
            if (size > outline.bytes) throw std::out_of_range("record");
            const uint64_t whole = start + kRecordHead + size + kHash;
            if (first) outline.header = decodeHeader(bytes(whole), path.string());
            at += start + kRecordHead;
            if (kind == Kind::Unit) {
                const std::vector<uint8_t> numbers = bytes(3 * sizeof(int32_t));
                ByteReader unit(numbers);
                const auto frame = unit.get<int32_t>(), part = unit.get<int32_t>();
                outline.units.push_back({frame, part, unit.get<int32_t>()});
            }
            at += size + kHash;
        }
        if (at != outline.bytes) throw std::out_of_range("record");
        return outline;
    });
}

UnitFile readUnits(const fs::path& path, bool unfinished) {
    const std::vector<uint8_t> bytes = readFile(path);
    return reading(path.string(), [&] {
        ByteReader in = opened(bytes);
        UnitFile file;
        file.header = nextHeader(in);
        readRecords(in, unfinished, file);
        return file;
    });
}

}  // namespace glint::farm
