// One number for the content of files, settings and images.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/image.h"

namespace glint {

// XXH3, 64 bits, seed 0 (Y. Collet, https://xxhash.com). Tells apart what differs or was damaged, not what
// was forged.
uint64_t contentHash(std::span<const uint8_t> bytes);
uint64_t contentHash(std::string_view text);

// 16 hexadecimal digits.
std::string hashText(uint64_t hash);

// XXH3, 64 bits, seed 0 (Y. Collet, https://xxhash.com), as 16 hexadecimal digits: of red, green and blue of
// all pixels, rows from the top, as 32-bit floats, lowest byte first. Equal for images of the same bits; it
// detects differences, not forgeries. `image`: at least three channels; further ones do not count.
std::string pictureHash(const Image& image);

// The same of an image whose rows arrive from the top.
class PictureHash {
  public:
    PictureHash();
    ~PictureHash();
    PictureHash(const PictureHash&) = delete;
    PictureHash& operator=(const PictureHash&) = delete;

    void add(const Image& rows);
    void fill(int rows, const Image& row);  // so many, each like the one given
    std::string text() const;

  private:
    void addRow(const Image& image, int y, int times);

    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace glint
