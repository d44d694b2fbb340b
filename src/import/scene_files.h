// Opens the files of one scene, each once, and limits their places and their memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/context.h"
#include "core/image.h"
#include "core/text_file.h"
#include "scene/frame_model.h"
#include "scene/scene.h"

namespace glint {

struct LoadOptions {
    // Allows files outside the folder of the scene (or model): absolute names, "..", links that lead out.
    bool allowOutside = false;
    // Bytes that reading may take.
    uint64_t memory = std::numeric_limits<uint64_t>::max();
    // The camera of this name becomes the scene's own (scene/cameras.h); empty: the file's default.
    std::string camera = {};
    // The axis that points up in a file without a camera; empty: y. Error(Argument) for one with a camera.
    std::optional<UpAxis> up = {};
    // Source of the files; empty: the file system.
    std::shared_ptr<FileSource> source = {};
    Context context = {};
};

class SceneFiles {
  public:
    // `folder` is that of the scene; empty is the current one.
    explicit SceneFiles(const std::filesystem::path& folder, const LoadOptions& options = {});

    // The file that another file in `folder` calls `name`. Throws Error(Scene) for URLs, empty names, names
    // with a zero byte, links in a circle, names that the system refuses, and files outside that are not
    // allowed.
    std::filesystem::path resolve(const std::filesystem::path& folder, const std::string& name) const;

    // The same for materials and images of a model, whose names often come from another machine. A backslash
    // is a slash. If the file is missing or not allowed, the file of the same name in `folder` replaces it.
    std::filesystem::path findOrBeside(const std::filesystem::path& folder, const std::string& name) const;

    bool exists(const std::filesystem::path& path) { return source_->status(path).exists; }
    bool isFile(const std::filesystem::path& path) const { return source_->status(path).regular; }
    // Absolute, with links followed as far as there are files.
    std::filesystem::path real(const std::filesystem::path& path) const { return source_->real(path); }

    // The bytes of a regular file. Throws Error(Scene) if there are more than memoryLeft().
    std::string bytesOf(const std::filesystem::path& path);
    // The same, which count as taken while the scene is read.
    std::string read(const std::filesystem::path& path);

    // The image in linear samples: PNG and JPEG are decoded from sRGB (their alpha is linear already), HDR,
    // EXR and PFM are linear. Throws Error(Scene) "PATH: reason" if there is none.
    std::shared_ptr<const Image> image(const std::filesystem::path& path);

    std::optional<UpAxis> up() const { return options_.up; }

    // Decodes an image that stands in memory, and counts its samples; `name` stands for it in messages.
    std::shared_ptr<const Image> decode(std::string_view bytes, const std::string& name);

    // Pixels of the largest image that fits into the memory that is left.
    uint64_t mostPixels() const;

    // Counts an image that was neither read nor decoded here.
    void takePicture(const Image& image) { pictures_ += image.pixels.size() * sizeof(float); }

    // Call this before memory is reserved by the declarations of a file. Throws Error(Scene) if the sum is
    // more than options.memory, or out of proportion to the files that were read.
    void take(uint64_t bytes, const std::string& where);

    // The terms of this load; ProgressPart changes its progress.
    const Context& context() const { return options_.context; }

    // Files read so far, by name.
    std::vector<SourceFile> sources() const;

  private:
    friend class ProgressPart;
    void note(const std::filesystem::path& path, uint64_t hash);
    uint64_t memoryLeft() const;

    LoadOptions options_;
    std::shared_ptr<FileSource> source_;
    std::filesystem::path root_;
    uint64_t read_ = 0;                                           // bytes of files
    uint64_t pictures_ = 0;                                       // and of their samples
    uint64_t taken_ = 0;                                          // and all else
    std::map<std::string, std::shared_ptr<const Image>> images_;  // by path, links followed
    std::map<std::string, uint64_t> sources_;                     // hashes by name
};

// During its lifetime, scales the load's reported progress to the part from `from` to `to` of the previous
// range.
class ProgressPart {
  public:
    ProgressPart(SceneFiles& files, double from, double to);
    // Part i of `count` parts that take the same time.
    ProgressPart(SceneFiles& files, size_t i, size_t count);
    ~ProgressPart();
    ProgressPart(const ProgressPart&) = delete;
    ProgressPart& operator=(const ProgressPart&) = delete;

  private:
    Context& context_;
    const Context before_;
};

}  // namespace glint
