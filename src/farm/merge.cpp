#include "farm/merge.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/device_layout.h"
#include "core/error.h"

namespace glint::farm {

namespace {

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::Failed, what);
}

constexpr int kStripRows = shared::kTileSize;

// Row `y` of `from`, which is that of a picture, goes to its place in `to`.
void pasteRow(const Image& from, const Region& part, int y, Image& to, const Region& strip) {
    const auto row = static_cast<std::ptrdiff_t>(part.width()) * to.channels;
    const auto first = from.pixels.begin() + row * (y - part.y0);
    const size_t place =
        (static_cast<size_t>(y - strip.y0) * strip.width() + (part.x0 - strip.x0)) * to.channels;
    std::copy(first, first + row, to.pixels.begin() + static_cast<std::ptrdiff_t>(place));
}

// Appends below the rows that are there already.
void append(Image& to, Image&& rows) {
    to.pixels.insert(to.pixels.end(), rows.pixels.begin(), rows.pixels.end());
    to.height += rows.height;
    rows.pixels = {};
}

std::vector<int> missingParts(const std::map<int, std::filesystem::path>& there, int parts) {
    std::vector<int> missing;
    for (int part = 1; part <= parts; ++part)
        if (!there.contains(part)) missing.push_back(part);
    return missing;
}

// The file of each part of one picture.
std::map<int, std::filesystem::path> filesOfParts(const std::vector<std::filesystem::path>& files,
                                                  UnitHeader& header, uint64_t& largest) {
    std::map<int, std::filesystem::path> there;
    for (const std::filesystem::path& path : files) {
        const PartOutline outline = outlineOf(path);
        largest = std::max(largest, outline.bytes);
        if (there.empty()) header = outline.header;
        const std::string other = difference(outline.header.identity, header.identity);
        if (!other.empty())
            fail(path.string() + ": comes from another render than " + files.front().string() + ": " + other);
        const auto [known, isNew] = there.emplace(outline.part, path);
        if (!isNew)
            fail(path.string() + ": holds " + namesOfParts({outline.part}, header.parts) + ", which " +
                 (known->second == path ? "it" : known->second.string()) + " holds already");
    }
    const std::vector<int> missing = missingParts(there, header.parts);
    if (!missing.empty())
        fail(namesOfParts(missing, header.parts) + (missing.size() > 1 ? " are" : " is") + " missing");
    return there;
}

}  // namespace

Assembly::Assembly(const Region& whole, const std::vector<Aov>& aovs)
    : whole_(whole), aovs_(aovs), shapes_(layerShapes(aovs)), missing_(whole.pixels()) {}

double Assembly::share() const {
    const auto all = static_cast<double>(whole_.pixels());
    return all > 0 ? (all - static_cast<double>(missing_)) / all : 1;
}

Region Assembly::regionOf(int strip) const {
    const int y0 = whole_.y0 + strip * kStripRows;
    return {whole_.x0, y0, whole_.x1, std::min(y0 + kStripRows, whole_.y1)};
}

Assembly::Strip& Assembly::stripOf(int y) {
    const int index = (y - whole_.y0) / kStripRows;
    const auto [found, isNew] = strips_.try_emplace(index);
    Strip& strip = found->second;
    if (!isNew) return strip;
    const Region region = regionOf(index);
    strip.color = Image(region.width(), region.height(), 4);
    strip.missing = region.pixels();
    strip.done.assign(strip.missing, 0);
    for (const auto& [name, channels] : shapes_)
        strip.layers.push_back({name, Image(region.width(), region.height(), channels)});
    return strip;
}

void Assembly::addRow(const Block& block, int y, int part) {
    const Region& r = block.region;
    const Region strip = regionOf((y - whole_.y0) / kStripRows);
    const bool taken = y < whole_.y0 + taken_ * kStripRows;
    if (!taken) {
        Strip& to = stripOf(y);
        const auto first =
            to.done.begin() + static_cast<std::ptrdiff_t>(y - strip.y0) * strip.width() + (r.x0 - strip.x0);
        if (std::find(first, first + r.width(), uint8_t{1}) == first + r.width()) {
            std::fill_n(first, r.width(), uint8_t{1});
            to.missing -= static_cast<uint64_t>(r.width());
            missing_ -= static_cast<uint64_t>(r.width());
            pasteRow(block.color, r, y, to.color, strip);
            for (size_t i = 0; i < to.layers.size(); ++i)
                pasteRow(block.layers[i].image, r, y, to.layers[i].image, strip);
            return;
        }
    }
    fail("part " + std::to_string(part) + " has pixels that another part has too");
}

void Assembly::add(const UnitResult& result) {
    for (const Block& block : result.blocks)
        for (int y = block.region.y0; y < block.region.y1; ++y) addRow(block, y, result.part);
    flaws_.add(result);
    if (std::find(producers_.begin(), producers_.end(), result.producer) == producers_.end())
        producers_.push_back(result.producer);
}

Rows Assembly::take() {
    Rows rows;
    Region& region = rows.picture.region;
    region = regionOf(taken_);
    region.y1 = region.y0;
    rows.picture.color = Image(region.width(), 0, 4);
    std::vector<Layer> layers;
    for (const auto& [name, channels] : shapes_) layers.push_back({name, Image(region.width(), 0, channels)});
    while (!strips_.empty() && strips_.begin()->first == taken_ && strips_.begin()->second.missing == 0) {
        Strip& strip = strips_.begin()->second;
        append(rows.picture.color, std::move(strip.color));
        for (size_t i = 0; i < layers.size(); ++i) append(layers[i].image, std::move(strip.layers[i].image));
        strips_.erase(strips_.begin());
        region.y1 = regionOf(taken_++).y1;
    }
    rows.picture.done.assign(region.pixels(), 1);
    auto next = layers.begin();
    for (const Aov aov : aovs_) {
        if (aov == Aov::Radiance || aov == Aov::Alpha)
            rows.layers.push_back(std::move(makeLayers(rows.picture, std::span(&aov, 1)).front()));
        else
            rows.layers.push_back(std::move(*next++));
    }
    return rows;
}

void mergeParts(const std::vector<std::filesystem::path>& files,
                const std::function<void(const UnitHeader&, uint64_t largest)>& begin,
                const std::function<void(const UnitResult&)>& add) {
    UnitHeader header;
    uint64_t largest = 0;
    const auto parts = filesOfParts(files, header, largest);
    begin(header, largest);
    for (const auto& [part, path] : parts) add(readPart(path));
}

std::string namesOfParts(const std::vector<int>& parts, int of) {
    std::string text;
    for (size_t first = 0; first < parts.size();) {
        size_t last = first;
        while (last + 1 < parts.size() && parts[last + 1] == parts[last] + 1) ++last;
        text += (text.empty() ? "" : ", ") + std::to_string(parts[first]);
        if (last > first) text += (last > first + 1 ? " to " : ", ") + std::to_string(parts[last]);
        first = last + 1;
    }
    return (parts.size() > 1 ? "parts " : "part ") + text + " of " + std::to_string(of);
}

}  // namespace glint::farm
