#include "core/picture_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <bit>
#include <vector>

#include "core/content_hash.h"

namespace glint {

static_assert(std::endian::native == std::endian::little, "the hash is of floats with the lowest byte first");

std::string pictureHash(const Image& image) {
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    std::vector<std::array<float, 3>> row(static_cast<size_t>(image.width));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x)
            row[static_cast<size_t>(x)] = {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
        XXH3_64bits_update(&state, row.data(), row.size() * sizeof(row[0]));
    }
    return hashText(XXH3_64bits_digest(&state));
}

}  // namespace glint
