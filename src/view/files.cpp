#include "view/files.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "core/file_io.h"
#include "core/format.h"
#include "core/text_file.h"
#include "import/load.h"

namespace glint::view {

namespace {

namespace fs = std::filesystem;

fs::path folderIn(const char* variable) {
    const char* value = std::getenv(variable);
    const fs::path folder = value == nullptr ? "" : value;
    return folder.is_absolute() ? folder : fs::path();
}

bool isThere(const std::string& file) {
    std::error_code error;
    return fs::path(file).is_absolute() && fs::is_regular_file(file, error);
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
    std::error_code gone;
    const Stamp stamp{fs::last_write_time(file, gone), fs::file_size(file, gone)};
    return gone ? Stamp{} : stamp;
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
    constexpr std::string_view kExtensions[] = {".png", ".exr", ".pfm", ".hdr", ".jpg", ".jpeg", ".webp"};
    return std::ranges::find(kExtensions, lowerExtension(file)) != std::end(kExtensions);
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
        else if (isPictureFile(name) || isSceneFile(name))
            files.push_back(name);
    }
    std::sort(folders.begin() + 1, folders.end());
    std::sort(files.begin(), files.end());
    folders.insert(folders.end(), files.begin(), files.end());
    return folders;
}

fs::path claimName(const fs::path& folder, const std::string& stem, const std::string& extension) {
    for (int i = 1; i < 10000; ++i) {
        const fs::path candidate = folder / (stem + format("-view-%03d", i) + extension);
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
    fs::path state = folderIn("XDG_STATE_HOME");
    if (const fs::path home = folderIn("HOME"); state.empty() && !home.empty()) state = home / ".local/state";
    return state.empty() ? state : state / "glint" / name;
}

Remembered::Remembered(fs::path file, bool (*keeps)(const std::string&))
    : file_(std::move(file)), keeps_(keeps) {
    read();
}

// Lines that the file lacks stay: it may be impossible to write.
void Remembered::read() {
    std::vector<std::string> found;
    const auto take = [&](const std::string& line) {
        if (keeps_(line) && std::find(found.begin(), found.end(), line) == found.end()) found.push_back(line);
    };
    std::ifstream in(file_);
    for (std::string line; found.size() < kMost && std::getline(in, line);) take(line);
    for (const std::string& line : lines_) take(line);
    lines_ = std::move(found);
}

void Remembered::add(const std::string& line) {
    read();
    std::erase_if(lines_, [&](const std::string& other) { return other == line || !keeps_(other); });
    lines_.insert(lines_.begin(), line);
    if (lines_.size() > kMost) lines_.resize(kMost);
    if (file_.empty()) return;
    std::error_code error;
    if (!fs::exists(file_.parent_path(), error)) {  // for the owner alone, as the specification requires
        fs::create_directories(file_.parent_path(), error);
        fs::permissions(file_.parent_path(), fs::perms::owner_all, error);
    }
    std::string text;
    for (const std::string& each : lines_) text += each + '\n';
    try {
        writeTextFile(file_, text);
    } catch (const Error&) {
        return;
    }
}

RecentFiles::RecentFiles(const fs::path& file) : Remembered(file, isThere) {}

void RecentFiles::add(const fs::path& scene) {
    std::error_code error;
    const std::string path = fs::absolute(scene, error).lexically_normal().string();
    if (!error && path.find('\n') == std::string::npos) Remembered::add(path);
}

Hints::Hints(const fs::path& file)
    : Remembered(file, [](const std::string& line) { return named<Hint>(line).has_value(); }) {}

bool Hints::done(Hint hint) {
    if (!wanted(hint)) return false;
    add(std::string(nameOf(hint)));
    return !any();
}

void Hints::close() {
    for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>) done(entry.value);
}

}  // namespace glint::view
