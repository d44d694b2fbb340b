#include "view/files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"

namespace glint::view {

namespace {

namespace fs = std::filesystem;

fs::path folderIn(const char* variable) {
    const char* value = std::getenv(variable);
    const fs::path folder = value == nullptr ? "" : value;
    return folder.is_absolute() ? folder : fs::path();
}

bool isThere(const fs::path& file) {
    std::error_code error;
    return file.is_absolute() && fs::is_regular_file(file, error);
}

bool endsIn(const fs::path& file, std::initializer_list<const char*> extensions) {
    return std::find(extensions.begin(), extensions.end(), lowerExtension(file)) != extensions.end();
}

}  // namespace

std::vector<fs::path> sceneFiles(const fs::path& scene, const Scene& read) {
    std::vector<fs::path> files = {scene.lexically_normal()};
    for (const SourceFile& source : read.sources)
        files.push_back((scene.parent_path() / source.name).lexically_normal());
    return files;
}

// Zeros for a file that is not there.
FileWatch::Stamp FileWatch::stampOf(const fs::path& file) {
    std::error_code error;
    const fs::file_time_type time = fs::last_write_time(file, error);
    const std::uintmax_t size = error ? 0 : fs::file_size(file, error);
    return error ? Stamp{} : Stamp{time, size};
}

void FileWatch::watch(const std::vector<fs::path>& files) {
    known_.clear();
    for (const fs::path& file : files) known_[file] = stampOf(file);
    seen_ = known_;
}

bool FileWatch::changed() {
    std::map<fs::path, Stamp> now;
    for (const auto& [file, stamp] : known_) now[file] = stampOf(file);
    const bool settled = now == seen_;
    seen_ = now;
    if (!settled || now == known_) return false;
    known_ = now;
    return true;
}

bool isPictureFile(const fs::path& file) {
    return endsIn(file, {".png", ".exr", ".pfm", ".hdr", ".jpg", ".jpeg", ".webp"});
}

std::vector<std::string> listFiles(const fs::path& folder) {
    std::vector<std::string> folders = {"../"}, files;
    std::error_code error;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        const std::string name = i->path().filename().string();
        std::error_code unknown;
        if (name.starts_with('.')) continue;
        if (i->is_directory(unknown))
            folders.push_back(name + '/');
        else if (isPictureFile(name) ||
                 endsIn(name, {".json", ".gltf", ".glb", ".nff", ".obj", ".ply", ".stl"}))
            files.push_back(name);
    }
    std::sort(folders.begin() + 1, folders.end());
    std::sort(files.begin(), files.end());
    folders.insert(folders.end(), files.begin(), files.end());
    return folders;
}

fs::path claimName(const fs::path& folder, const std::string& stem, const std::string& extension) {
    for (int i = 1; i < 10000; ++i) {
        char number[24];
        std::snprintf(number, sizeof(number), "-view-%03d", i);
        const fs::path candidate = folder / (stem + number + extension);
        // "x": fails if the file exists, without a race.
        if (std::FILE* file = std::fopen(candidate.c_str(), "wx")) {
            std::fclose(file);
            return candidate;
        }
        if (errno != EEXIST) throw Error(ErrorKind::Failed, candidate.string() + ": " + std::strerror(errno));
    }
    throw Error(ErrorKind::Failed, folder.string() + ": holds 9999 saved views of this scene; remove some");
}

fs::path stateFile(const std::string& name) {
    const fs::path state = folderIn("XDG_STATE_HOME");
    if (!state.empty()) return state / "glint" / name;
    const fs::path home = folderIn("HOME");
    return home.empty() ? home : home / ".local" / "state" / "glint" / name;
}

void writeState(const fs::path& file, const std::string& text) {
    if (file.empty()) return;
    std::error_code error;
    if (!fs::exists(file.parent_path(), error)) {  // for the owner alone, as the specification asks
        fs::create_directories(file.parent_path(), error);
        fs::permissions(file.parent_path(), fs::perms::owner_all, error);
    }
    try {
        writeTextFile(file, text);
    } catch (const Error&) {
        return;
    }
}

RecentFiles::RecentFiles(fs::path file) : file_(std::move(file)) {
    read();
}

void RecentFiles::read() {
    std::ifstream lines(file_);
    std::vector<fs::path> found;
    for (std::string line; found.size() < kMost && std::getline(lines, line);)
        if (isThere(line) && std::find(found.begin(), found.end(), line) == found.end())
            found.push_back(line);
    if (!found.empty()) list_ = std::move(found);
}

void RecentFiles::add(const fs::path& scene) {
    std::error_code error;
    const fs::path path = fs::absolute(scene, error).lexically_normal();
    if (error || path.string().find('\n') != std::string::npos) return;
    read();
    std::erase_if(list_, [&](const fs::path& other) { return other == path || !isThere(other); });
    list_.insert(list_.begin(), path);
    if (list_.size() > kMost) list_.resize(kMost);
    std::string text;
    for (const fs::path& line : list_) text += line.string() + '\n';
    writeState(file_, text);
}

Hints::Hints(std::filesystem::path file) : file_(std::move(file)) {
    std::ifstream words(file_);
    for (std::string word; words >> word;)
        if (const auto hint = named<Hint>(word)) done_[static_cast<size_t>(*hint)] = true;
}

bool Hints::any() const {
    return std::find(done_.begin(), done_.end(), false) != done_.end();
}

bool Hints::done(Hint hint) {
    if (!wanted(hint)) return false;
    done_[static_cast<size_t>(hint)] = true;
    remember();
    return !any();
}

void Hints::close() {
    done_.fill(true);
    remember();
}

void Hints::remember() const {
    std::string text;
    for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
        if (!wanted(entry.value)) text += std::string(entry.name) + '\n';
    writeState(file_, text);
}

}  // namespace glint::view
