#include "core/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <system_error>

#include "core/error.h"
#include "core/staged_file.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int errorNumber) {
    throw Error(ErrorKind::Failed,
                path.string() + ": cannot read: " + std::generic_category().message(errorNumber));
}

}  // namespace

std::vector<uint8_t> readFile(const fs::path& path) {
    // Without O_NONBLOCK the opening of a pipe waits for its writer.
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    struct stat status {};
    if (!file.isOpen() || ::fstat(file.get(), &status) != 0) {
        fail(path, errno);
    }
    if (S_ISDIR(status.st_mode)) {
        fail(path, EISDIR);
    }
    if (!S_ISREG(status.st_mode)) {
        throw Error(ErrorKind::Failed, path.string() + ": cannot read: not a regular file");
    }
    std::vector<uint8_t> bytes;
    size_t size = 0;
    for (;;) {
        // One byte more shows the end. The files of /proc have size 0, whatever they hold.
        bytes.resize(std::max({static_cast<size_t>(status.st_size) + 1, size + size / 2, size_t{4096}}));
        const ssize_t count = ::read(file.get(), bytes.data() + size, bytes.size() - size);
        if (count < 0 && errno != EINTR) {
            fail(path, errno);
        }
        if (count == 0) {
            break;
        }
        size += count > 0 ? static_cast<size_t>(count) : 0;
    }
    bytes.resize(size);
    return bytes;
}

void writeFiles(const std::vector<OutputFile>& files) {
    std::deque<StagedFile> staged;
    std::vector<StagedFile*> all;
    std::vector<std::span<const uint8_t>> bytes;
    for (const OutputFile& file : files) {
        StagedFile& made = staged.emplace_back(file.path);
        if (!made.isDevice()) made.write(file.bytes, 0);
        made.finish();
        all.push_back(&made);
        bytes.emplace_back(file.bytes);
    }
    commitAll(all, bytes);
}

void writeFile(const fs::path& path, std::span<const uint8_t> bytes) {
    StagedFile staged(path);
    if (!staged.isDevice()) staged.write(bytes, 0);
    staged.finish();
    staged.commit(bytes);
}

void writeTextFile(const fs::path& path, const std::string& text) {
    writeFile(path, std::vector<uint8_t>(text.begin(), text.end()));
}

}  // namespace glint
