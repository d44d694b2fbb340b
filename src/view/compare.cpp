#include "view/compare.h"

#include <algorithm>
#include <cmath>

namespace glint::view {

namespace {

// With alpha 1 where there is none.
Picture pictureOf(const Image& image) {
    Picture picture;
    picture.region = {0, 0, image.width, image.height};
    picture.color = Image(image.width, image.height, 4, 1.0f);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                picture.color.at(x, y, c) = image.at(x, y, std::min(c, image.channels - 1));
    return picture;
}

Canvas canvasOf(const Image& image, const Display& display) {
    return colorize(pictureOf(image), ViewLayer::Color, display, {});
}

Canvas fitted(Canvas canvas, const Canvas& like) {
    if (canvas.width == like.width && canvas.height == like.height) return canvas;
    Canvas target(like.width, like.height);
    stretch(canvas, target, false);
    return target;
}

constexpr uint32_t kLine = packColor(255, 255, 255);

}  // namespace

void measure(Comparison& comparison, const Image* a) {
    comparison.figures.reset();
    comparison.fault.clear();
    if (!comparison.linear || a == nullptr) {
        comparison.fault = "no colours to compare";
    } else if (a->width != comparison.linear->width || a->height != comparison.linear->height) {
        comparison.fault = "the pictures differ in size";
    } else {
        comparison.figures = compareImages(*a, *comparison.linear, 0, 1);
    }
}

void compose(const Comparison& comparison, const Image* a, const Display& display, bool flash,
             Canvas& shown) {
    if (!comparison.any() || comparison.mode == CompareMode::Off) return;
    if (comparison.mode == CompareMode::Difference) {
        if (a == nullptr || !comparison.figures) return;
        const Image difference = differenceImage(*a, *comparison.linear, static_cast<float>(comparison.gain));
        shown = fitted(canvasOf(difference, {}), shown);
        return;
    }
    if (comparison.mode == CompareMode::Flicker && !flash) return;
    const Canvas other =
        fitted(comparison.linear ? canvasOf(*comparison.linear, display) : comparison.canvas, shown);
    const int end = comparison.mode == CompareMode::Flicker
                        ? shown.width
                        : static_cast<int>(std::lround(comparison.wipe * shown.width));
    for (int y = 0; y < shown.height; ++y) {
        std::copy_n(other.row(y), std::clamp(end, 0, shown.width), shown.row(y));
        if (end > 0 && end < shown.width) shown.row(y)[end] = kLine;
    }
}

}  // namespace glint::view
