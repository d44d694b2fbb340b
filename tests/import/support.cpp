#include "support.h"

#include <algorithm>
#include <regex>

namespace glint::test {

std::string errorOf(const std::function<void()>& action) {
    return std::regex_replace(placedErrorOf(action), std::regex(":[0-9]+:[0-9]+(: /)"), "$1");
}

std::string placedErrorOf(const std::function<void()>& action) {
    return errorOf(ErrorKind::Scene, action);
}

Scene parse(const std::string& text) {
    return parseScene(text, "s.json", {});
}

std::string parseErrorOf(const std::string& text) {
    return errorOf([&] { parse(text); });
}

std::vector<Shape> shapesOf(const Scene& scene) {
    std::vector<Shape> shapes;
    for (const Object& object : scene.objects) shapes.push_back(object.shape);
    return shapes;
}

const Mesh& meshOf(const Scene& scene, size_t object) {
    return *std::get<MeshShape>(scene.objects.at(object).shape).mesh;
}

namespace {

void removePath(const std::filesystem::path& path, std::vector<std::string>& warnings) {
    const std::string prefix = path.string() + ": ";
    for (std::string& line : warnings) {
        EXPECT_STARTS(line, prefix);
        line = line.substr(std::min(prefix.size(), line.size()));
    }
}

}  // namespace

Scene OneFile::scene(const std::string& bytes) const {
    Scene scene = loadScene(folder_.write(path_.filename(), bytes));
    removePath(path_, scene.warnings);
    return scene;
}

ImportedMesh OneFile::mesh(const std::string& bytes) const {
    ImportedMesh imported = importMesh(folder_.write(path_.filename(), bytes));
    removePath(path_, imported.warnings);
    return imported;
}

std::string OneFile::error(const std::string& bytes) const {
    folder_.write(path_.filename(), bytes);
    const std::string message = errorOf([&] { loadScene(path_); });
    return message.substr(message.starts_with(path_.string()) ? path_.string().size() : 0);
}

const char* const kCubeObj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

}  // namespace glint::test
