#include "farm/checkpoint.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <set>
#include <system_error>

#include "core/error.h"
#include "core/file_io.h"

namespace glint::farm {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorKind::Failed, path.string() + ": " + what);
}

std::string reason(int number) {
    return std::generic_category().message(number);
}

// The lock is of the file, not of the name: the name may have come to stand for another one meanwhile.
bool stillNamed(int file, const std::filesystem::path& path) {
    struct stat opened {
    }, named{};
    return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
           opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

}  // namespace

Checkpoint::Checkpoint(const std::filesystem::path& path, const UnitHeader& header,
                       const std::function<void(const UnitResult&)>& found)
    : path_(path) {
    file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) fail(path, "cannot write: " + reason(errno));
    try {
        if (::flock(file_, LOCK_EX | LOCK_NB) != 0 || !stillNamed(file_, path))
            fail(path, "another glint writes this checkpoint");
        if (std::filesystem::file_size(path) == 0) write(encodeHeader(header));
        const auto check = [&](const UnitHeader& there) {
            const std::string other = difference(there.identity, header.identity);
            if (!other.empty())
                fail(path,
                     "is a checkpoint of another render: " + other + "; remove it, or give another name");
        };
        std::set<int> parts;
        const auto add = [&](const UnitResult& result) {
            if (parts.insert(result.part).second) found(result);
        };
        size_ = forEachUnit(path, check, add);
        if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) fail(path, "cannot write: " + reason(errno));
    } catch (...) {
        ::close(file_);
        throw;
    }
}

Checkpoint::~Checkpoint() {
    ::close(file_);
}

void Checkpoint::append(const UnitResult& result) {
    if (!stillNamed(file_, path_)) fail(path_, "was removed or replaced during the render");
    write(encodeUnit(result));
}

void Checkpoint::write(const std::vector<uint8_t>& bytes) {
    if (!writeBytes(file_, bytes, &size_) || ::fdatasync(file_) != 0) {
        const int number = errno;
        if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) {
            // The next open cuts off the rest of the unit.
        }
        fail(path_, "cannot write: " + reason(number));
    }
    size_ += bytes.size();
}

void Checkpoint::remove() {
    std::error_code ignored;
    if (stillNamed(file_, path_))
        std::filesystem::remove(std::filesystem::canonical(path_, ignored), ignored);
}

}  // namespace glint::farm
