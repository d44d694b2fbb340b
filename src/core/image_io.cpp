#include "core/image_io.h"

#include <algorithm>
#include <new>
#include <optional>
#include <string>

#include "core/codecs.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/quantize.h"
#include "core/text_file.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

enum class Format { Png, Exr, Pfm, Hdr };

std::optional<Format> formatOf(const fs::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".png") return Format::Png;
    if (extension == ".exr") return Format::Exr;
    if (extension == ".pfm") return Format::Pfm;
    if (extension == ".hdr") return Format::Hdr;
    return std::nullopt;
}

bool isColor(const Layer& layer) {
    return layer.name == "color";
}
bool isAlpha(const Layer& layer) {
    return layer.name == "alpha";
}

// Runs an encoder or decoder; its failures get the file's name.
template <typename Function>
auto withPath(const std::filesystem::path& path, Function function) {
    try {
        return function();
    } catch (const CodecError& error) {
        throw Error(ErrorKind::Failed, printable(path.string() + ": " + error.what()));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::Failed, path.string() + ": not enough memory for the image");
    }
}

// Throws Error(Argument) for an unknown extension.
Format writableFormat(const fs::path& path) {
    if (const auto format = formatOf(path)) {
        return *format;
    }
    const std::string extension = path.extension().string();
    throw Error(ErrorKind::Argument,
                path.string() + ": " +
                    (extension.empty() ? "no file name extension" : "unknown image format " + extension) +
                    " (use .png, .exr, .pfm or .hdr)");
}

// Throws CodecError for layers that cannot be written together.
void checkLayers(const std::vector<Layer>& layers) {
    if (layers.empty()) {
        throw CodecError("there is no layer to write");
    }
    for (const Layer& layer : layers) {
        const Image& image = layer.image;
        const bool channelsFit =
            image.channels == 1 || image.channels == 3 || image.channels == (isColor(layer) ? 4 : 2);
        if (image.width <= 0 || image.height <= 0 || !channelsFit ||
            image.pixels.size() != static_cast<size_t>(image.width) * image.height * image.channels)
            throw CodecError("a layer \"" + layer.name + "\" of " + std::to_string(image.width) + "x" +
                             std::to_string(image.height) + " pixels with " + std::to_string(image.channels) +
                             " channels cannot be written");
        if (layer.image.width != layers[0].image.width || layer.image.height != layers[0].image.height) {
            throw CodecError("the layers \"" + layers[0].name + "\" and \"" + layer.name +
                             "\" differ in size");
        }
        if (isAlpha(layer) && layer.image.channels != 1) {
            throw CodecError("the layer \"alpha\" must have one channel");
        }
    }
}

// The image with `channels` channels: missing ones are 0, surplus ones are left out.
Image withChannels(const Image& image, int channels) {
    Image result(image.width, image.height, channels);
    const auto from = static_cast<size_t>(image.channels);
    const auto to = static_cast<size_t>(channels);
    for (size_t i = 0; i < result.pixels.size(); ++i) {
        const size_t channel = i % to;
        result.pixels[i] = channel < from ? image.pixels[i / to * from + channel] : 0.0f;
    }
    return result;
}

Bytes encodeImage(Format format, const Image& image) {
    switch (format) {
        case Format::Png:
            return encodePng(image.width, image.height, image.channels, quantizeColor(image));
        case Format::Exr:
            return encodeExr({{"color", image}});
        case Format::Pfm:
            return encodePfm(image);
        case Format::Hdr:
            return encodeHdr(image.channels == 2 ? withChannels(image, 3) : image);
    }
    throw CodecError("unknown format");
}

// A layer other than color, in a file of its own.
Bytes encodeData(Format format, const Layer& layer) {
    const Image& image = layer.image;
    if (format != Format::Png) return encodeImage(format, image);
    if (isAlpha(layer)) return encodePng(image.width, image.height, 1, pngSamples({layer}));
    // Padding comes after scaling: the zero must not take part in the range.
    const Bytes scaled = quantizeData(image);
    if (image.channels != 2) return encodePng(image.width, image.height, image.channels, scaled);
    Bytes padded;
    padded.reserve(scaled.size() / 2 * 3);
    for (size_t i = 0; i < scaled.size(); i += 2) {
        padded.insert(padded.end(), {scaled[i], scaled[i + 1], uint8_t{0}});
    }
    return encodePng(image.width, image.height, 3, padded);
}

fs::path besidePath(const fs::path& path, const std::string& layer) {
    fs::path beside = path;
    return beside.replace_filename(path.stem().string() + "." + layer + path.extension().string());
}

std::vector<OutputFile> encodeLayers(Format format, const fs::path& path, const std::vector<Layer>& layers,
                                     const PictureNotes& notes) {
    checkLayers(layers);
    if (format == Format::Exr) {
        return {{path, encodeExr(layers, notes)}};
    }
    const bool hasColor = findLayer(layers, "color") != nullptr;
    const Layer* alpha = format == Format::Png && hasColor ? findLayer(layers, "alpha") : nullptr;
    std::vector<OutputFile> files;
    for (const Layer& layer : layers) {
        if (&layer == alpha) {
            continue;
        }
        if (!isColor(layer)) {
            files.push_back({besidePath(path, layer.name), encodeData(format, layer)});
        } else if (alpha != nullptr) {
            files.push_back({path, encodePng(layer.image.width, layer.image.height, pngChannels(layers),
                                             pngSamples(layers))});
        } else {
            files.push_back({path, encodeImage(format, layer.image)});
        }
    }
    return files;
}

bool startsWith(ByteView file, std::string_view magic) {
    return file.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), file.begin(),
                      [](char c, uint8_t byte) { return static_cast<uint8_t>(c) == byte; });
}

Image decode(ByteView file, uint64_t mostPixels, const Context& context) {
    if (file.empty()) throw CodecError("the file is empty");
    if (startsWith(file, "\x89PNG\r\n\x1a\n")) return decodePng(file, mostPixels, context);
    if (startsWith(file, "\xff\xd8\xff")) return decodeJpeg(file, mostPixels, context);
    if (startsWith(file, "\x76\x2f\x31\x01")) return decodeExr(file, mostPixels, context);
    if (startsWith(file, "#?")) return decodeHdr(file, mostPixels, context);
    if (startsWith(file, "RIFF") && file.size() > 12 && startsWith(file.subspan(8), "WEBP"))
        return decodeWebp(file, mostPixels, context);
    if (startsWith(file, "PF") || startsWith(file, "Pf")) return decodePfm(file, mostPixels, context);
    throw CodecError("not an image of a known kind (PNG, JPEG, EXR, PFM, HDR or WebP)");
}

}  // namespace

const Layer* findLayer(const std::vector<Layer>& layers, std::string_view name) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [&](const Layer& layer) { return layer.name == name; });
    return found == layers.end() ? nullptr : &*found;
}

// A layer "alpha" replaces the fourth channel of "color".
int pngChannels(const std::vector<Layer>& layers) {
    const Layer* const color = findLayer(layers, "color");
    if (color == nullptr) return 1;
    const int channels = color->image.channels;
    return findLayer(layers, "alpha") == nullptr ? channels : std::min(channels, 3) + 1;
}

Bytes pngSamples(const std::vector<Layer>& layers) {
    const Layer* const color = findLayer(layers, "color");
    const Layer* const alpha = findLayer(layers, "alpha");
    if (alpha == nullptr) return quantizeColor(color->image);
    const int colors = color == nullptr ? 0 : std::min(color->image.channels, 3);
    Bytes samples;
    samples.reserve(alpha->image.pixels.size() * static_cast<size_t>(colors + 1));
    for (size_t i = 0; i < alpha->image.pixels.size(); ++i) {
        for (int c = 0; c < colors; ++c) {
            const auto channels = static_cast<size_t>(color->image.channels);
            samples.push_back(srgbByte(color->image.pixels[i * channels + static_cast<size_t>(c)]));
        }
        samples.push_back(linearByte(static_cast<double>(alpha->image.pixels[i])));
    }
    return samples;
}

bool isWritableImagePath(const fs::path& path) {
    return formatOf(path).has_value();
}

std::vector<fs::path> layerPaths(const fs::path& path, const std::vector<std::string>& names) {
    const Format format = writableFormat(path);
    if (format == Format::Exr) return {path};
    const bool hasColor = std::find(names.begin(), names.end(), "color") != names.end();
    std::vector<fs::path> paths;
    for (const std::string& name : names) {
        if (name == "alpha" && hasColor && format == Format::Png) continue;
        paths.push_back(name == "color" ? path : besidePath(path, name));
    }
    return paths;
}

void writeImage(const fs::path& path, const Image& image) {
    writeLayers(path, {{"color", image}});
}

std::vector<fs::path> writeLayers(const fs::path& path, const std::vector<Layer>& layers,
                                  const PictureNotes& notes) {
    const Format format = writableFormat(path);
    const std::vector<OutputFile> files =
        withPath(path, [&] { return encodeLayers(format, path, layers, notes); });
    writeFiles(files);
    std::vector<fs::path> paths;
    for (const OutputFile& file : files) {
        paths.push_back(file.path);
    }
    return paths;
}

// ---- row by row ----

// One file of PictureRows with its encoder.
class RowFile : public ByteSink {
  public:
    explicit RowFile(const fs::path& path) : staged(path) {
        if (staged.isDevice())
            throw Error(ErrorKind::Failed,
                        path.string() + ": is no regular file, which an image in bands goes into");
    }
    void write(ByteView bytes, uint64_t offset) override { staged.write(bytes, offset); }

    StagedFile staged;
    std::unique_ptr<RowEncoder> encoder;
};

bool canWriteRows(const fs::path& path, const std::vector<std::string>& layers) {
    switch (writableFormat(path)) {
        case Format::Exr:
        case Format::Pfm:
            return true;
        case Format::Png:
            return std::all_of(layers.begin(), layers.end(),
                               [](const std::string& name) { return name == "color" || name == "alpha"; });
        case Format::Hdr:
            return false;
    }
    return false;
}

PictureRows::PictureRows(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
    : left_(height) {
    std::vector<std::string> names;
    for (const Layer& layer : shape) names.push_back(layer.name);
    const std::vector<fs::path> paths = layerPaths(path, names);
    const Format format = writableFormat(path);
    const size_t count = format == Format::Pfm ? shape.size() : 1;  // a file for each layer, or one for all
    for (size_t i = 0; i < count; ++i)
        withPath(path, [&] {
            RowFile& file = *files_.emplace_back(std::make_unique<RowFile>(paths[i]));
            file.encoder = format == Format::Exr   ? exrRows(file, width, height, shape)
                           : format == Format::Png ? pngRows(file, width, height, shape)
                                                   : pfmRows(file, width, height, shape[i]);
        });
}

PictureRows::~PictureRows() = default;

void PictureRows::add(const std::vector<Layer>& rows) {
    for (const auto& file : files_) withPath(file->staged.path(), [&] { file->encoder->add(rows); });
    left_ -= rows.front().image.height;
}

void PictureRows::fill(const std::vector<Layer>& row) {
    for (const auto& file : files_) withPath(file->staged.path(), [&] { file->encoder->fill(left_, row); });
    left_ = 0;
}

std::vector<fs::path> PictureRows::finish() {
    std::vector<fs::path> paths;
    std::vector<StagedFile*> staged;
    for (const auto& file : files_) {
        withPath(file->staged.path(), [&] { file->encoder->finish(); });
        file->staged.finish();
        staged.push_back(&file->staged);
        paths.push_back(file->staged.path());
    }
    commitAll(staged);
    return paths;
}

// ---- reading ----

Image decodeImage(std::span<const uint8_t> bytes, const std::string& name, uint64_t mostPixels,
                  const Context& context) {
    return withPath(name, [&] { return decode(bytes, std::min(mostPixels, kMostPixels), context); });
}

Image readImage(const fs::path& path, uint64_t mostPixels) {
    const Bytes file = readFile(path);
    return withPath(path, [&] { return decode(file, std::min(mostPixels, kMostPixels), {}); });
}

}  // namespace glint
