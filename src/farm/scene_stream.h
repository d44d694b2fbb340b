// Sends the files of a scene from the process that reads them to processes that need not read them.
// A reader requests files in an order that depends on their contents alone. The reading process records every
// file, errors included; the others get the same files for the same requests. Each file carries its request,
// so that a process with another scene is detected.
#pragma once

#include <functional>
#include <memory>

#include "core/text_file.h"
#include "farm/transport.h"

namespace glint::farm {

class RecordedFiles : public FileSource {
  public:
    // `publish` gets the stream in pieces of at most 1 MiB, as soon as a file is read.
    RecordedFiles(std::shared_ptr<FileSource> files, std::function<void(const Bytes&)> publish)
        : files_(std::move(files)), publish_(std::move(publish)) {}

    std::string read(const std::filesystem::path& path, const Context& context) override;
    FileStatus status(const std::filesystem::path& path) override;
    std::filesystem::path real(const std::filesystem::path& path) override;

    // Publishes the answers since the last file.
    void flush();

  private:
    template <typename Ask>
    auto answered(uint8_t question, const std::filesystem::path& path, const Ask& ask);
    void append(const Bytes& bytes);

    std::shared_ptr<FileSource> files_;
    std::function<void(const Bytes&)> publish_;
    Bytes pending_;
};

class ReplayedFiles : public FileSource {
  public:
    // `next` waits for the next piece of the stream.
    explicit ReplayedFiles(std::function<Bytes()> next) : next_(std::move(next)) {}

    std::string read(const std::filesystem::path& path, const Context& context) override;
    FileStatus status(const std::filesystem::path& path) override;
    std::filesystem::path real(const std::filesystem::path& path) override;

  private:
    void expect(uint8_t question, const std::filesystem::path& path);
    std::string text();
    template <typename T>
    T number();
    void take(void* to, size_t size);

    std::function<Bytes()> next_;
    Bytes piece_;
    size_t at_ = 0;  // in the piece
};

}  // namespace glint::farm
