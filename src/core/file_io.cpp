#include "core/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <deque>
#include <system_error>

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
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

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
bool writeAndClose(Descriptor& file, const std::vector<uint8_t>& bytes) {
    size_t written = 0;
    while (written < bytes.size()) {
        const ssize_t count = ::write(file.get(), bytes.data() + written, bytes.size() - written);
        if (count < 0 && errno != EINTR) {
            return false;
        }
        written += count > 0 ? static_cast<size_t>(count) : 0;
    }
    return file.close();
}

fs::path followLinks(const fs::path& path) {
    std::error_code error;
    fs::path target = fs::canonical(path, error);
    return error ? path : target;
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
            if (!device.isOpen() || !writeAndClose(device, output_.bytes)) {
                fail(output_.path, "write", errno);
            }
            return;
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
    void writeTemporary(const struct stat& status) {
        static std::atomic<unsigned> counter{0};
        const fs::path folder = target_.parent_path();
        // Names end at 255 bytes; the process and a counter make the shortened name unique.
        std::string stem(1, '.');
        stem += target_.filename().string().substr(0, 200);
        stem += '.' + std::to_string(::getpid());
        fs::path name;
        int fd = -1;
        do {
            name = folder / (stem + "." + std::to_string(counter++) + ".tmp");
            fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (fd < 0 && errno == EEXIST);
        Descriptor file(fd);
        if (!file.isOpen()) {
            fail(output_.path, "write", errno);
        }
        temporary_ = name;
        if (existed_) {
            // Without success the new file has the mode of any other new file.
            [[maybe_unused]] const int ignored = ::fchmod(file.get(), status.st_mode & 07777);
        }
        if (!writeAndClose(file, output_.bytes)) {
            fail(output_.path, "write", errno);
        }
    }

    const OutputFile& output_;
    fs::path target_;
    fs::path temporary_;  // empty once renamed
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
