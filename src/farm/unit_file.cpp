#include "farm/unit_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <utility>

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
                                                'n',  'i', 't', 's', '\r', '\n', 0x1a, 2};

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

constexpr uint64_t kRecordHead = sizeof(uint32_t) + sizeof(uint64_t), kHash = sizeof(uint64_t);

// The payload is what `write` puts.
template <typename Write>
void putRecord(ByteWriter& out, Kind kind, const Write& write) {
    const size_t start = out.size();
    out.put(static_cast<uint32_t>(kind));
    out.put(uint64_t{0});
    write();
    out.replace(start + sizeof(uint32_t), static_cast<uint64_t>(out.size() - start - kRecordHead));
    out.put(contentHash(out.from(start)));
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

void putHeader(ByteWriter& out, const UnitHeader& header) {
    out.raw(kSignature.data(), kSignature.size());
    putRecord(out, Kind::Head, [&] {
        out.put(static_cast<uint32_t>(header.identity.facts.size()));
        for (const auto& [name, value] : header.identity.facts) {
            out.put(name);
            out.put(value);
        }
        putRegion(out, header.region);
        out.put(static_cast<uint32_t>(header.aovs.size()));
        for (const Aov aov : header.aovs) out.put(std::string(nameOf(aov)));
        out.put(static_cast<int32_t>(header.parts));
    });
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

void putUnit(ByteWriter& out, const UnitResult& result) {
    out.put(static_cast<int32_t>(result.part));
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
}

// Its samples, and enough for what stands beside them: growing by copying would take three times the memory.
size_t roomFor(const UnitResult& result) {
    size_t floats = 0;
    for (const Block& block : result.blocks) {
        floats += block.color.pixels.size();
        for (const Layer& layer : block.layers) floats += layer.image.pixels.size();
    }
    return floats * sizeof(float) + 1024;
}

void putUnits(ByteWriter& out, std::span<const UnitResult> results) {
    size_t room = 0;
    for (const UnitResult& result : results) room += roomFor(result);
    out.reserve(out.size() + room);
    for (const UnitResult& result : results) putRecord(out, Kind::Unit, [&] { putUnit(out, result); });
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
    result.part = in.get<int32_t>();
    if (result.part < 1 || result.part > header.parts) damaged("a unit is no part of the picture");
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

}  // namespace

std::vector<uint8_t> encodeHeader(const UnitHeader& header) {
    ByteWriter out;
    putHeader(out, header);
    return out.take();
}

std::vector<uint8_t> encodeUnit(const UnitResult& result) {
    ByteWriter out;
    putUnits(out, {&result, 1});
    return out.take();
}

std::vector<uint8_t> encodeUnits(const UnitHeader& header, std::span<const UnitResult> results) {
    ByteWriter out;
    putHeader(out, header);
    putUnits(out, results);
    putRecord(out, Kind::Done, [&] { out.put(static_cast<uint64_t>(results.size())); });
    return out.take();
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

namespace {

// A file's records, of which one at a time is in memory.
class RecordFile {
  public:
    explicit RecordFile(const fs::path& path)
        : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
        struct stat status {};
        if (!file_.isOpen() || ::fstat(file_.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
            readFile(path);  // says what is wrong
            throw Error(ErrorKind::Failed, path.string() + ": cannot read");
        }
        size_ = static_cast<uint64_t>(status.st_size);
    }
    uint64_t size() const { return size_; }
    uint64_t at() const { return at_; }
    uint64_t left() const { return size_ - at_; }
    void skip(uint64_t count) {
        if (count > left()) throw std::out_of_range("bytes");
        at_ += count;
    }

    // Throws std::out_of_range where the file has fewer.
    std::vector<uint8_t> next(uint64_t count) {
        const uint64_t from = at_;
        skip(count);
        std::vector<uint8_t> read(count);
        for (uint64_t done = 0; done < count;) {
            const ssize_t got =
                ::pread(file_.get(), read.data() + done, count - done, static_cast<off_t>(from + done));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) throw std::out_of_range("bytes");
            done += static_cast<uint64_t>(got);
        }
        return read;
    }

    // Reads the signature before the records.
    void open() { opened(next(std::min<uint64_t>(kSignature.size(), left()))); }
    // The whole record that begins here.
    std::vector<uint8_t> nextRecord() {
        const uint64_t from = at_;
        const std::vector<uint8_t> head = next(kRecordHead);
        at_ = from;
        ByteReader in(head);
        in.get<uint32_t>();
        const auto payload = in.get<uint64_t>();
        if (payload > left()) throw std::out_of_range("record");
        return next(kRecordHead + payload + kHash);
    }

  private:
    Descriptor file_;
    uint64_t size_ = 0, at_ = 0;
};

UnitHeader headerIn(RecordFile& file) {
    file.open();
    const std::vector<uint8_t> record = file.nextRecord();
    ByteReader in(record);
    return nextHeader(in);
}

// The next unit; nothing after the last one.
std::optional<UnitResult> nextUnit(RecordFile& file, const UnitHeader& header, uint64_t units) {
    const std::vector<uint8_t> bytes = file.nextRecord();
    ByteReader in(bytes);
    const Record record = nextRecord(in);
    if (record.kind == Kind::Unit) return unitOf(record.payload, header);
    if (record.kind != Kind::Done) damaged("it has a record of an unknown kind");
    if (ByteReader(record.payload).get<uint64_t>() != units) throw std::out_of_range("units");
    if (file.left() > 0) damaged("something follows its end");
    return std::nullopt;
}

}  // namespace

UnitOutline outlineOf(const fs::path& path) {
    RecordFile file(path);
    return reading(path.string(), [&] {
        UnitOutline outline;
        outline.bytes = file.size();
        outline.header = headerIn(file);
        while (file.left() > 0) {
            const std::vector<uint8_t> head = file.next(kRecordHead);
            ByteReader in(head);
            const auto kind = static_cast<Kind>(in.get<uint32_t>());
            auto size = in.get<uint64_t>();
            if (kind == Kind::Unit) {
                const std::vector<uint8_t> part = file.next(sizeof(int32_t));
                size -= std::min<uint64_t>(size, part.size());
                outline.parts.push_back(ByteReader(part).get<int32_t>());
            }
            if (size > file.left()) throw std::out_of_range("record");
            file.skip(size + kHash);
        }
        return outline;
    });
}

UnitFileEnd forEachUnit(const fs::path& path, bool unfinished,
                        const std::function<void(const UnitHeader&)>& begin,
                        const std::function<void(UnitResult)>& add) {
    RecordFile file(path);
    const UnitHeader header = reading(path.string(), [&] { return headerIn(file); });
    begin(header);
    UnitFileEnd end;
    end.wholeBytes = file.at();
    for (uint64_t units = 0; !end.finished; ++units) {
        std::optional<UnitResult> result;
        try {
            if (unfinished && file.left() == 0) break;
            result = reading(path.string(), [&] { return nextUnit(file, header, units); });
        } catch (const Error&) {
            if (!unfinished) throw;
            break;
        }
        end.finished = !result;
        end.wholeBytes = file.at();
        if (result) add(std::move(*result));
    }
    return end;
}

}  // namespace glint::farm
