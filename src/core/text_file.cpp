#include "core/text_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace glint {

namespace {

namespace fs = std::filesystem;

class FileSystem : public FileSource {
  public:
    std::string read(const fs::path& path, const Context& context) override {
        return readWholeFile(path, context);
    }

    FileStatus status(const fs::path& path) override {
        std::error_code code;
        FileStatus found;
        const fs::file_status status = fs::status(path, code);
        found.exists = fs::exists(status);
        found.regular = fs::is_regular_file(status);
        if (found.regular) found.size = fs::file_size(path, code);
        if (code) found.size = 0;
        return found;
    }

    fs::path real(const fs::path& path) override {
        std::error_code code;
        // weakly_canonical keeps a relative path to a missing file relative.
        const fs::path whole = fs::absolute(path.empty() ? "." : path);
        const fs::path found = fs::weakly_canonical(whole, code);
        if (code)
            throw Error(ErrorKind::Scene, printable(path.string() + ": cannot be read: " + code.message()));
        return found;
    }
};

constexpr size_t kLongestMessage = 4096;  // bytes

// Characters that break lines, control terminals or change the direction of writing. U+0080 to U+009F are
// controls too; U+009B begins a sequence as escape and [ do.
bool steers(uint32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x200e || code == 0x200f ||
           (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

struct Character {
    size_t bytes = 1;
    bool shown = false;
};

// First character of the text, or an unprintable byte if it is not UTF-8.
Character firstCharacter(std::string_view text) {
    constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // of a character of so many bytes
    const auto lead = static_cast<unsigned char>(text[0]);
    if (lead < 0x80) return {1, !steers(lead)};
    const size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || bytes > text.size()) return {};
    uint32_t code = lead & (0x7fu >> bytes);
    for (const char c : text.substr(1, bytes - 1)) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xc0) != 0x80) return {};
        code = code << 6 | (byte & 0x3f);
    }
    const bool isSurrogate = code >= 0xd800 && code < 0xe000;
    if (code < kLeast[bytes] || code > 0x10ffff || isSurrogate) return {};
    return {bytes, !steers(code)};
}

std::string shown(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const Character character = firstCharacter(text);
        result += character.shown ? text.substr(0, character.bytes) : std::string_view("?");
        text.remove_prefix(character.bytes);
    }
    return result;
}

}  // namespace

void checkFile(const fs::path& path, ErrorKind kind) {
    if (path.empty()) throw Error(kind, "the file name is empty");
    const auto fail = [&](const std::string& what) { throw Error(kind, path.string() + ": " + what); };
    std::error_code code;
    const auto status = fs::status(path, code);
    if (status.type() == fs::file_type::not_found) fail("no such file");
    if (code) fail("cannot be read: " + code.message());
    if (fs::is_directory(status)) fail("is a folder, not a file");
    // A device or a pipe may never end.
    if (!fs::is_regular_file(status)) fail("is not a regular file");
}

std::string readWholeFile(const fs::path& path, const Context& context, ErrorKind kind) {
    checkFile(path, kind);
    const auto fail = [&](const std::string& what) { throw Error(kind, path.string() + ": " + what); };
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) fail(std::string("cannot be read: ") + std::strerror(errno));
    struct stat status {};  // of the open file: another program may replace the name's
    if (::fstat(::fileno(file.get()), &status) != 0)
        fail(std::string("cannot be read: ") + std::strerror(errno));
    const auto size = static_cast<size_t>(status.st_size);
    constexpr size_t kPiece = size_t{16} << 20;  // some milliseconds
    std::string bytes;
    bytes.reserve(size);
    for (size_t got = kPiece, done = 0; got == kPiece && done < size; done += got) {
        context.checkCancelled();
        bytes.resize(std::min<size_t>(size, done + kPiece));
        got = std::fread(bytes.data() + done, 1, bytes.size() - done, file.get());
        bytes.resize(done + got);
    }
    if (bytes.size() != size) fail("cannot be read: the file changed or the disk failed");
    if (bytes.empty()) fail("the file is empty");
    return bytes;
}

std::shared_ptr<FileSource> fileSystem() {
    return std::make_shared<FileSystem>();
}

std::string printable(std::string_view text) {
    if (text.size() <= kLongestMessage) return shown(text);
    // Keep the end of a long message: the problem follows the name.
    constexpr size_t kHalf = kLongestMessage / 2;
    return shown(text.substr(0, kHalf)) + " ... " + shown(text.substr(text.size() - kHalf));
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

std::string lowerCase(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

std::string lowerExtension(const fs::path& path) {
    return lowerCase(path.extension().string());
}

std::string counted(uint64_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string quoted(const std::string& text) {
    constexpr size_t kLongest = 60;
    return '"' + printable(text.substr(0, kLongest)) + (text.size() > kLongest ? "...\"" : "\"");
}

std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    size_t start = 0;
    for (size_t end = 0; end != std::string::npos; start = end + 1) {
        end = text.find(separator, start);
        parts.push_back(text.substr(start, end - start));
    }
    return parts;
}

}  // namespace glint
