// Files that appear whole or not at all.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <deque>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace glint {

struct OutputFile {
    std::filesystem::path path;
    std::vector<uint8_t> bytes;
};

// Writes every file whole before the first gets its name, and then renames them: a reader finds the old file
// or the new one. If the file system supports O_TMPFILE, the files have no name while they are written, so
// that nothing stays behind if the process dies. If anything fails, the temporary files are removed, new
// files of this call are removed again, and Error(Failed) is thrown, e.g. "out/x.png: cannot write: there is
// no folder out". A link is followed, even to a file that does not exist yet. A device or pipe (/dev/null) is
// written to and stays what it is. A file without write permission is not replaced.
void writeFiles(const std::vector<OutputFile>& files);

// The same for one file, whose bytes are not copied.
void writeFile(const std::filesystem::path& path, std::span<const uint8_t> bytes);

// The same for one text, e.g. a report.
void writeTextFile(const std::filesystem::path& path, const std::string& text);

// Writes to a descriptor; false with errno set if not every byte could be written. Without an offset for what
// has none.
bool writeBytes(int file, std::span<const uint8_t> bytes, const uint64_t* offset);

// Throws Error(Failed) "PATH: cannot write: REASON" for an error of the system. If a file stands where a
// folder is needed, the reason names that file.
[[noreturn]] void failWriting(const std::filesystem::path& path, int errorNumber);

// ---- A file from its temporary to its final name

// Receives the bytes of a file, in any order.
class ByteSink {
  public:
    virtual ~ByteSink() = default;
    virtual void write(std::span<const uint8_t> bytes, uint64_t offset) = 0;
};

// Write, then name the file by commitAll() (see writeFiles). All members throw Error(Failed).
class StagedFile : public ByteSink {
  public:
    // Makes the file, unless the path is that of a device or pipe.
    explicit StagedFile(const std::filesystem::path& path);
    ~StagedFile() override;
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    // A device or pipe, whose bytes stay in memory until it gets them all at once.
    bool isDevice() const { return isDevice_; }

    void write(std::span<const uint8_t> bytes, uint64_t offset) override;

  private:
    friend void commitAll(std::deque<StagedFile>& files);

    void makeTemporary(const struct stat& status);
    void finish();        // all is written; it goes to the disk
    void commit();        // gives the file its name, a device its bytes
    void revoke() const;  // undoes commit() as far as it can be undone
    void giveName();
    bool close();
    template <typename Make>
    int tryNames(Make make);

    std::filesystem::path path_, target_;
    std::filesystem::path temporary_;  // empty before it has a name, and once it is renamed
    int file_ = -1;                    // descriptor; open until it is committed
    bool nameless_ = false;
    bool existed_ = false;
    bool isDevice_ = false;
    std::vector<uint8_t> forDevice_;
};

// Names all files, which are complete, or none.
void commitAll(std::deque<StagedFile>& files);

}  // namespace glint
