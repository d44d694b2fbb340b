#include "import/scene_files.h"

#include <algorithm>
#include <span>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/format.h"
#include "core/image_io.h"

namespace glint {

namespace {

namespace fs = std::filesystem;

// Triangles take up to 50 times the size of their text, and 100 times that of an index of one byte. Files
// that take more repeat their data, which only small ones may do.
constexpr uint64_t kFreeBytes = uint64_t{256} << 20;
constexpr uint64_t kMostBytesPerByte = 256;

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::Scene, printable(what));
}

std::string mebibytes(uint64_t bytes) {
    return format("%.1f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
}

bool isWithin(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

SceneFiles::SceneFiles(const fs::path& folder, const LoadOptions& options)
    : options_(options), source_(options.source ? options.source : fileSystem()), root_(real(folder)) {}

fs::path SceneFiles::resolve(const fs::path& folder, const std::string& name) const {
    if (name.empty()) fail("the file name is empty");
    if (name.find('\0') != std::string::npos) fail(name + ": no file name holds a zero byte");
    if (name.find("://") != std::string::npos) fail(name.substr(0, 60) + ": URLs are not read, only files");
    const fs::path path = folder / name;
    const fs::path found = real(path);
    if (!options_.allowOutside && !isWithin(found, root_))
        fail(path.string() + ": lies outside the scene's folder (--allow-outside lets such files be read)");
    return path;
}

fs::path SceneFiles::findOrBeside(const fs::path& folder, const std::string& name) const {
    std::string slashed;
    for (const char c : name)
        if (c != '\\' || !slashed.ends_with('/')) slashed += c == '\\' ? '/' : c;
    const std::string own = fs::path(slashed).filename().string();
    const bool beside = !own.empty() && own.find('\0') == own.npos && isFile(folder / own);
    try {
        const fs::path path = resolve(folder, slashed);
        if (!beside || isFile(path)) return path;
    } catch (const Error&) {
        if (!beside) throw;
    }
    return resolve(folder, own);
}

std::string SceneFiles::bytesOf(const fs::path& path) {
    const uint64_t size = source_->status(path).size;
    if (size > memoryLeft())
        fail(path.string() + ": has " + mebibytes(size) + ", more than there is memory for");
    return source_->read(path, context());
}

std::string SceneFiles::read(const fs::path& path) {
    std::string bytes = bytesOf(path);
    read_ += bytes.size();
    note(path, contentHash(bytes));
    return bytes;
}

std::shared_ptr<const Image> SceneFiles::decode(std::string_view bytes, const std::string& name) {
    const std::span<const uint8_t> view(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    auto image = std::make_shared<const Image>(decodeImage(view, name, mostPixels(), context()));
    takePicture(*image);
    return image;
}

std::shared_ptr<const Image> SceneFiles::image(const fs::path& path) {
    const std::string key = real(path).string();
    const auto known = images_.find(key);
    if (known != images_.end()) return known->second;
    if (!exists(path)) fail(path.string() + ": no such file");
    try {
        const auto image = decode(bytesOf(path), path.string());
        images_.emplace(key, image);
        const auto samples = std::as_bytes(std::span(image->pixels));
        note(path, contentHash(std::span(reinterpret_cast<const uint8_t*>(samples.data()), samples.size())));
        return image;
    } catch (const Error& e) {
        throw Error(ErrorKind::Scene, e.what());
    }
}

void SceneFiles::note(const fs::path& path, uint64_t hash) {
    sources_[real(path).lexically_proximate(root_).generic_string()] = hash;
}

std::vector<SourceFile> SceneFiles::sources() const {
    std::vector<SourceFile> list;
    for (const auto& [name, hash] : sources_) list.push_back({name, hash});
    return list;
}

uint64_t SceneFiles::memoryLeft() const {
    return options_.memory - std::min(options_.memory, read_ + pictures_ + taken_);
}

uint64_t SceneFiles::mostPixels() const {
    return std::min<uint64_t>(kMostPixels, memoryLeft() / (4 * sizeof(float)));
}

void SceneFiles::take(uint64_t bytes, const std::string& where) {
    taken_ += std::min(bytes, std::numeric_limits<uint64_t>::max() / 4);
    const uint64_t proportionate = kFreeBytes + kMostBytesPerByte * read_;
    if (taken_ > proportionate)
        fail(where + ": the scene would take more than " + mebibytes(proportionate) +
             " of memory, which is out of all proportion to its files of " + mebibytes(read_));
    if (read_ + pictures_ + taken_ > options_.memory)
        fail(where + ": the scene takes more memory than there is, " + mebibytes(options_.memory));
}

ProgressPart::ProgressPart(SceneFiles& files, double from, double to)
    : context_(files.options_.context), before_(context_) {
    context_ = before_.part(from, to);
}

ProgressPart::ProgressPart(SceneFiles& files, size_t i, size_t count)
    : context_(files.options_.context), before_(context_) {
    context_ = before_.step(i, count);
}

ProgressPart::~ProgressPart() {
    context_ = before_;
}

}  // namespace glint
