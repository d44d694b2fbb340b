#include "core/image_io.h"

#include <algorithm>
#include <new>
#include <optional>
#include <string>

#include "core/codecs.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/quantize.h"
#include "core/staged_file.h"
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

void checkImage(const Image& image, const std::string& what, bool isColorImage) {
    const bool channelsFit = image.channels == 1 || image.channels == 3 ||
                             (isColorImage ? image.channels == 4 : image.channels == 2);
    const bool sizeFits =
        image.width > 0 && image.height > 0 && channelsFit &&
        image.pixels.size() == static_cast<size_t>(image.width) * image.height * image.channels;
    if (!sizeFits) {
        throw CodecError(what + " of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                         " pixels with " + std::to_string(image.channels) + " channels cannot be written");
    }
}

std::vector<float> plane(const Image& image, int channel) {
    std::vector<float> samples;
    samples.reserve(image.pixels.size() / static_cast<size_t>(image.channels));
    for (size_t i = static_cast<size_t>(channel); i < image.pixels.size();
         i += static_cast<size_t>(image.channels)) {
        samples.push_back(image.pixels[i]);
    }
    return samples;
}

void appendExrChannels(const Layer& layer, bool withAlpha, std::vector<ExrChannel>& channels) {
    const int count = layer.image.channels;
    if (isColor(layer)) {
        const char* const names[] = {count == 1 ? "Y" : "R", "G", "B", "A"};
        for (int c = 0; c < (withAlpha ? count : std::min(count, 3)); ++c) {
            channels.push_back({names[c], plane(layer.image, c)});
        }
        return;
    }
    if (isAlpha(layer)) {
        channels.push_back({"A", plane(layer.image, 0)});
        return;
    }
    const char* const suffixes[] = {"Y", "UV", "XYZ"};  // for 1, 2 and 3 channels
    for (int c = 0; c < count; ++c) {
        channels.push_back({layer.name + "." + suffixes[count - 1][c], plane(layer.image, c)});
    }
}

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

// Throws Error(Argument) for an unknown extension.
Format writableFormat(const fs::path& path) {
    if (const auto format = formatOf(path)) {
        return *format;
    }
    const std::string extension = path.extension().string();
    throw Error(ErrorKind::Argument,
                path.string() + ": " +
                    (extension.empty() ? "no file name extension" : "unknown picture format " + extension) +
                    " (use .png, .exr, .pfm or .hdr)");
}

// The layer with that name; null if there is none.
const Layer* findLayer(const std::vector<Layer>& layers, std::string_view name) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [&](const Layer& layer) { return layer.name == name; });
    return found == layers.end() ? nullptr : &*found;
}

// Throws CodecError for layers that cannot be written together.
void checkLayers(const std::vector<Layer>& layers) {
    if (layers.empty()) {
        throw CodecError("there is no layer to write");
    }
    for (const Layer& layer : layers) {
        checkImage(layer.image, "a layer \"" + layer.name + "\"", isColor(layer));
        if (layer.image.width != layers[0].image.width || layer.image.height != layers[0].image.height) {
            throw CodecError("the layers \"" + layers[0].name + "\" and \"" + layer.name +
                             "\" differ in size");
        }
        if (isAlpha(layer) && layer.image.channels != 1) {
            throw CodecError("the layer \"alpha\" must have one channel");
        }
    }
}

// The picture with `channels` channels: missing ones are 0, surplus ones are left out.
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

// The channels of an EXR that has all layers.
std::vector<ExrChannel> exrChannels(const std::vector<Layer>& layers) {
    const bool alphaIsLayer = findLayer(layers, "alpha") != nullptr;
    std::vector<ExrChannel> channels;
    for (const Layer& layer : layers) appendExrChannels(layer, !alphaIsLayer, channels);
    return channels;
}

int colorSampleChannels(const Image& image, const Image* alpha) {
    return alpha == nullptr ? image.channels : std::min(image.channels, 3) + 1;
}

// The bytes of a PNG's pixels. `alpha` (may be null) replaces the picture's own.
Bytes colorSamples(const Image& image, const Image* alpha) {
    if (alpha == nullptr) return quantizeColor(image);
    const int colors = std::min(image.channels, 3);
    Bytes samples;
    samples.reserve(alpha->pixels.size() * static_cast<size_t>(colors + 1));
    for (size_t i = 0; i < alpha->pixels.size(); ++i) {
        for (int c = 0; c < colors; ++c) {
            samples.push_back(
                srgbByte(image.pixels[i * static_cast<size_t>(image.channels) + static_cast<size_t>(c)]));
        }
        samples.push_back(linearByte(static_cast<double>(alpha->pixels[i])));
    }
    return samples;
}

Bytes alphaSamples(const Image& image) {
    Bytes samples(image.pixels.size());
    std::transform(image.pixels.begin(), image.pixels.end(), samples.begin(),
                   [](float value) { return linearByte(static_cast<double>(value)); });
    return samples;
}

Bytes encodeLayersExr(const std::vector<Layer>& layers, const PictureNotes& notes = {}) {
    return encodeExr(layers[0].image.width, layers[0].image.height, exrChannels(layers), notes);
}

Bytes encodeColor(Format format, const Image& image, const Image* alpha) {
    switch (format) {
        case Format::Png:
            return encodePng(image.width, image.height, colorSampleChannels(image, alpha),
                             colorSamples(image, alpha));
        case Format::Exr:
            return encodeLayersExr({{"color", image}});
        case Format::Pfm:
            return encodePfm(image);
        case Format::Hdr:
            return encodeHdr(image);
    }
    throw CodecError("unknown format");
}

// A layer other than color, in a file of its own.
Bytes encodeData(Format format, const Layer& layer) {
    if (format == Format::Png && isAlpha(layer)) {
        return encodePng(layer.image.width, layer.image.height, 1, alphaSamples(layer.image));
    }
    if (format == Format::Png) {
        // Padding comes after scaling: the zero must not take part in the range.
        const Image& image = layer.image;
        const Bytes scaled = quantizeData(image);
        if (image.channels != 2) {
            return encodePng(image.width, image.height, image.channels, scaled);
        }
        Bytes padded;
        padded.reserve(scaled.size() / 2 * 3);
        for (size_t i = 0; i < scaled.size(); i += 2) {
            padded.insert(padded.end(), {scaled[i], scaled[i + 1], uint8_t{0}});
        }
        return encodePng(image.width, image.height, 3, padded);
    }
    const bool pad = layer.image.channels == 2;
    return encodeColor(format, pad ? withChannels(layer.image, 3) : layer.image, nullptr);
}

fs::path besidePath(const fs::path& path, const std::string& layer) {
    fs::path beside = path;
    return beside.replace_filename(path.stem().string() + "." + layer + path.extension().string());
}

std::vector<OutputFile> encodeLayers(Format format, const fs::path& path, const std::vector<Layer>& layers,
                                     const PictureNotes& notes) {
    checkLayers(layers);
    if (format == Format::Exr) {
        return {{path, encodeLayersExr(layers, notes)}};
    }
    const bool hasColor = findLayer(layers, "color") != nullptr;
    const Layer* alpha = format == Format::Png && hasColor ? findLayer(layers, "alpha") : nullptr;
    std::vector<OutputFile> files;
    for (const Layer& layer : layers) {
        if (&layer == alpha) {
            continue;
        }
        if (isColor(layer)) {
            files.push_back(
                {path, encodeColor(format, layer.image, alpha == nullptr ? nullptr : &alpha->image)});
        } else {
            files.push_back({besidePath(path, layer.name), encodeData(format, layer)});
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
    throw CodecError("not a picture of a known kind (PNG, JPEG, EXR, PFM, HDR or WebP)");
}

}  // namespace

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
    const Format format = writableFormat(path);
    std::vector<OutputFile> files(1);
    files[0].path = path;
    files[0].bytes = withPath(path, [&] {
        checkImage(image, "a picture", true);
        return encodeColor(format, image, nullptr);
    });
    writeFiles(files);
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

// One file, and which of the layers are in it.
class RowFile : public ByteSink {
  public:
    explicit RowFile(const fs::path& path) : staged_(path) {
        if (staged_.isDevice())
            throw Error(ErrorKind::Failed,
                        path.string() + ": is no regular file, which a picture in bands goes into");
    }
    ~RowFile() override = default;
    RowFile(const RowFile&) = delete;
    RowFile& operator=(const RowFile&) = delete;

    virtual void add(const std::vector<Layer>& rows) = 0;
    virtual void fill(int rows, const std::vector<Layer>& row) = 0;
    virtual void end() = 0;
    StagedFile& staged() { return staged_; }
    void write(ByteView bytes, uint64_t offset) override { staged_.write(bytes, offset); }

  private:
    StagedFile staged_;
};

namespace {

class ExrFile : public RowFile {
  public:
    ExrFile(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
        : RowFile(path), rows_(*this, width, height, namesOf(shape)) {}
    void add(const std::vector<Layer>& rows) override {
        std::vector<ExrChannel> channels = exrChannels(rows);
        rows_.add(rows.front().image.height, channels);
    }
    void fill(int rows, const std::vector<Layer>& row) override {
        std::vector<ExrChannel> channels = exrChannels(row);
        rows_.fill(rows, channels);
    }
    void end() override { rows_.finish(); }

  private:
    static std::vector<std::string> namesOf(const std::vector<Layer>& shape) {
        std::vector<std::string> names;
        for (ExrChannel& channel : exrChannels(shape)) names.push_back(std::move(channel.name));
        return names;
    }
    ExrRows rows_;
};

// Colour, and alpha if there is such a layer; or alpha alone.
class PngFile : public RowFile {
  public:
    PngFile(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
        : RowFile(path), rows_(*this, width, height, channelsOf(shape)) {}
    void add(const std::vector<Layer>& rows) override { rows_.add(samplesOf(rows)); }
    void fill(int rows, const std::vector<Layer>& row) override { rows_.fill(rows, samplesOf(row)); }
    void end() override { rows_.finish(); }

  private:
    static Bytes samplesOf(const std::vector<Layer>& rows) {
        const Layer* const color = findLayer(rows, "color");
        const Layer* const alpha = findLayer(rows, "alpha");
        return color ? colorSamples(color->image, alpha ? &alpha->image : nullptr)
                     : alphaSamples(alpha->image);
    }
    static int channelsOf(const std::vector<Layer>& shape) {
        const Layer* const color = findLayer(shape, "color");
        const Layer* const alpha = findLayer(shape, "alpha");
        return color ? colorSampleChannels(color->image, alpha ? &alpha->image : nullptr) : 1;
    }
    PngRows rows_;
};

class PfmFile : public RowFile {
  public:
    PfmFile(const fs::path& path, int width, int height, const Layer& layer)
        : RowFile(path), name_(layer.name), rows_(*this, width, height, layer.image.channels) {}
    void add(const std::vector<Layer>& rows) override { rows_.add(imageOf(rows)); }
    void fill(int, const std::vector<Layer>& row) override { rows_.fill(imageOf(row)); }
    void end() override {}

  private:
    Image imageOf(const std::vector<Layer>& rows) const {
        const Image& image = findLayer(rows, name_)->image;
        return image.channels == 2 ? withChannels(image, 3) : image;
    }
    std::string name_;
    PfmRows rows_;
};

}  // namespace

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
    withPath(path, [&] {
        if (format == Format::Exr) {
            files_.push_back(std::make_unique<ExrFile>(path, width, height, shape));
        } else if (format == Format::Png) {
            files_.push_back(std::make_unique<PngFile>(paths.front(), width, height, shape));
        } else {
            for (size_t i = 0; i < shape.size(); ++i)
                files_.push_back(std::make_unique<PfmFile>(paths[i], width, height, shape[i]));
        }
    });
}

PictureRows::~PictureRows() = default;

void PictureRows::add(const std::vector<Layer>& rows) {
    for (const auto& file : files_) withPath(file->staged().path(), [&] { file->add(rows); });
    left_ -= rows.front().image.height;
}

void PictureRows::fill(const std::vector<Layer>& row) {
    for (const auto& file : files_) withPath(file->staged().path(), [&] { file->fill(left_, row); });
    left_ = 0;
}

std::vector<fs::path> PictureRows::finish() {
    std::vector<fs::path> paths;
    std::vector<StagedFile*> staged;
    for (const auto& file : files_) {
        withPath(file->staged().path(), [&] { file->end(); });
        file->staged().finish();
        staged.push_back(&file->staged());
        paths.push_back(file->staged().path());
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
