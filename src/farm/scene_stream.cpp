#include "farm/scene_stream.h"

#include <string_view>

#include "core/error.h"
#include "farm/bytes.h"

namespace glint::farm {

void fields(ByteWriter& out, const std::filesystem::path& path) {
    out(path.string());
}
void fields(ByteReader& in, std::filesystem::path& path) {
    std::string text;
    in(text);
    path = text;
}
void fields(auto& io, Is<FileStatus> auto& status) {
    io(status.exists, status.regular, status.size);
}

namespace {

namespace fs = std::filesystem;

constexpr size_t kPiece = size_t{1} << 20;

}  // namespace

enum class Question : uint8_t { Read = 1, Status, Real };

// One message: question, path, and the answer or the error.
template <typename Ask>
auto RecordedFiles::answered(Question question, const fs::path& path, const Ask& ask) {
    ByteWriter out;
    out(question, path);
    try {
        auto answer = ask();
        out(true, answer);
        publish_(out.take());
        return answer;
    } catch (const Error& error) {
        out(false, error.kind(), std::string(error.what()));
        publish_(out.take());
        throw;
    }
}

std::string RecordedFiles::read(const fs::path& path, const Context& context) {
    std::string bytes;
    answered(Question::Read, path, [&] {
        bytes = files_->read(path, context);
        return uint64_t{bytes.size()};
    });
    for (size_t at = 0; at < bytes.size(); at += kPiece) {
        const std::string_view piece = std::string_view(bytes).substr(at, kPiece);
        publish_({piece.begin(), piece.end()});
    }
    return bytes;
}

FileStatus RecordedFiles::status(const fs::path& path) {
    return answered(Question::Status, path, [&] { return files_->status(path); });
}

fs::path RecordedFiles::real(const fs::path& path) {
    return answered(Question::Real, path, [&] { return files_->real(path); });
}

template <typename Answer>
Answer ReplayedFiles::answer(Question question, const fs::path& path) {
    const Bytes message = next_();
    ByteReader in(message);
    Question asked{};
    fs::path name;
    bool known = false;
    in(asked, name, known);
    if (asked != question || name != path)
        throw Error(ErrorKind::Failed, path.string() + ": is read where rank 0 read " + name.string() +
                                           ": the processes do not render the same image");
    if (!known) {
        ErrorKind kind{};
        std::string text;
        in(kind, text);
        throw Error(kind, text);
    }
    Answer answer{};
    in(answer);
    return answer;
}

std::string ReplayedFiles::read(const fs::path& path, const Context&) {
    std::string bytes;
    for (const auto size = answer<uint64_t>(Question::Read, path); bytes.size() < size;) {
        const Bytes piece = next_();
        bytes.append(piece.begin(), piece.end());
    }
    return bytes;
}

FileStatus ReplayedFiles::status(const fs::path& path) {
    return answer<FileStatus>(Question::Status, path);
}

fs::path ReplayedFiles::real(const fs::path& path) {
    return answer<fs::path>(Question::Real, path);
}

}  // namespace glint::farm
