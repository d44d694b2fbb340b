#include "view/recent_files.h"

#include <algorithm>
#include <string>

#include "view/state_folder.h"

namespace glint::view {

namespace {

namespace fs = std::filesystem;

bool isThere(const fs::path& file) {
    std::error_code error;
    return file.is_absolute() && fs::is_regular_file(file, error);
}

}  // namespace

RecentFiles::RecentFiles(fs::path file) : file_(std::move(file)) {
    read();
}

void RecentFiles::read() {
    const std::string text = readState(file_);
    if (!text.empty()) list_.clear();
    for (size_t at = 0; at < text.size() && list_.size() < kMost;) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const fs::path path = text.substr(at, end - at);
        at = end + 1;
        if (isThere(path) && std::find(list_.begin(), list_.end(), path) == list_.end())
            list_.push_back(path);
    }
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

}  // namespace glint::view
