// An image in memory: linear float samples, row 0 at the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace glint {

// width x height pixels of `channels` interleaved floats; sample (x, y, c) is
// pixels[(y * width + x) * channels + c].
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> pixels;

    Image() = default;
    Image(int w, int h, int c, float value = 0.0f)
        : width(w), height(h), channels(c), pixels(static_cast<size_t>(w) * h * c, value) {}

    float& at(int x, int y, int c) { return pixels[(static_cast<size_t>(y) * width + x) * channels + c]; }
    float at(int x, int y, int c) const {
        return pixels[(static_cast<size_t>(y) * width + x) * channels + c];
    }
};

// Pixels of the largest image that is decoded: 16,384 x 16,384, 4 GiB of RGBA floats.
inline constexpr uint64_t kMostPixels = uint64_t{1} << 28;

// A named image, e.g. the AOV "normal" with three channels. All layers of one image have the same size.
struct Layer {
    std::string name;
    Image image;
};

// Notes stored in an image file: names with numbers or texts.
using PictureNotes = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

}  // namespace glint
