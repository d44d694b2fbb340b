// Whole files in memory, sources of a scene's files, and text for messages about files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/context.h"
#include "core/error.h"

namespace glint {

// The bytes of a regular file that is not empty. Throws an Error of the kind given: "PATH: no such file", "is
// a folder, not a file", "the file is empty" ...
std::string readWholeFile(const std::filesystem::path& path, const Context& context = {},
                          ErrorKind kind = ErrorKind::Scene);

// Throws what readWholeFile throws for a path that is no regular file, without reading it.
void checkFile(const std::filesystem::path& path, ErrorKind kind = ErrorKind::Scene);

struct FileStatus {
    bool exists = false, regular = false;
    uint64_t size = 0;  // of a regular file
};

// Source of a scene's files: the file system, or another rank that reads them. The answers depend on nothing
// but the file system, and a loader makes the same calls in the same order whenever it gets the same answers.
class FileSource {
  public:
    virtual ~FileSource() = default;

    // Reads like readWholeFile.
    virtual std::string read(const std::filesystem::path& path, const Context& context) = 0;
    virtual FileStatus status(const std::filesystem::path& path) = 0;
    // Absolute, with links followed as far as there are files. Throws Error(Scene) "PATH: cannot be read:
    // ...".
    virtual std::filesystem::path real(const std::filesystem::path& path) = 0;
};

std::shared_ptr<FileSource> fileSystem();

// ---- text ----

// Text of a file for use in a message: what would break the line, steer the terminal or turn the direction of
// writing becomes '?', and so do bytes that are not UTF-8. Of more than 4 KiB the middle is left out.
std::string printable(std::string_view text);

// A number as it is shown in messages: the shortest text that reads back as the same.
std::string describe(double number);

// One step of a JSON pointer (RFC 6901): ~ and / written as ~0 and ~1.
std::string escapePointer(std::string_view key);

// The parts as one text: numbers as describe() shows them, strings and characters as they are.
template <typename... Parts>
std::string concat(const Parts&... parts) {
    std::string text;
    const auto append = [&text]<typename Part>(const Part& part) {
        if constexpr (std::is_floating_point_v<Part>)
            text += describe(part);
        else if constexpr (std::is_integral_v<Part> && !std::is_same_v<Part, char>)
            text += std::to_string(part);
        else
            text += part;
    };
    (append(parts), ...);
    return text;
}

// Throws Error(Scene) "FILE: what", `what` being the parts; in printable form.
template <typename... Parts>
[[noreturn]] void failFile(const std::string& file, const Parts&... what) {
    throw Error(ErrorKind::Scene, printable(concat(file, ": ", what...)));
}

// `text` with the letters A to Z in lower case.
std::string lowerCase(std::string_view text);

// The extension in lower case, with its dot.
std::string lowerExtension(const std::filesystem::path& path);

// "1 light", "2 lights"
std::string counted(uint64_t count, const std::string& noun);

// User's text for a message: in quotes, on one line, of at most 60 bytes.
std::string quoted(const std::string& text);

// Without the blanks, tabs and carriage returns around it.
std::string trimmed(const std::string& text);

// The parts between separators, at least one.
std::vector<std::string> split(const std::string& text, char separator);

}  // namespace glint
