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

namespace {

using Row = std::vector<std::array<float, 3>>;

void copyRow(const Image& rows, int y, Row& row) {
    row.resize(static_cast<size_t>(rows.width));
    for (int x = 0; x < rows.width; ++x)
        row[static_cast<size_t>(x)] = {rows.at(x, y, 0), rows.at(x, y, 1), rows.at(x, y, 2)};
}

}  // namespace

void PictureHash::add(const Image& rows) {
    Row row;
    for (int y = 0; y < rows.height; ++y) {
        copyRow(rows, y, row);
        XXH3_64bits_update(&state_->state, row.data(), row.size() * sizeof(row[0]));
    }
}

void PictureHash::fill(int rows, const Image& row) {
    Row bytes;
    copyRow(row, 0, bytes);
    for (; rows > 0; --rows)
        XXH3_64bits_update(&state_->state, bytes.data(), bytes.size() * sizeof(bytes[0]));
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
