// The headers of an EXR file before the library reads them. Internal to exr_codec.cpp.
#pragma once

#include "core/codecs.h"

namespace glint {

inline constexpr size_t kExrFirstHeader = 8;  // behind magic number and version

// Throws CodecError for attributes that do not have the size that their type has, or that is said: the
// library goes by the one, or takes memory by the other, whatever the file holds.
void checkExrAttributes(ByteView file, bool severalParts);

}  // namespace glint
