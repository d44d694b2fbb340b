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

enum class Question : uint8_t;

class RecordedFiles : public FileSource {
  public:
    // `publish` gets each answer, and the bytes of a file in pieces of at most 1 MiB.
    RecordedFiles(std::shared_ptr<FileSource> files, std::function<void(const Bytes&)> publish)
        : files_(std::move(files)), publish_(std::move(publish)) {}

    std::string read(const std::filesystem::path& path, const Context& context) override;
    FileStatus status(const std::filesystem::path& path) override;
    std::filesystem::path real(const std::filesystem::path& path) override;

  private:
    template <typename Ask>
    auto answered(Question question, const std::filesystem::path& path, const Ask& ask);

    std::shared_ptr<FileSource> files_;
    std::function<void(const Bytes&)> publish_;
};

class ReplayedFiles : public FileSource {
  public:
    // `next` waits for the next piece of the stream.
    explicit ReplayedFiles(std::function<Bytes()> next) : next_(std::move(next)) {}

    std::string read(const std::filesystem::path& path, const Context& context) override;
    FileStatus status(const std::filesystem::path& path) override;
    std::filesystem::path real(const std::filesystem::path& path) override;

  private:
    template <typename Answer>
    Answer answer(Question question, const std::filesystem::path& path);

    std::function<Bytes()> next_;
};

}  // namespace glint::farm
