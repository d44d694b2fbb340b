// Formats by extension, and the mapping of layers to them, for image_io.cpp and picture_rows.cpp.
#pragma once

#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "core/codecs.h"
#include "core/error.h"
#include "core/image.h"
#include "core/text_file.h"

namespace glint {

enum class Format { Png, Exr, Pfm, Hdr };

// Throws Error(Argument) for an unknown extension.
Format writableFormat(const std::filesystem::path& path);

// Runs an encoder or decoder; its failures get the file's name.
template <typename Function>
auto withPath(const std::filesystem::path& path, Function function) {
    try {
        return function();
    } catch (const CodecError& error) {
        throw Error(ErrorKind::Failed, printable(path.string() + ": " + error.what()));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::Failed, path.string() + ": not enough memory for the picture");
    }
}

// The layer with that name; null if there is none.
const Layer* findLayer(const std::vector<Layer>& layers, std::string_view name);

// Throws CodecError for layers that cannot be written together.
void checkLayers(const std::vector<Layer>& layers);

// The channels of an EXR that has all layers.
std::vector<ExrChannel> exrChannels(const std::vector<Layer>& layers);

// The picture with `channels` channels: missing ones are 0, surplus ones are left out.
Image withChannels(const Image& image, int channels);

// The bytes of a PNG's pixels. `alpha` (may be null) replaces the picture's own.
Bytes colorSamples(const Image& image, const Image* alpha);
int colorSampleChannels(const Image& image, const Image* alpha);
Bytes alphaSamples(const Image& image);

}  // namespace glint
