#include "import/scene_files.h"

#include <algorithm>
#include <cstdio>
#include <span>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/text_file.h"

namespace glint {

namespace {

namespace fs = std::filesystem;

// Text takes up to some 50 times its size as triangles, and an index of one byte stands for 100 bytes of
// triangle; what takes more repeats itself. Small files may do so.
constexpr uint64_t kFreeBytes = uint64_t{256} << 20;
constexpr uint64_t kMostBytesPerByte = 256;

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::Scene, printable(what));
}

std::string mebibytes(uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.1f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
    return text;
}

// With links followed as far as there are files.
fs::path real(const fs::path& path, const std::string& name) {
    std::error_code code;
    // Absolute, for one that does not exist stays relative else.
    const fs::path whole = fs::absolute(path.empty() ? "." : path);
    fs::path found = fs::canonical(whole, code);
    // This takes any path, and several calls of the system for each of its folders.
    if (code) found = fs::weakly_canonical(whole, code);
    if (code) fail(name + ": cannot be read: " + code.message());
    return found;
}

bool isWithin(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

SceneFiles::SceneFiles(const fs::path& folder, const LoadOptions& options)
    : root_(real(folder, folder.string())), options_(options) {}

fs::path SceneFiles::resolve(const fs::path& folder, const std::string& name) const {
    if (name.find('\0') != std::string::npos) fail(name + ": no file name holds a zero byte");
    if (name.find("://") != std::string::npos) fail(name.substr(0, 60) + ": URLs are not read, only files");
    const fs::path path = folder / name;
    const fs::path found = find(path);
    if (!options_.allowOutside && !isWithin(found, root_))
        fail(path.string() + ": lies outside the scene's folder (--allow-outside lets such files be read)");
    return path;
}

fs::path SceneFiles::find(const fs::path& path) const {
    const fs::path last = path.filename();
    std::error_code code;
    // What is no link lies where its folder does, which is looked for once.
    if (last.empty() || last == "." || last == ".." || fs::is_symlink(fs::symlink_status(path, code)))
        return real(path, path.string());
    if (code && code != std::errc::no_such_file_or_directory && code != std::errc::not_a_directory)
        return real(path, path.string());
    const auto [folder, isNew] = folders_.try_emplace(path.parent_path().string());
    if (isNew) folder->second = real(path.parent_path(), path.string());
    return folder->second / last;
}

std::string SceneFiles::read(const fs::path& path) {
    std::error_code code;
    const auto size = fs::file_size(path, code);
    if (!code && size > options_.memory - std::min(options_.memory, read_ + pictures_ + taken_))
        fail(path.string() + ": has " + mebibytes(size) + ", more than there is memory for");
    std::string bytes = readWholeFile(path);
    read_ += bytes.size();
    note(path, contentHash(bytes));
    return bytes;
}

std::shared_ptr<const Image> SceneFiles::image(const fs::path& path) {
    const std::string key = find(path).string();
    const auto known = images_.find(key);
    if (known != images_.end()) return known->second;
    std::error_code ignored;
    if (!fs::exists(path, ignored)) fail(path.string() + ": no such file");
    try {
        auto image = std::make_shared<const Image>(readImage(path, mostPixels()));
        pictures_ += image->pixels.size() * sizeof(float);
        images_.emplace(key, image);
        const auto samples = std::as_bytes(std::span(image->pixels));
        note(path, contentHash(std::span(reinterpret_cast<const uint8_t*>(samples.data()), samples.size())));
        return image;
    } catch (const Error& e) {
        throw Error(ErrorKind::Scene, e.what());
    }
}

void SceneFiles::note(const fs::path& path, uint64_t hash) {
    sources_[find(path).lexically_proximate(root_).generic_string()] = hash;
}

std::vector<SourceFile> SceneFiles::sources() const {
    std::vector<SourceFile> list;
    for (const auto& [name, hash] : sources_) list.push_back({name, hash});
    return list;
}

uint64_t SceneFiles::mostPixels() const {
    const uint64_t left = options_.memory - std::min(options_.memory, read_ + pictures_ + taken_);
    return std::min<uint64_t>(kMostPixels, left / (4 * sizeof(float)));
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

}  // namespace glint
