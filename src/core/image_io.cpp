#include "core/image_io.h"

#include <algorithm>
#include <new>
#include <string_view>

#include "core/codecs.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/quantize.h"
#include "core/text_file.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

enum class Format { Png, Exr, Pfm, Hdr };
constexpr auto entriesOf(Format) {
    return std::to_array<EnumEntry<Format>>(
        {{Format::Png, ".png"}, {Format::Exr, ".exr"}, {Format::Pfm, ".pfm"}, {Format::Hdr, ".hdr"}});
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
    if (const auto format = named<Format>(lowerExtension(path))) return *format;
    const std::string extension = path.extension().string();
    throw Error(ErrorKind::Argument,
                path.string() + ": " +
                    (extension.empty() ? "no file name extension" : "unknown image format " + extension) +
                    " (use " + choices<Format>() + ")");
}

// Throws CodecError for layers that cannot be written together.
void checkLayers(const std::vector<Layer>& layers) {
    if (layers.empty()) throw CodecError("there is no layer to write");
    const Image& first = layers[0].image;
    for (const auto& [name, image] : layers) {
        const bool channelsFit =
            image.channels == 1 || image.channels == 3 || image.channels == (name == "color" ? 4 : 2);
        if (image.width <= 0 || image.height <= 0 || !channelsFit ||
            image.pixels.size() != static_cast<size_t>(image.width) * image.height * image.channels)
            throw CodecError("a layer \"" + name + "\" of " + std::to_string(image.width) + "x" +
                             std::to_string(image.height) + " pixels with " + std::to_string(image.channels) +
                             " channels cannot be written");
        if (image.width != first.width || image.height != first.height)
            throw CodecError("the layers \"" + layers[0].name + "\" and \"" + name + "\" differ in size");
        if (name == "alpha" && image.channels != 1)
            throw CodecError("the layer \"alpha\" must have one channel");
    }
}

std::vector<std::string> namesOf(const std::vector<Layer>& layers) {
    std::vector<std::string> names;
    for (const Layer& layer : layers) names.push_back(layer.name);
    return names;
}

// A file of an image, and the layer that it holds: of an EXR every layer, of a PNG with "color" also "alpha".
struct LayerFile {
    fs::path path;
    std::string layer;
};

std::vector<LayerFile> filesOf(const fs::path& path, const std::vector<std::string>& layers) {
    const Format format = writableFormat(path);
    if (format == Format::Exr) return {{path, "color"}};
    const bool alphaJoins =
        format == Format::Png && std::find(layers.begin(), layers.end(), "color") != layers.end();
    std::vector<LayerFile> files;
    for (const std::string& layer : layers) {
        if (layer == "alpha" && alphaJoins) continue;
        fs::path file = path;
        if (layer != "color")
            file.replace_filename(path.stem().string() + "." + layer + path.extension().string());
        files.push_back({file, layer});
    }
    return files;
}

// The file that holds the layer of that name.
Bytes encoded(Format format, const std::vector<Layer>& layers, const std::string& name,
              const PictureNotes& notes) {
    if (format == Format::Exr) return encodeExr(layers, notes);
    const Image& image = findLayer(layers, name)->image;
    if (format == Format::Pfm) return encodePfm(image);
    if (format == Format::Hdr) return encodeHdr(image);
    if (name == "color" || name == "alpha")
        return encodePng(image.width, image.height, pngChannels(layers), pngSamples(layers));
    return encodePng(image.width, image.height, image.channels == 2 ? 3 : image.channels,
                     quantizeData(image));
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
    return named<Format>(lowerExtension(path)).has_value();
}

std::vector<fs::path> layerPaths(const fs::path& path, const std::vector<std::string>& names) {
    std::vector<fs::path> paths;
    for (const LayerFile& file : filesOf(path, names)) paths.push_back(file.path);
    return paths;
}

void writeImage(const fs::path& path, const Image& image) {
    writeLayers(path, {{"color", image}});
}

std::vector<fs::path> writeLayers(const fs::path& path, const std::vector<Layer>& layers,
                                  const PictureNotes& notes) {
    const Format format = writableFormat(path);
    std::vector<OutputFile> files;
    withPath(path, [&] {
        checkLayers(layers);
        for (const auto& [file, layer] : filesOf(path, namesOf(layers)))
            files.push_back({file, encoded(format, layers, layer, notes)});
    });
    writeFiles(files);
    return layerPaths(path, namesOf(layers));
}

// ---- row by row ----

bool canWriteRows(const fs::path& path, const std::vector<std::string>& layers) {
    const Format format = writableFormat(path);
    const auto joinsPng = [](const std::string& name) { return name == "color" || name == "alpha"; };
    return format != Format::Hdr && (format != Format::Png || std::ranges::all_of(layers, joinsPng));
}

PictureRows::PictureRows(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
    : left_(height) {
    const Format format = writableFormat(path);
    for (const LayerFile& file : filesOf(path, namesOf(shape)))
        withPath(file.path, [&] {
            StagedFile& staged = files_.emplace_back(file.path);
            if (staged.isDevice()) throw CodecError("is not a regular file, as images in bands need");
            encoders_.push_back(format == Format::Exr ? exrRows(staged, width, height, shape)
                                : format == Format::Png
                                    ? pngRows(staged, width, height, shape)
                                    : pfmRows(staged, width, height, *findLayer(shape, file.layer)));
        });
}

PictureRows::~PictureRows() = default;

template <typename Use>
void PictureRows::eachEncoder(Use use) {
    for (size_t i = 0; i < files_.size(); ++i) withPath(files_[i].path(), [&] { use(*encoders_[i]); });
}

void PictureRows::add(const std::vector<Layer>& rows) {
    eachEncoder([&](RowEncoder& encoder) { encoder.add(rows); });
    left_ -= rows.front().image.height;
}

void PictureRows::fill(const std::vector<Layer>& row) {
    eachEncoder([&](RowEncoder& encoder) { encoder.fill(left_, row); });
    left_ = 0;
}

std::vector<fs::path> PictureRows::finish() {
    eachEncoder([](RowEncoder& encoder) { encoder.finish(); });
    commitAll(files_);
    std::vector<fs::path> paths;
    for (const StagedFile& file : files_) paths.push_back(file.path());
    return paths;
}

// ---- reading ----

Image decodeImage(std::span<const uint8_t> bytes, const std::string& name, uint64_t mostPixels,
                  const Context& context) {
    return withPath(name, [&] { return decode(bytes, std::min(mostPixels, kMostPixels), context); });
}

Image readImage(const fs::path& path, uint64_t mostPixels) {
    const std::string file = readWholeFile(path, {}, ErrorKind::Failed);
    return decodeImage({reinterpret_cast<const uint8_t*>(file.data()), file.size()}, path.string(),
                       mostPixels);
}

}  // namespace glint
