// Whole files: read at once, written so that they appear whole or not at all.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace glint {

// Like readWholeFile (core/text_file.h), but throws Error(Failed).
std::vector<uint8_t> readFile(const std::filesystem::path& path);

struct OutputFile {
    std::filesystem::path path;
    std::vector<uint8_t> bytes;
};

// Writes every file whole before the first gets its name, and renames them then: a reader sees the old file
// or the new one. Where the file system can (O_TMPFILE) the files have no name while they are written, so
// that nothing stays behind whatever ends the process. If anything fails, the temporary files are removed,
// new files of this call are removed again, and Error(Failed) is thrown, e.g. "out/x.png: cannot write: there
// is no folder out". A link is followed, even where there is no file yet; a device or pipe (/dev/null)
// is written to and stays what it is; a file without write permission is not replaced.
void writeFiles(const std::vector<OutputFile>& files);

// The same for one file, whose bytes are not copied.
void writeFile(const std::filesystem::path& path, std::span<const uint8_t> bytes);

// The same for one text, e.g. a report.
void writeTextFile(const std::filesystem::path& path, const std::string& text);

// ---- A file from its temporary to its final name

// Write in any order, then name the file (see writeFiles). All members throw Error(Failed).
class StagedFile {
  public:
    // Makes the file, unless the path is that of a device or pipe.
    explicit StagedFile(const std::filesystem::path& path);
    ~StagedFile();
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    // A device or pipe, which takes all its bytes at once, by commit().
    bool isDevice() const { return isDevice_; }

    void write(std::span<const uint8_t> bytes, uint64_t offset);
    // All is written; it goes to the disk.
    void finish();
    // Gives the file its name; `bytes` are those for a device.
    void commit(std::span<const uint8_t> bytes = {});
    // Undoes commit() as far as it can be undone.
    void revoke() const;

  private:
    void makeTemporary(const struct stat& status);
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
};

// Commits all files or none. `bytes`: of each file, for devices; may be empty.
void commitAll(const std::vector<StagedFile*>& files,
               const std::vector<std::span<const uint8_t>>& bytes = {});

}  // namespace glint
