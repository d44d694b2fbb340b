#include "view/fonts.h"

namespace glint::view {

namespace {

constexpr FontPlace kPlaces[] = {
    {"fonts-dejavu-core", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"},
    {"fonts-noto-core", "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf"},
    {"fonts-liberation2", "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf"},
    {"fonts-liberation", "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"},
    {"fonts-freefont-ttf", "/usr/share/fonts/truetype/freefont/FreeSans.ttf"},
};

}  // namespace

std::span<const FontPlace> fontPlaces() {
    return kPlaces;
}

std::optional<std::filesystem::path> findFont() {
    for (const FontPlace& place : kPlaces) {
        std::error_code error;
        if (std::filesystem::is_regular_file(place.file, error)) return place.file;
    }
    return std::nullopt;
}

}  // namespace glint::view
