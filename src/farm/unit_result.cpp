#include "farm/unit_result.h"

#include <utility>

namespace glint::farm {

namespace {

std::vector<Aov> withoutColor(const std::vector<Aov>& aovs) {
    std::vector<Aov> rest;
    for (const Aov aov : aovs)
        if (aov != Aov::Radiance && aov != Aov::Alpha) rest.push_back(aov);
    return rest;
}

double areaOf(const Region& region) {
    return static_cast<double>(region.width()) * region.height();
}

}  // namespace

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
    for (const Region& region : regions) all += areaOf(region);
    UnitResult result;
    for (const Region& region : regions) {
        Request request = whole;
        request.region = region;
        const double share = areaOf(region) / all, start = before / all;
        if (whole.progress)
            request.progress = [&whole, share, start](double done) { whole.progress(start + share * done); };
        Picture picture = draw(request);
        if (!picture.complete) return std::nullopt;
        if (picture.notFinite > 0 &&
            (result.notFinite == 0 || std::pair(picture.firstNotFinite.y, picture.firstNotFinite.x) <
                                          std::pair(result.firstNotFinite.y, result.firstNotFinite.x)))
            result.firstNotFinite = picture.firstNotFinite;
        result.notFinite += picture.notFinite;
        result.losses.add(picture.losses);
        blackenNotFinite(picture);
        std::vector<Layer> layers = makeLayers(picture, rest);
        result.blocks.push_back({region, std::move(picture.color), std::move(layers)});
        before += areaOf(region);
    }
    return result;
}

}  // namespace glint::farm
