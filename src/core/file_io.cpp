#include "core/file_io.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOwnFiles = "/proc/self/fd";

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
    throw Error(ErrorKind::Failed, path.string() + ": cannot write: " + reason);
}

std::string reasonOf(fs::path path, int errorNumber) {
    if (errorNumber != ENOTDIR) return std::generic_category().message(errorNumber);
    std::error_code unknown;
    while (path.has_parent_path() && !fs::exists(path, unknown)) path = path.parent_path();
    return path.string() + " is not a folder";
}

// Flushes a file to the disk, so that no name refers to contents that a power cut has lost. Some file systems
// do not support it.
bool sync(int file) {
    return ::fsync(file) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP;
}

// Target of a link, even if there is no file yet. A circular link stays: writing it fails.
fs::path followLinks(const fs::path& path) {
    constexpr int kMostLinks = 40;  // as many as Linux follows
    std::error_code error;
    fs::path target = path;
    for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(target, error)); ++i) {
        const fs::path next = fs::read_symlink(target, error);
        if (error) break;
        target = target.parent_path() / next;
    }
    return target;
}

}  // namespace

bool writeBytes(int file, std::span<const uint8_t> bytes, const uint64_t* offset) {
    size_t written = 0;
    while (written < bytes.size()) {
        const uint8_t* const from = bytes.data() + written;
        const size_t left = bytes.size() - written;
        const ssize_t count = offset ? ::pwrite(file, from, left, static_cast<off_t>(*offset + written))
                                     : ::write(file, from, left);
        if (count < 0 && errno != EINTR) return false;
        written += count > 0 ? static_cast<size_t>(count) : 0;
    }
    return true;
}

void failWriting(const fs::path& path, int errorNumber) {
    fail(path, reasonOf(path, errorNumber));
}

StagedFile::StagedFile(const fs::path& path) : path_(path), target_(followLinks(path)) {
    struct stat status {};
    existed_ = ::stat(target_.c_str(), &status) == 0;
    if (!existed_ && errno != ENOENT) fail(path_, reasonOf(target_, errno));
    if (existed_ && S_ISDIR(status.st_mode)) failWriting(path_, EISDIR);
    if (existed_ && ::access(target_.c_str(), W_OK) != 0) failWriting(path_, errno);
    isDevice_ = existed_ && !S_ISREG(status.st_mode);
    if (!isDevice_) makeTemporary(status);
}

StagedFile::~StagedFile() {
    close();
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

// A file without a name vanishes with the process, even if it crashes (Linux 3.11; not every file system). It
// gets a name by way of /proc, which a bare chroot may lack.
void StagedFile::makeTemporary(const struct stat& status) {
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    if (std::error_code unknown; !fs::exists(folder, unknown) && !unknown)
        fail(path_, "there is no folder " + folder.string());
    if (::access(kOwnFiles, X_OK) == 0)
        file_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    nameless_ = file_ >= 0;
    if (!nameless_)
        file_ = tryNames([](const fs::path& name) {
            return ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        });
    if (file_ < 0) failWriting(path_, errno);
    if (existed_) {
        // Without success the new file has the mode of any other new file.
        [[maybe_unused]] const int ignored = ::fchmod(file_, status.st_mode & 07777);
    }
}

void StagedFile::write(std::span<const uint8_t> bytes, uint64_t offset) {
    if (isDevice_) {
        forDevice_.resize(std::max<size_t>(forDevice_.size(), offset + bytes.size()));
        std::copy(bytes.begin(), bytes.end(), forDevice_.begin() + static_cast<std::ptrdiff_t>(offset));
    } else if (!writeBytes(file_, bytes, &offset)) {
        failWriting(path_, errno);
    }
}

void StagedFile::finish() {
    if (isDevice_) return;
    if (!sync(file_) || (!nameless_ && !close())) failWriting(path_, errno);
}

void StagedFile::commit() {
    if (isDevice_) {
        file_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        if (file_ < 0 || !writeBytes(file_, forDevice_, nullptr) || !close()) failWriting(path_, errno);
        return;
    }
    if (nameless_) giveName();
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) failWriting(path_, errno);
    temporary_.clear();
}

void StagedFile::revoke() const {
    if (!existed_) ::unlink(target_.c_str());
}

// Nothing replaces a file but a rename, so the file has another name for a moment.
void StagedFile::giveName() {
    const std::string self = std::string(kOwnFiles) + "/" + std::to_string(file_);
    const int failed = tryNames([&](const fs::path& name) {
        return ::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW);
    });
    if (failed < 0 || !close()) failWriting(path_, errno);
}

// False with errno set if the file was open and has failed: network file systems report a full disk only
// here.
bool StagedFile::close() {
    return file_ < 0 || ::close(std::exchange(file_, -1)) == 0;
}

// Calls make(name) with names beside the target until one is free; `temporary_` is then that name. Less than
// 0, with errno set, if that fails.
template <typename Make>
int StagedFile::tryNames(Make make) {
    static std::atomic<unsigned> counter{0};
    // Names end at 255 bytes; the process and a counter make the shortened name unique.
    std::string stem(1, '.');
    stem += target_.filename().string().substr(0, 200);
    stem += '.' + std::to_string(::getpid());
    for (;;) {
        // Stored first, so that the destructor can remove the file even if something fails after its
        // creation.
        temporary_ = target_.parent_path() / (stem + "." + std::to_string(counter++) + ".tmp");
        const int made = make(temporary_);
        if (made >= 0) return made;
        const int error = errno;
        temporary_.clear();
        errno = error;
        if (error != EEXIST) return made;
    }
}

void commitAll(std::deque<StagedFile>& files) {
    for (StagedFile& file : files) file.finish();
    size_t committed = 0;
    try {
        for (; committed < files.size(); ++committed) files[committed].commit();
    } catch (const Error&) {
        while (committed > 0) files[--committed].revoke();
        throw;
    }
}

void writeFiles(const std::vector<OutputFile>& files) {
    std::deque<StagedFile> staged;
    for (const OutputFile& file : files) staged.emplace_back(file.path).write(file.bytes, 0);
    commitAll(staged);
}

void writeFile(const fs::path& path, std::span<const uint8_t> bytes) {
    std::deque<StagedFile> staged;
    staged.emplace_back(path).write(bytes, 0);
    commitAll(staged);
}

void writeTextFile(const fs::path& path, const std::string& text) {
    writeFile(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

}  // namespace glint
