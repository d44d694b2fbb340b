#include "core/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <deque>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const char* action, int errorNumber) {
    throw Error(ErrorKind::Failed,
                path.string() + ": cannot " + action + ": " + std::generic_category().message(errorNumber));
}

// A file descriptor that is closed on every way out.
class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) {
            ::close(fd_);
        }
    }
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }

    bool isOpen() const { return fd_ >= 0; }
    int get() const { return fd_; }

    // Network file systems report a full disk only here.
    bool close() {
        const int fd = fd_;
        fd_ = -1;
        return ::close(fd) == 0;
    }

  private:
    int fd_;
};

// False with errno set if not every byte could be written.
bool writeBytes(const Descriptor& file, const std::vector<uint8_t>& bytes) {
    size_t written = 0;
    while (written < bytes.size()) {
        const ssize_t count = ::write(file.get(), bytes.data() + written, bytes.size() - written);
        if (count < 0 && errno != EINTR) {
            return false;
        }
        written += count > 0 ? static_cast<size_t>(count) : 0;
    }
    return true;
}

// To the disk, so that a name never stands for what a power cut has kept from being written. Some file
// systems know no such thing.
bool sync(const Descriptor& file) {
    return ::fsync(file.get()) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP;
}

// Where a link leads, even if there is no file yet. A link in a circle stays: writing it fails.
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

// One output file between its temporary name and its own.
class StagedFile {
  public:
    explicit StagedFile(const OutputFile& output) : output_(output), target_(followLinks(output.path)) {}

    ~StagedFile() {
        if (!temporary_.empty()) {
            ::unlink(temporary_.c_str());
        }
    }
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;

    void write() {
        struct stat status {};
        existed_ = ::stat(target_.c_str(), &status) == 0;
        if (existed_ && S_ISDIR(status.st_mode)) {
            fail(output_.path, "write", EISDIR);
        }
        if (existed_ && ::access(target_.c_str(), W_OK) != 0) {
            fail(output_.path, "write", errno);
        }
        isDevice_ = existed_ && !S_ISREG(status.st_mode);
        if (!isDevice_) {
            writeTemporary(status);
        }
    }

    void commit() {
        if (isDevice_) {
            Descriptor device(::open(target_.c_str(), O_WRONLY | O_CLOEXEC));
            if (!device.isOpen() || !writeBytes(device, output_.bytes) || !device.close()) {
                fail(output_.path, "write", errno);
            }
            return;
        }
        if (nameless_.isOpen()) {
            giveName();
        }
        if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
            fail(output_.path, "write", errno);
        }
        temporary_.clear();
    }

    // Undoes commit() as far as it can be undone.
    void revoke() const {
        if (!existed_) {
            ::unlink(target_.c_str());
        }
    }

  private:
    // A file without a name goes away with the process, whatever ends it (Linux 3.11; not every file system).
    void writeTemporary(const struct stat& status) {
        const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
        nameless_ = Descriptor(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
        Descriptor named(-1);
        if (!nameless_.isOpen()) {
            named = Descriptor(tryNames([](const fs::path& name) {
                return ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            }));
        }
        const Descriptor& file = nameless_.isOpen() ? nameless_ : named;
        if (!file.isOpen()) {
            fail(output_.path, "write", errno);
        }
        if (existed_) {
            // Without success the new file has the mode of any other new file.
            [[maybe_unused]] const int ignored = ::fchmod(file.get(), status.st_mode & 07777);
        }
        if (!writeBytes(file, output_.bytes) || !sync(file)) {
            fail(output_.path, "write", errno);
        }
        if (named.isOpen() && !named.close()) {
            fail(output_.path, "write", errno);
        }
    }

    // Nothing replaces a file but a rename, so the file has another name for a moment.
    void giveName() {
        const std::string self = "/proc/self/fd/" + std::to_string(nameless_.get());
        const int failed = tryNames([&](const fs::path& name) {
            return ::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW);
        });
        if (failed < 0 || !nameless_.close()) {
            fail(output_.path, "write", errno);
        }
    }

    // Calls make(name) with names beside the target until there is no such file yet; `temporary_` is then the
    // name. Less than 0, with errno set, if that fails.
    template <typename Make>
    int tryNames(Make make) {
        static std::atomic<unsigned> counter{0};
        // Names end at 255 bytes; the process and a counter make the shortened name unique.
        std::string stem(1, '.');
        stem += target_.filename().string().substr(0, 200);
        stem += '.' + std::to_string(::getpid());
        for (;;) {
            const fs::path name = target_.parent_path() / (stem + "." + std::to_string(counter++) + ".tmp");
            const int made = make(name);
            if (made < 0 && errno == EEXIST) continue;
            if (made >= 0) temporary_ = name;
            return made;
        }
    }

    const OutputFile& output_;
    fs::path target_;
    fs::path temporary_;  // empty before it has a name, and once it is renamed
    Descriptor nameless_{-1};
    bool existed_ = false;
    bool isDevice_ = false;
};

}  // namespace

std::vector<uint8_t> readFile(const fs::path& path) {
    // Without O_NONBLOCK the opening of a pipe waits for whoever writes to it.
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    struct stat status {};
    if (!file.isOpen() || ::fstat(file.get(), &status) != 0) {
        fail(path, "read", errno);
    }
    if (S_ISDIR(status.st_mode)) {
        fail(path, "read", EISDIR);
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
            fail(path, "read", errno);
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
    for (const OutputFile& file : files) {
        staged.emplace_back(file).write();
    }
    size_t committed = 0;
    try {
        for (; committed < staged.size(); ++committed) {
            staged[committed].commit();
        }
    } catch (const Error&) {
        while (committed > 0) {
            staged[--committed].revoke();
        }
        throw;
    }
}

void writeTextFile(const fs::path& path, const std::string& text) {
    writeFiles({{path, std::vector<uint8_t>(text.begin(), text.end())}});
}

}  // namespace glint
