#include "core/picture_rows.h"

#include <algorithm>

#include "core/error.h"
#include "core/image_io.h"
#include "core/layer_formats.h"
#include "core/staged_file.h"

namespace glint {

namespace {

namespace fs = std::filesystem;

}  // namespace

// One file, and which of the layers are in it.
class PictureRows::File : public ByteSink {
  public:
    explicit File(const fs::path& path) : staged_(path) {
        if (staged_.isDevice())
            throw Error(ErrorKind::Failed,
                        path.string() + ": is no regular file, which a picture in bands goes into");
    }
    ~File() override = default;
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    virtual void add(const std::vector<Layer>& rows) = 0;
    virtual void fill(int rows, const std::vector<Layer>& row) = 0;
    virtual void end() = 0;
    StagedFile& staged() { return staged_; }
    void write(ByteView bytes, uint64_t offset) override { staged_.write(bytes, offset); }

  private:
    StagedFile staged_;
};

namespace {

template <typename Base>
class ExrFile : public Base {
  public:
    ExrFile(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
        : Base(path), rows_(*this, width, height, namesOf(shape)) {}
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
template <typename Base>
class PngFile : public Base {
  public:
    PngFile(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
        : Base(path), rows_(*this, width, height, channelsOf(shape)) {}
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

template <typename Base>
class PfmFile : public Base {
  public:
    PfmFile(const fs::path& path, int width, int height, const Layer& layer)
        : Base(path), name_(layer.name), rows_(*this, width, height, layer.image.channels) {}
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
            files_.push_back(std::make_unique<ExrFile<File>>(path, width, height, shape));
        } else if (format == Format::Png) {
            files_.push_back(std::make_unique<PngFile<File>>(paths.front(), width, height, shape));
        } else {
            for (size_t i = 0; i < shape.size(); ++i)
                files_.push_back(std::make_unique<PfmFile<File>>(paths[i], width, height, shape[i]));
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
    for (const auto& file : files_) {
        withPath(file->staged().path(), [&] { file->end(); });
        file->staged().finish();
        paths.push_back(file->staged().path());
    }
    size_t committed = 0;
    try {
        for (; committed < files_.size(); ++committed) files_[committed]->staged().commit();
    } catch (const Error&) {
        while (committed > 0) files_[--committed]->staged().revoke();
        throw;
    }
    return paths;
}

}  // namespace glint
