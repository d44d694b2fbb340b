#include "farm/merge.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.h"

namespace glint::farm {

namespace {

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::Failed, what);
}

// The rows of `part` go to their places in `whole`.
void paste(const Image& part, const Region& region, Image& whole, const Region& all) {
    const auto row = static_cast<std::ptrdiff_t>(region.width()) * whole.channels;
    for (int y = region.y0; y < region.y1; ++y) {
        const auto from = part.pixels.begin() + row * (y - region.y0);
        const size_t to =
            (static_cast<size_t>(y - all.y0) * all.width() + (region.x0 - all.x0)) * whole.channels;
        std::copy(from, from + row, whole.pixels.begin() + static_cast<std::ptrdiff_t>(to));
    }
}

std::vector<int> missingParts(const std::map<int, std::filesystem::path>& there, int parts) {
    std::vector<int> missing;
    for (int part = 1; part <= parts; ++part)
        if (!there.contains(part)) missing.push_back(part);
    return missing;
}

}  // namespace

Assembly::Assembly(const Region& whole, const std::vector<Aov>& aovs) : aovs_(aovs) {
    picture_.region = whole;
    picture_.color = Image(whole.width(), whole.height(), 4);
    picture_.done.assign(static_cast<size_t>(whole.width()) * whole.height(), 0);
    missing_ = picture_.done.size();
    picture_.complete = missing_ == 0;
    for (const auto& [name, channels] : layerShapes(aovs))
        layers_.push_back({name, Image(whole.width(), whole.height(), channels)});
}

double Assembly::share() const {
    const auto all = static_cast<double>(picture_.done.size());
    return all > 0 ? (all - static_cast<double>(missing_)) / all : 1;
}

void Assembly::add(const UnitResult& result) {
    for (const Block& block : result.blocks) {
        const Region& r = block.region;
        for (int y = r.y0; y < r.y1; ++y) {
            const auto first = picture_.done.begin() + static_cast<std::ptrdiff_t>(picture_.indexOf(r.x0, y));
            if (std::find(first, first + r.width(), uint8_t{1}) != first + r.width())
                fail(nameOf(result.unit) + " has pixels that another part has too");
            std::fill_n(first, r.width(), uint8_t{1});
        }
        missing_ -= static_cast<uint64_t>(r.width()) * static_cast<uint64_t>(r.height());
        paste(block.color, r, picture_.color, picture_.region);
        for (size_t i = 0; i < layers_.size(); ++i)
            paste(block.layers[i].image, r, layers_[i].image, picture_.region);
    }
    picture_.complete = complete();
    picture_.losses.add(result.losses);
    if (result.notFinite == 0) return;
    const glm::ivec2& first = result.firstNotFinite;
    if (picture_.notFinite == 0 ||
        std::pair(first.y, first.x) < std::pair(picture_.firstNotFinite.y, picture_.firstNotFinite.x))
        picture_.firstNotFinite = first;
    picture_.notFinite += result.notFinite;
}

std::vector<Layer> Assembly::takeLayers() {
    std::vector<Layer> layers;
    auto next = layers_.begin();
    for (const Aov aov : aovs_) {
        if (aov == Aov::Radiance || aov == Aov::Alpha)
            layers.push_back(std::move(makeLayers(picture_, std::span(&aov, 1)).front()));
        else
            layers.push_back(std::move(*next++));
    }
    return layers;
}

Merged mergeParts(const std::vector<std::filesystem::path>& files,
                  const std::function<void(const UnitHeader&)>& room) {
    Merged merged;
    std::optional<Assembly> assembly;
    std::map<int, std::filesystem::path> there;
    for (const std::filesystem::path& path : files) {
        const UnitFile file = readUnits(path);
        const UnitHeader& header = file.header;
        if (!assembly) {
            room(header);
            merged.header = header;
            assembly.emplace(header.region, header.aovs);
        }
        const std::string other = difference(header.identity, merged.header.identity);
        if (!other.empty())
            fail(path.string() + ": belongs to another picture than " + files.front().string() + ": " +
                 other);
        for (const UnitResult& result : file.results) {
            const auto [known, isNew] = there.emplace(result.unit.part, path);
            if (!isNew)
                fail(path.string() + ": holds " + nameOf(result.unit) + ", which " +
                     (known->second == path ? "it" : known->second.string()) + " holds already");
            assembly->add(result);
            if (std::find(merged.producers.begin(), merged.producers.end(), result.producer) ==
                merged.producers.end())
                merged.producers.push_back(result.producer);
        }
    }
    const int parts = merged.header.parts;
    const std::vector<int> missing = missingParts(there, parts);
    if (!missing.empty())
        fail(namesOfParts(missing, parts) + (missing.size() > 1 ? " are" : " is") + " missing");
    if (!assembly->complete()) fail("the parts leave some of the picture's pixels out");
    merged.layers = assembly->takeLayers();
    merged.picture = assembly->picture();
    return merged;
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
