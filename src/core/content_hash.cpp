#include "core/content_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <bit>
#include <vector>

#include "core/format.h"

namespace glint {

uint64_t contentHash(std::span<const uint8_t> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

uint64_t contentHash(std::string_view text) {
    return XXH3_64bits(text.data(), text.size());
}

std::string hashText(uint64_t hash) {
    return format("%016llx", static_cast<unsigned long long>(hash));
}

static_assert(std::endian::native == std::endian::little, "the hash is of floats with the lowest byte first");

struct PictureHash::State {
    XXH3_state_t state;
};

PictureHash::PictureHash() : state_(std::make_unique<State>()) {
    XXH3_64bits_reset(&state_->state);
}

PictureHash::~PictureHash() = default;

void PictureHash::addRow(const Image& image, int y, int times) {
    std::vector<std::array<float, 3>> row(static_cast<size_t>(image.width));
    for (int x = 0; x < image.width; ++x)
        row[static_cast<size_t>(x)] = {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
    for (; times > 0; --times) XXH3_64bits_update(&state_->state, row.data(), row.size() * sizeof(row[0]));
}

void PictureHash::add(const Image& rows) {
    for (int y = 0; y < rows.height; ++y) addRow(rows, y, 1);
}

void PictureHash::fill(int rows, const Image& row) {
    addRow(row, 0, rows);
}

std::string PictureHash::text() const {
    return hashText(XXH3_64bits_digest(&state_->state));
}

std::string pictureHash(const Image& image) {
    PictureHash hash;
    hash.add(image);
    return hash.text();
}

}  // namespace glint
