#include <algorithm>
#include <cmath>
#include <cstdint>

#include "reference/material.h"

namespace glint::reference {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

// The texel of an endless image that stands for number i of `size`.
int64_t wrapIndex(int64_t i, int64_t size, uint32_t wrap) {
    const auto modulo = [](int64_t a, int64_t b) { return (a % b + b) % b; };
    switch (wrap) {
        case shared::kTextureWrapClamp:
            return std::clamp<int64_t>(i, 0, size - 1);
        case shared::kTextureWrapMirror: {
            const int64_t j = modulo(i, 2 * size);
            return j < size ? j : 2 * size - 1 - j;
        }
        default:
            return modulo(i, size);
    }
}

double sound(double coordinate) {
    return std::abs(coordinate) <= static_cast<double>(shared::kMaxTextureCoordinate) ? coordinate : 0.0;
}

class ImageSampler {
  public:
    ImageSampler(const Model& scene, const rows::Texture& image) : scene_(scene), image_(image) {}

    dvec4 operator()(const dvec2& uv) const {
        const double x = sound(uv.x) * image_.width, y = (1 - sound(uv.y)) * image_.height;
        if (image_.flags & shared::kTextureNearest)
            return texel(static_cast<int64_t>(std::floor(x)), nearestRow(y));
        // A texel weighs by how near its centre is, and not from a distance of 1 on.
        const auto left = static_cast<int64_t>(std::floor(x - 0.5));
        const auto top = static_cast<int64_t>(std::floor(y - 0.5));
        dvec4 sum(0);
        for (int64_t j = top; j <= top + 1; ++j)
            for (int64_t i = left; i <= left + 1; ++i) sum += nearness(x, i) * nearness(y, j) * texel(i, j);
        return sum;
    }

  private:
    // v = 0 belongs to the lowest row, as u = 0 to the leftmost column.
    int64_t nearestRow(double y) const { return static_cast<int64_t>(std::ceil(y)) - 1; }
    static double nearness(double x, int64_t i) { return 1 - std::abs(x - (static_cast<double>(i) + 0.5)); }
    dvec4 texel(int64_t i, int64_t j) const {
        const int64_t column = wrapIndex(i, image_.width, image_.flags & shared::kTextureWrapMask);
        const int64_t row = wrapIndex(j, image_.height,
                                      image_.flags >> shared::kTextureWrapVShift & shared::kTextureWrapMask);
        const auto index =
            image_.firstTexel + static_cast<size_t>(row) * image_.width + static_cast<size_t>(column);
        const shared::Texel& t = (*scene_.texels)[index];
        return {dvec3(t.color), t.alpha};
    }

    const Model& scene_;
    const rows::Texture& image_;
};

bool isOdd(double cell) {
    return std::fmod(std::abs(std::floor(cell)), 2) == 1;
}

}  // namespace

dvec4 textureAt(const Model& scene, const rows::Texture& texture, const dvec2& uv, const dvec3& position,
                uint32_t object) {
    const dvec2 st = uv * dvec2(texture.scaleU, texture.scaleV) + dvec2(texture.place);
    if (!(texture.flags & shared::kTextureChecker)) return ImageSampler(scene, texture)(st);
    bool odd = isOdd(st.x) != isOdd(st.y);
    if (texture.flags & shared::kTextureSolid) {
        const rows::ObjectFrame& f = scene.objectFrames[object];
        const dvec3 own(glm::dot(dvec3(f.toObjectX), position) + f.offsetX,
                        glm::dot(dvec3(f.toObjectY), position) + f.offsetY,
                        glm::dot(dvec3(f.toObjectZ), position) + f.offsetZ);
        const dvec3 cell = static_cast<double>(texture.scaleU) * (own - dvec3(texture.place));
        odd = (isOdd(cell.x) != isOdd(cell.y)) != isOdd(cell.z);
    }
    return {dvec3(odd ? texture.colorB : texture.colorA), 1};
}

}  // namespace glint::reference
