#include "core/text_file.h"

#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/error.h"

namespace glint {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorKind::Scene, path.string() + ": " + what);
}

}  // namespace

std::string readWholeFile(const std::filesystem::path& path) {
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (status.type() == std::filesystem::file_type::not_found) fail(path, "no such file");
    if (code) fail(path, "cannot be read: " + code.message());
    if (std::filesystem::is_directory(status)) fail(path, "is a folder, not a file");
    // A device or a pipe may never end.
    if (!std::filesystem::is_regular_file(status)) fail(path, "is not a regular file");

    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) fail(path, std::string("cannot be read: ") + std::strerror(errno));
    const auto size = std::filesystem::file_size(path, code);
    if (code) fail(path, "cannot be read: " + code.message());
    std::string bytes(size, '\0');
    bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
    if (bytes.size() != size) fail(path, "cannot be read: the file changed or the disk failed");
    if (bytes.empty()) fail(path, "the file is empty");
    return bytes;
}

std::string printable(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text;
}

std::string describe(double number) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, number);
    return {buffer, end.ptr};
}

std::string escapePointer(std::string_view key) {
    std::string escaped;
    for (const char c : key) {
        if (c == '~')
            escaped += "~0";
        else if (c == '/')
            escaped += "~1";
        else
            escaped += c;
    }
    return escaped;
}

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

}  // namespace glint
