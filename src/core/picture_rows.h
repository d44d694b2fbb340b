// Pictures larger than memory: written as their rows arrive from the top.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"

namespace glint {

// True if a picture with layers of these names can be written so: .png, .exr and .pfm can, but for layers of
// a PNG that are scaled by their smallest and greatest value. Throws Error(Argument) for an unknown
// extension.
bool canWriteRows(const std::filesystem::path& path, const std::vector<std::string>& layers);

// The files and pixels of writeLayers (core/image_io.h). They appear, all or none, with finish().
class PictureRows {
  public:
    // `shape`: the layers as add() will get them; their images may be empty but for the channels. Throws
    // Error(Failed) if a file cannot be made, or is a device, which has no room for rows in any order.
    PictureRows(const std::filesystem::path& path, int width, int height, const std::vector<Layer>& shape);
    ~PictureRows();
    PictureRows(const PictureRows&) = delete;
    PictureRows& operator=(const PictureRows&) = delete;

    void add(const std::vector<Layer>& rows);
    // All rows that are left, each like the one given: for the end of a picture that stays empty, in a time
    // that hardly depends on its pixels, but for layers of a PFM that are not 0 there.
    void fill(const std::vector<Layer>& row);
    std::vector<std::filesystem::path> finish();

  private:
    class File;
    int left_;  // rows
    std::vector<std::unique_ptr<File>> files_;
};

}  // namespace glint
