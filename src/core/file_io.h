// Whole files: read at once, written so that they appear whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace glint {

// Throws Error(Failed), e.g. "sky.hdr: cannot read: No such file or directory". Pipes and devices, which may
// wait or go on for ever, are refused.
std::vector<uint8_t> readFile(const std::filesystem::path& path);

struct OutputFile {
    std::filesystem::path path;
    std::vector<uint8_t> bytes;
};

// Writes every file whole before the first gets its name, and renames them then: a reader sees the old file
// or the new one. Where the file system can (O_TMPFILE) the files have no name while they are written, so
// that nothing stays behind whatever ends the process. If anything fails, the temporary files are removed,
// new files of this call are removed again, and Error(Failed) is thrown, e.g. "out/x.png: cannot write: No
// such file or directory". A link is followed, even where there is no file yet; a device or pipe (/dev/null)
// is written to and stays what it is; a file without write permission is not replaced.
void writeFiles(const std::vector<OutputFile>& files);

// The same for one file, whose bytes are not copied.
void writeFile(const std::filesystem::path& path, std::span<const uint8_t> bytes);

// The same for one text, e.g. a report.
void writeTextFile(const std::filesystem::path& path, const std::string& text);

}  // namespace glint
