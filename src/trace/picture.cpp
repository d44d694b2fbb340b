#include "trace/picture.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/error.h"

namespace glint {

namespace {

using Fill = std::function<void(const PixelData&, float*)>;
struct Aov {
    std::string name;
    int channels;
    Fill fill;
};

float index(uint32_t value) {
    return value == PixelData::kNoIndex ? -1.0f : static_cast<float>(value);
}

void fillVector(const glm::vec3& v, float* out) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

const std::vector<Aov>& dataAovs() {
    static const std::vector<Aov> aovs = {
        {"depth", 1, [](const PixelData& p, float* out) { *out = static_cast<float>(p.depth); }},
        {"position", 3, [](const PixelData& p, float* out) { fillVector(glm::vec3(p.position), out); }},
        {"normal", 3, [](const PixelData& p, float* out) { fillVector(p.normal, out); }},
        {"uv", 2,
         [](const PixelData& p, float* out) {
             out[0] = p.u;
             out[1] = p.v;
         }},
        {"object", 1, [](const PixelData& p, float* out) { *out = index(p.object); }},
        {"primitive", 1, [](const PixelData& p, float* out) { *out = index(p.primitive); }},
        {"material", 1, [](const PixelData& p, float* out) { *out = index(p.material); }},
        {"bounces", 1, [](const PixelData& p, float* out) { *out = static_cast<float>(p.bounces); }},
        {"cost", 1, [](const PixelData& p, float* out) { *out = static_cast<float>(p.cost); }}};
    return aovs;
}

Image colorChannels(const Picture& picture, int first, int count) {
    Image image(picture.color.width, picture.color.height, count);
    const size_t pixels = image.pixels.size() / count;
    for (size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < count; ++c) image.pixels[i * count + c] = picture.color.pixels[i * 4 + first + c];
    }
    return image;
}

bool isFinite(const float* color) {
    return std::isfinite(color[0]) && std::isfinite(color[1]) && std::isfinite(color[2]);
}

}  // namespace

void Picture::checkFinite(int x, int y) {
    if (isFinite(&color.pixels[indexOf(x, y) * 4])) return;
    const bool first = notFinite++ == 0;
    if (first || std::pair(y, x) < std::pair(firstNotFinite.y, firstNotFinite.x)) firstNotFinite = {x, y};
}

void blackenNotFinite(Picture& picture) {
    for (size_t i = 0; i < picture.color.pixels.size(); i += 4) {
        float* color = &picture.color.pixels[i];
        if (!isFinite(color)) std::fill_n(color, 3, 0.0f);
    }
}

const std::vector<std::string>& aovNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list = {"color", "alpha"};
        for (const Aov& aov : dataAovs()) list.push_back(aov.name);
        return list;
    }();
    return names;
}

std::vector<Layer> makeLayers(const Picture& picture, const std::vector<std::string>& names) {
    std::vector<Layer> layers;
    for (const std::string& name : names) {
        if (name == "color") {
            layers.push_back({name, colorChannels(picture, 0, 3)});
            continue;
        }
        if (name == "alpha") {
            layers.push_back({name, colorChannels(picture, 3, 1)});
            continue;
        }
        const auto& aovs = dataAovs();
        const auto aov = std::find_if(aovs.begin(), aovs.end(), [&](const Aov& a) { return a.name == name; });
        if (aov == aovs.end()) {
            std::string known;
            for (const std::string& n : aovNames()) known += (known.empty() ? "" : " ") + n;
            throw Error(ErrorKind::Argument, "--aov: unknown layer \"" + name + "\" (known: " + known + ")");
        }
        Image image(picture.region.width(), picture.region.height(), aov->channels);
        for (size_t i = 0; i < picture.data.size(); ++i)
            aov->fill(picture.data[i], &image.pixels[i * aov->channels]);
        layers.push_back({name, std::move(image)});
    }
    return layers;
}

}  // namespace glint
