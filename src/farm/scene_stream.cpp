#include "farm/scene_stream.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "farm/bytes.h"

namespace glint::farm {

void fields(ByteWriter& out, const std::filesystem::path& path) {
    out(path.string());
}
void fields(ByteWriter& out, const FileStatus& status) {
    out(status.exists, status.regular, status.size);
}

namespace {

namespace fs = std::filesystem;

constexpr size_t kPiece = size_t{1} << 20;
constexpr uint8_t kRead = 1, kStatus = 2, kReal = 3;
constexpr uint8_t kFailed = 0, kAnswered = 1;

}  // namespace

void RecordedFiles::append(const Bytes& bytes) {
    for (size_t at = 0; at < bytes.size();) {
        const size_t size = std::min(kPiece - pending_.size(), bytes.size() - at);
        const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        pending_.insert(pending_.end(), from, from + static_cast<std::ptrdiff_t>(size));
        at += size;
        if (pending_.size() == kPiece) flush();
    }
}

void RecordedFiles::flush() {
    if (!pending_.empty()) publish_(std::exchange(pending_, {}));
}

template <typename Ask>
auto RecordedFiles::answered(uint8_t question, const fs::path& path, const Ask& ask) {
    ByteWriter out;
    out(question, path.string());
    try {
        auto answer = ask();
        out(kAnswered, answer);
        append(out.take());
        return answer;
    } catch (const Error& error) {
        out(kFailed, error.kind(), std::string(error.what()));
        append(out.take());
        flush();
        throw;
    }
}

std::string RecordedFiles::read(const fs::path& path, const Context& context) {
    std::string bytes = answered(kRead, path, [&] { return files_->read(path, context); });
    flush();
    return bytes;
}

FileStatus RecordedFiles::status(const fs::path& path) {
    return answered(kStatus, path, [&] { return files_->status(path); });
}

fs::path RecordedFiles::real(const fs::path& path) {
    return answered(kReal, path, [&] { return files_->real(path); });
}

void ReplayedFiles::take(void* to, size_t size) {
    for (auto* out = static_cast<uint8_t*>(to); size > 0;) {
        if (at_ == piece_.size()) {
            piece_ = next_();
            at_ = 0;
            continue;
        }
        const size_t count = std::min(size, piece_.size() - at_);
        std::memcpy(out, piece_.data() + at_, count);
        at_ += count;
        out += count;
        size -= count;
    }
}

template <typename T>
T ReplayedFiles::number() {
    T value{};
    take(&value, sizeof(T));
    return value;
}

std::string ReplayedFiles::text() {
    std::string text(number<uint64_t>(), '\0');
    take(text.data(), text.size());
    return text;
}

void ReplayedFiles::expect(uint8_t question, const fs::path& path) {
    const auto asked = number<uint8_t>();
    const std::string name = text();
    if (asked != question || name != path.string())
        throw Error(ErrorKind::Failed, path.string() + ": is read where rank 0 read " + name +
                                           ": the processes do not render the same image");
    if (number<uint8_t>() == kAnswered) return;
    const auto kind = number<ErrorKind>();
    throw Error(kind, text());
}

std::string ReplayedFiles::read(const fs::path& path, const Context&) {
    expect(kRead, path);
    return text();
}

FileStatus ReplayedFiles::status(const fs::path& path) {
    expect(kStatus, path);
    FileStatus status;
    status.exists = number<uint8_t>() != 0;
    status.regular = number<uint8_t>() != 0;
    status.size = number<uint64_t>();
    return status;
}

fs::path ReplayedFiles::real(const fs::path& path) {
    expect(kReal, path);
    return text();
}

}  // namespace glint::farm
