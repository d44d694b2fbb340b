// Rows of 32-bit floats of an EXR file, by OpenEXR's newer library.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/codecs.h"

namespace glint {

// Shape of the file as OpenEXR's C++ library, which checked the sizes, reports it.
struct ExrShape {
    int width, height;
    int channels;     // of the file
    int compression;  // as in the file
};

// The picture of these channels, interleaved: each is in the file, of 32-bit floats, in scanlines of one part
// that are not compressed, or by runs or deflate. Nothing if this library does not take the file, or takes it
// for another: what is wrong with it, if anything, the older one says.
std::optional<Image> readExrFloats(ByteView file, const ExrShape& shape,
                                   const std::vector<std::string>& channels, const Context& context = {});

}  // namespace glint
