#include "view/scene_files.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace glint::view {

namespace {

namespace fs = std::filesystem;

std::string extensionOf(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

class Collector {
  public:
    std::set<fs::path> files;

    void add(const fs::path& path) {
        std::error_code error;
        if (!fs::is_regular_file(path, error) || !files.insert(path.lexically_normal()).second) return;
        const std::string extension = extensionOf(path);
        if (extension == ".json" || extension == ".gltf") addJson(path);
        if (extension == ".obj") addMaterials(path);
    }

  private:
    void addJson(const fs::path& path) {
        std::ifstream in(path);
        const auto json =
            nlohmann::json::parse(in, nullptr, false, true);  // comments allowed; discarded if broken
        if (!json.is_discarded()) visit(json, path.parent_path());
    }

    void visit(const nlohmann::json& json, const fs::path& folder) {
        if (json.is_string()) {
            const auto& text = json.get_ref<const std::string&>();
            // "$schema" and names of materials are no paths with an extension of ours; what is no file is
            // ignored.
            if (text.size() < 4096 && !fs::path(text).extension().empty()) add(folder / text);
        } else if (json.is_structured()) {
            for (const auto& child : json) visit(child, folder);
        }
    }

    void addMaterials(const fs::path& path) {
        std::ifstream in(path);
        for (std::string line; std::getline(in, line);) {
            if (line.rfind("mtllib ", 0) != 0) continue;
            std::string name = line.substr(7);
            while (!name.empty() && std::isspace(static_cast<unsigned char>(name.back()))) name.pop_back();
            add(path.parent_path() / name);
        }
    }
};

}  // namespace

std::vector<fs::path> sceneFiles(const fs::path& scene) {
    Collector collector;
    collector.add(scene);
    collector.files.insert(scene.lexically_normal());  // watched even while it is not there
    return {collector.files.begin(), collector.files.end()};
}

FileWatch::Stamp FileWatch::stampOf(const fs::path& file) {
    std::error_code error;
    Stamp stamp;
    stamp.time = fs::last_write_time(file, error);
    if (error) return {};
    stamp.size = fs::file_size(file, error);
    return error ? Stamp{} : stamp;
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

}  // namespace glint::view
