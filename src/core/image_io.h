// Reading and writing image files. Samples in memory are linear; PNG is sRGB-encoded on the way out and
// decoded on the way in (IEC 61966-2-1), EXR, PFM and HDR hold linear values.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/context.h"
#include "core/file_io.h"
#include "core/image.h"

namespace glint {

// True if the extension of `path` names a format that writeImage can write (.png .exr .pfm .hdr, any case).
bool isWritableImagePath(const std::filesystem::path& path);

// Writes `image` (1, 3 or 4 channels; a fourth is alpha, dropped by PFM and HDR) in the format that the
// extension names. The file appears whole: it is written beside its destination and renamed. Parent folders
// must exist. Throws Error(Argument) for an unknown extension and Error(Failed) if the file cannot be
// written; no partial file is left behind.
void writeImage(const std::filesystem::path& path, const Image& image);

// Writes several layers. EXR: one file, the layer "color" as R,G,B (and the layer "alpha" as A), any other
// layer NAME as channels NAME.X (1 channel: Y; 2: U,V; 3: X,Y,Z). Other formats: the layer "color" goes to
// `path`, a layer NAME to stem.NAME.ext beside it (2-channel layers are padded with a zero; PNG stores
// samples of layers other than color and alpha scaled to their finite min..max, so use EXR or PFM for data).
// "alpha" becomes the PNG's own alpha channel. EXR has the notes as attributes, the other formats have no
// place for them. Returns the files written, in order. Same errors as writeImage; either all files appear or
// none.
std::vector<std::filesystem::path> writeLayers(const std::filesystem::path& path,
                                               const std::vector<Layer>& layers,
                                               const PictureNotes& notes = {});

// The files that writeLayers would write for layers of these names. Throws Error(Argument) for an unknown
// extension.
std::vector<std::filesystem::path> layerPaths(const std::filesystem::path& path,
                                              const std::vector<std::string>& names);

// True if an image with layers of these names can be written so: .png, .exr and .pfm can, but for layers of
// a PNG that are scaled by their smallest and greatest value. Throws Error(Argument) for an unknown
// extension.
bool canWriteRows(const std::filesystem::path& path, const std::vector<std::string>& layers);

// The files and pixels of writeLayers, written as their rows arrive from the top: for images larger than
// memory. They appear, all or none, with finish().
class RowEncoder;
class PictureRows {
  public:
    // `shape`: the layers as add() will get them; their images may be empty but for the channels. Throws
    // Error(Failed) if a file cannot be made, or is a device, whose bytes would all have to be kept.
    PictureRows(const std::filesystem::path& path, int width, int height, const std::vector<Layer>& shape);
    ~PictureRows();
    PictureRows(const PictureRows&) = delete;
    PictureRows& operator=(const PictureRows&) = delete;

    void add(const std::vector<Layer>& rows);
    // All rows that are left, each like the one given: for the end of an image that stays empty.
    void fill(const std::vector<Layer>& row);
    std::vector<std::filesystem::path> finish();

  private:
    template <typename Use>
    void eachEncoder(Use use);

    int left_;  // rows
    std::deque<StagedFile> files_;
    std::vector<std::unique_ptr<RowEncoder>> encoders_;  // one for each file
};

// Reads a PNG, JPEG, EXR, PFM, HDR or WebP into 1, 3 or 4 linear channels. Throws Error(Failed) with the path
// and the reason if it is missing, truncated or of an unknown kind. Images of more pixels than `mostPixels`,
// or than codecs.h allows, are refused before memory is taken.
Image readImage(const std::filesystem::path& path, uint64_t mostPixels = kMostPixels);

// Decodes the bytes of such a file; `name` stands for it in messages.
Image decodeImage(std::span<const uint8_t> bytes, const std::string& name, uint64_t mostPixels = kMostPixels,
                  const Context& context = {});

}  // namespace glint
