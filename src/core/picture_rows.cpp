#include "core/picture_rows.h"

#include <algorithm>

#include "core/error.h"
#include "core/image_io.h"
#include "core/layer_formats.h"
#include "core/staged_file.h"

namespace glint {

namespace fs = std::filesystem;

// One file, and which of the layers are in it.
class PictureFile : public ByteSink {
  public:
    explicit PictureFile(const fs::path& path) : staged_(path) {
        if (staged_.isDevice())
            throw Error(ErrorKind::Failed,
                        path.string() + ": is no regular file, which a picture in bands goes into");
    }
    ~PictureFile() override = default;
    PictureFile(const PictureFile&) = delete;
    PictureFile& operator=(const PictureFile&) = delete;

    virtual void add(const std::vector<Layer>& rows) = 0;
    virtual void end() = 0;
    StagedFile& staged() { return staged_; }
    void write(ByteView bytes, uint64_t offset) override { staged_.write(bytes, offset); }

  private:
    StagedFile staged_;
};

namespace {

class ExrFile : public PictureFile {
  public:
    ExrFile(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
        : PictureFile(path), rows_(*this, width, height, namesOf(shape)) {}
    void add(const std::vector<Layer>& rows) override {
        std::vector<ExrChannel> channels = exrChannels(rows);
        rows_.add(rows.front().image.height, channels);
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
class PngFile : public PictureFile {
  public:
    PngFile(const fs::path& path, int width, int height, const std::vector<Layer>& shape)
        : PictureFile(path), rows_(*this, width, height, channelsOf(shape)) {}
    void add(const std::vector<Layer>& rows) override { rows_.add(samplesOf(rows)); }
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

class PfmFile : public PictureFile {
  public:
    PfmFile(const fs::path& path, int width, int height, const Layer& layer)
        : PictureFile(path), name_(layer.name), rows_(*this, width, height, layer.image.channels) {}
    void add(const std::vector<Layer>& rows) override { rows_.add(imageOf(rows)); }
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
    constexpr int kRows = 64;
    std::vector<Layer> rows = row;
    while (left_ > 0) {
        const int count = std::min(left_, kRows);
        for (size_t i = 0; i < row.size(); ++i) {
            const Image& one = row[i].image;
            Image& many = rows[i].image = Image(one.width, count, one.channels);
            for (auto to = many.pixels.begin(); to != many.pixels.end();)
                to = std::copy(one.pixels.begin(), one.pixels.end(), to);
        }
        add(rows);
    }
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
