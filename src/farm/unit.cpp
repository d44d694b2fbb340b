#include "farm/unit.h"

#include <algorithm>

namespace glint::farm {

namespace {

using Fact = std::pair<std::string, std::string>;

const std::string* valueOf(const Identity& identity, const std::string& name) {
    const auto found = std::find_if(identity.facts.begin(), identity.facts.end(),
                                    [&](const Fact& fact) { return fact.first == name; });
    return found == identity.facts.end() ? nullptr : &found->second;
}

bool isHash(const std::string& name) {
    return name.starts_with("file ") || name == "cut";
}

std::string textOf(const Fact& there, const std::string& here) {
    if (there.first == "cut") return "the image is cut at other places there";
    if (isHash(there.first)) return there.first + " has other contents there";
    return there.first + " is " + there.second + " there and " + here + " here";
}

std::vector<Aov> withoutColor(const std::vector<Aov>& aovs) {
    std::vector<Aov> rest;
    for (const Aov aov : aovs)
        if (aov != Aov::Radiance && aov != Aov::Alpha) rest.push_back(aov);
    return rest;
}

}  // namespace

std::string difference(const Identity& there, const Identity& here) {
    for (const Fact& fact : there.facts) {
        const std::string* mine = valueOf(here, fact.first);
        if (!mine)
            return fact.first + (isHash(fact.first) ? " is used there alone" : " is given there alone");
        if (*mine != fact.second) return textOf(fact, *mine);
    }
    for (const auto& [name, value] : here.facts)
        if (!valueOf(there, name))
            return name + (isHash(name) ? " is used here alone" : " is given here alone");
    return there == here ? "" : "the same facts in another order";
}

LayerShapes layerShapes(const std::vector<Aov>& aovs) {
    LayerShapes shapes;
    for (const Layer& layer : makeLayers(Picture(), withoutColor(aovs)))
        shapes.emplace_back(layer.name, layer.image.channels);
    return shapes;
}

std::optional<UnitResult> drawUnit(const Draw& draw, const Request& whole, const std::vector<Region>& regions,
                                   const std::vector<Aov>& aovs) {
    const std::vector<Aov> rest = withoutColor(aovs);
    double all = 0, before = 0;
    for (const Region& region : regions) all += static_cast<double>(region.pixels());
    UnitResult result;
    for (const Region& region : regions) {
        Request request = whole;
        request.region = region;
        const double share = static_cast<double>(region.pixels()) / all, start = before;
        if (whole.progress)
            request.progress = [&whole, share, start](double done) { whole.progress(start + share * done); };
        Picture picture = draw(request);
        if (!picture.complete) return std::nullopt;
        result.add(picture);
        blackenNotFinite(picture);
        std::vector<Layer> layers = makeLayers(picture, rest);
        result.blocks.push_back({region, std::move(picture.color), std::move(layers)});
        before += share;
    }
    return result;
}

}  // namespace glint::farm
