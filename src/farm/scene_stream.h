// The files of a scene on their way from the process that reads them to others, which need not see them.
//
// Reading a scene asks a file source in an order that depends on nothing but the answers. So whoever reads
// the files writes all answers down, errors too, and the others get the same answers to the same questions;
// what is asked otherwise is found out, by the question that stands with each answer.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "core/file_source.h"

namespace glint::farm {

using Bytes = std::shared_ptr<const std::vector<uint8_t>>;

class RecordedFiles : public FileSource {
  public:
    // `publish` gets the stream piece by piece, as soon as a file is read.
    RecordedFiles(std::shared_ptr<FileSource> files, std::function<void(Bytes)> publish);

    std::string read(const std::filesystem::path& path) override;
    FileStatus status(const std::filesystem::path& path) override;
    std::filesystem::path real(const std::filesystem::path& path) override;

    // Publishes what has not been, for want of a file. From any thread.
    void flush();

  private:
    template <typename Ask>
    auto answered(uint8_t question, const std::filesystem::path& path, const Ask& ask);
    void append(const std::vector<uint8_t>& bytes);
    void publishPending();

    std::shared_ptr<FileSource> files_;
    std::function<void(Bytes)> publish_;
    std::mutex mutex_;  // guards what follows, and the order of pieces
    std::vector<uint8_t> pending_;
};

class ReplayedFiles : public FileSource {
  public:
    // `next` waits for the next piece of the stream.
    explicit ReplayedFiles(std::function<Bytes()> next) : next_(std::move(next)) {}

    std::string read(const std::filesystem::path& path) override;
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
