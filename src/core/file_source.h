// Source of a scene's files: the file system, or another rank that reads them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/context.h"

namespace glint {

struct FileStatus {
    bool exists = false, regular = false;
    uint64_t size = 0;  // of a regular file
};

// All that reading a scene asks of the file system. The answers depend on nothing but the file system, and a
// scene asks in the same order whenever it gets the same answers.
class FileSource {
  public:
    virtual ~FileSource() = default;

    // The bytes of a regular file that is not empty; throws Error(Scene), as readWholeFile
    // (core/text_file.h).
    virtual std::string read(const std::filesystem::path& path, const Context& context) = 0;
    virtual FileStatus status(const std::filesystem::path& path) = 0;
    // Absolute, with links followed as far as there are files. Throws Error(Scene) "PATH: cannot be read:
    // ...".
    virtual std::filesystem::path real(const std::filesystem::path& path) = 0;
};

std::shared_ptr<FileSource> fileSystem();

}  // namespace glint
