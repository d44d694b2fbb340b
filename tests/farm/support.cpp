#include "support.h"

#include <sstream>

#include "farm/cut.h"
#include "import/load.h"
#include "pack/pack_samples.h"
#include "reference/render.h"

namespace glint::farm::test {

const LoadedScene& uneven() {
    static const LoadedScene loaded = [] {
        std::ostringstream text;
        text << R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}, "background": [0.1, 0.2, 0.4],
            "lights": [{"type": "point", "position": [1, 6, 4]}],
            "materials": {"mirror": {"diffuse": 0.2, "mirror": 0.7}}, "objects": [)";
        for (int i = 0; i < 60; ++i)
            text << (i ? "," : "")
                 << R"({"type": "sphere", "material": "mirror", "radius": 0.12, "center": [)"
                 << -2.2 + 0.2 * (i % 10) << ',' << -1.6 + 0.2 * (i / 10) << ',' << 0.1 * (i % 3) << "]}";
        text << "]}";
        LoadedScene made;
        made.scene = parseScene(text.str(), "uneven.json", ".");
        made.packed = packScene(made.scene);
        return made;
    }();
    return loaded;
}

Request requestFor(int width, int height) {
    ImageSettings image;
    image.width = width;
    image.height = height;
    image.samplesPerPixel = 4;
    return glint::requestOf(image, uneven().scene.camera);
}

Picture draw(const Request& request) {
    return reference::render(uneven().packed, request);
}

std::vector<UnitResult> partsOf(const Request& request, int parts, const std::vector<Aov>& aovs, bool even) {
    const LoadedScene& loaded = uneven();
    const CostMap map = even ? CostMap(regionOf(request)) : estimateCosts(loaded.packed, request, parts);
    std::vector<UnitResult> results;
    for (const auto& regions : cutPicture(map, parts)) {
        results.push_back(drawUnit(draw, request, regions, aovs).value());
        results.back().part = static_cast<int>(results.size());
        results.back().producer = {"reference", "", false};
    }
    return results;
}

UnitFile readUnits(const std::filesystem::path& path) {
    UnitFile file;
    file.wholeBytes = forEachUnit(
        path, [&](const UnitHeader& header) { file.header = header; },
        [&](const UnitResult& result) { file.results.push_back(result); });
    return file;
}

UnitHeader headerOf(const Request& request, int parts, const std::vector<Aov>& aovs) {
    return {{{{"scene", "uneven.json"}, {"size", std::to_string(request.width)}}},
            regionOf(request),
            aovs,
            parts};
}

}  // namespace glint::farm::test
