// OBJ polygons (Wavefront, Advanced Visualizer manual, appendix B1). tinyobjloader is no substitute: it reads
// "x" and "0,8" as 0, accepts indices beyond the arrays, reports no line numbers, and its numbers differ from
// the correctly rounded ones in the last bits.
#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>

#include "core/error.h"
#include "core/text_file.h"
#include "import/mesh_builder.h"
#include "import/readers.h"
#include "import/text_scanner.h"
#include "scene/limits.h"

namespace glint {

namespace {

constexpr int64_t kNone = -1;
constexpr int64_t kMissing = int64_t{1} << 40;  // index into a list that is still empty
constexpr Color kWhite = MeshBuilder::kNoColor;

// Indices of a face corner by kind. They count from 0 and may be out of range, as a face may come before its
// vertices.
enum Kind { kVertex, kUv, kNormal };
constexpr const char* kKinds[] = {"vertex", "texture vertex", "normal"};
using Corner = std::array<int64_t, 3>;

struct Face {
    size_t firstCorner;
    size_t cornerCount;
    size_t line;
    uint32_t material;
};

class ObjReader {
  public:
    ObjReader(const std::filesystem::path& path, SceneFiles& files)
        : path_(path),
          files_(files),
          text_(files.read(path)),
          scanner_(files.context(), text_, path.string(), 1, true) {}

    ImportedMesh read() {
        {
            const ProgressPart part(files_, 0, kRead);
            while (scanner_.nextLine()) readLine();
        }
        checkIndices();
        resolveMaterials();
        builder_.colorCodes = MeshBuilder::ColorCodes::Srgb;  // as MeshLab, Blender and others mean them
        if (!builder_.colors.empty()) builder_.colors.resize(builder_.positions.size(), kWhite);
        const ProgressPart part(files_, kRead, 1);
        builder_.reserve(faces_.size());
        for (size_t i = 0; i < faces_.size(); i++) {
            files_.context().pace(i, faces_.size());
            addFace(faces_[i]);
        }
        ignored_.warn(path_.string(), warnings_);
        ImportedMesh imported = builder_.finish(path_.string(), std::move(materials_), std::move(warnings_));
        imported.textures = std::move(textures_);
        return imported;
    }

  private:
    static constexpr double kRead = 0.8;  // part of the time for reading lines

    void readLine() {
        const std::string_view keyword = scanner_.word();
        if (keyword == "v") {
            const double x = scanner_.number("a vertex"), y = scanner_.number("a vertex");
            builder_.positions.emplace_back(x, y, scanner_.number("a vertex"));
            readColor();
        } else if (keyword == "vt") {
            const double u = scanner_.number("a texture vertex");
            // v may be missing, a third coordinate may follow.
            builder_.uvs.emplace_back(u, scanner_.lineDone() ? 0 : scanner_.number("a texture vertex"));
        } else if (keyword == "vn") {
            const double x = scanner_.number("a normal"), y = scanner_.number("a normal");
            builder_.normals.emplace_back(x, y, scanner_.number("a normal"));
        } else if (keyword == "f" || keyword == "fo") {  // fo: the old word for f
            readFace();
        } else if (keyword == "usemtl") {
            useMaterial(std::string(scanner_.restOfLine()));
        } else if (keyword == "mtllib") {
            readLibraries();
        } else if (!keyword.empty() && keyword != "o" && keyword != "g" && keyword != "s") {
            ignored_.add(keyword);  // lines, curves, and what is no OBJ
        }
    }

    // Three numbers or more after a vertex are its colour (ZBrush, MeshLab); a single one is a weight.
    void readColor() {
        double rgb[3] = {};
        size_t count = 0;
        while (!scanner_.lineDone()) {
            const double number = scanner_.number("a vertex");
            if (count < 3) rgb[count] = number;
            count++;
        }
        if (count < 3) return;
        builder_.colors.resize(builder_.positions.size() - 1, kWhite);
        builder_.colors.emplace_back(rgb[0], rgb[1], rgb[2]);
    }

    void readFace() {
        Face face{corners_.size(), 0, scanner_.line(), material_};
        for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word())
            corners_.push_back(readCorner(word));
        face.cornerCount = corners_.size() - face.firstCorner;
        if (face.cornerCount > kMaxPolygonCorners)
            scanner_.fail("face has " + std::to_string(face.cornerCount) + " vertices, the limit is " +
                          std::to_string(kMaxPolygonCorners));
        faces_.push_back(face);
    }

    // v, v/vt, v//vn or v/vt/vn. Some exporters write slashes without an index; these are accepted.
    Corner readCorner(std::string_view word) {
        Corner corner = {kNone, kNone, kNone};
        const char* at = word.data();
        const char* end = at + word.size();
        const auto slash = [&] { return at < end && *at == '/' && ++at < end; };
        corner[kVertex] = readIndex(at, end, word, kVertex);
        if (slash()) {
            if (*at != '/') corner[kUv] = readIndex(at, end, word, kUv);
            if (slash()) corner[kNormal] = readIndex(at, end, word, kNormal);
        }
        if (at != end) badCorner(word);
        return corner;
    }

    // Items of a kind so far.
    int64_t countOf(size_t kind) const {
        return static_cast<int64_t>(kind == kVertex ? builder_.positions.size()
                                    : kind == kUv   ? builder_.uvs.size()
                                                    : builder_.normals.size());
    }

    // An index that ends at a slash or at the word's end, counted from 0.
    int64_t readIndex(const char*& at, const char* end, std::string_view word, Kind kind) {
        int64_t index = 0;
        const auto [stop, error] = std::from_chars(at, end, index);
        if (error != std::errc() || (stop != end && *stop != '/')) badCorner(word);
        at = stop;
        if (index > 0) return index - 1;
        const int64_t have = countOf(kind);  // negative indices count back from the last one so far
        if (index < 0 && index >= -have) return have + index;
        if (index < 0 && have == 0 && !builder_.positions.empty()) return kMissing;
        scanner_.fail(
            std::string("face uses ") + kKinds[kind] + " " + std::to_string(index) +
            (index == 0 ? ", indices start at 1" : ", there are " + std::to_string(have) + " so far"));
    }

    [[noreturn]] void badCorner(std::string_view word) const {
        scanner_.fail("\"" + std::string(word.substr(0, 40)) +
                      "\" is not a face vertex (v, v/vt, v//vn or v/vt/vn)");
    }

    // A library may follow the first use of its materials, so names become indices at the end.
    void useMaterial(const std::string& name) {
        const auto [use, isNew] = useOf_.try_emplace(name, static_cast<uint32_t>(uses_.size()));
        if (isNew) uses_.emplace_back(scanner_.line(), name);
        material_ = use->second;
    }

    void resolveMaterials() {
        std::vector<uint32_t> indices(uses_.size(), Mesh::kNoIndex);
        for (size_t i = 0; i < uses_.size(); i++) {
            const auto& [line, name] = uses_[i];
            const auto known = materialIndices_.find(name);
            if (known != materialIndices_.end())
                indices[i] = known->second;
            else
                warn(line, "material \"" + name + "\" is not defined in a material file; grey is used");
        }
        for (Face& face : faces_)
            if (face.material != Mesh::kNoIndex) face.material = indices[face.material];
    }

    void warn(size_t line, const std::string& what) {
        warnings_.push_back(printable(path_.string() + ":" + std::to_string(line) + ": " + what));
    }

    // Reads the libraries of a line: one file, whose name may hold blanks, or several.
    void readLibraries() {
        TextScanner words = scanner_;
        const std::string names(scanner_.restOfLine());
        if (readLibrary(names, names.find_first_of(" \t") == names.npos)) return;
        for (std::string_view name = words.word(); !name.empty(); name = words.word())
            readLibrary(std::string(name), true);
    }

    // Reads a material library once, under whatever name. If its file does not exist: a warning with `warns`,
    // otherwise false.
    bool readLibrary(const std::string& name, bool warns) {
        if (libraries_.contains(name)) return true;
        std::string text;
        std::filesystem::path file;
        try {
            file = files_.findOrBeside(path_.parent_path(), name);
            if (!warns && !files_.isFile(file)) return false;
            if (!libraries_.insert(file.lexically_normal()).second) return true;
            text = files_.read(file);
        } catch (const Error& error) {
            libraries_.insert(name);
            warn(scanner_.line(), error.what() + std::string("; drawn without these materials"));
            return true;
        }
        const size_t first = materials_.size();
        readMtl(text, file, files_, materials_, textures_, warnings_);
        for (size_t i = first; i < materials_.size(); i++)  // the first definition counts
            materialIndices_.emplace(materials_[i].name, static_cast<uint32_t>(i));
        return true;
    }

    // Faces may name texture vertices and normals that the file leaves out altogether.
    void dropMissing(Kind kind, const char* what) {
        const auto names = [&](const Corner& corner) { return corner[kind] != kNone; };
        if (std::none_of(corners_.begin(), corners_.end(), names)) return;
        for (Corner& corner : corners_) corner[kind] = kNone;
        warnings_.push_back(path_.string() + ": faces name " + what +
                            ", but the file has none; drawn without them");
    }

    void checkIndices() {
        if (builder_.uvs.empty()) dropMissing(kUv, "texture vertices (vt)");
        if (builder_.normals.empty()) dropMissing(kNormal, "normals (vn)");
        for (const Face& face : faces_)
            for (size_t i = face.firstCorner; i < face.firstCorner + face.cornerCount; i++)
                for (const Kind kind : {kVertex, kUv, kNormal})
                    if (corners_[i][kind] >= countOf(kind))
                        scanner_.failAt(face.line, std::string("face uses ") + kKinds[kind] + " " +
                                                       std::to_string(corners_[i][kind] + 1) +
                                                       ", the file has " + std::to_string(countOf(kind)));
        for (const Kind kind : {kVertex, kUv, kNormal})
            if (countOf(kind) >= int64_t{Mesh::kNoIndex}) scanner_.fail("more than 2^32 - 2 vertices");
    }

    void addFace(const Face& face) {
        for (const Kind kind : {kVertex, kUv, kNormal}) {
            std::vector<uint32_t>& list = scratch_[kind];
            list.clear();
            for (size_t i = face.firstCorner; i < face.firstCorner + face.cornerCount; i++)
                if (corners_[i][kind] != kNone) list.push_back(static_cast<uint32_t>(corners_[i][kind]));
            if (list.size() != face.cornerCount) list.clear();  // some have none: flat
        }
        MeshBuilder::Corners corners{scratch_[kVertex], scratch_[kNormal], scratch_[kUv]};
        if (!builder_.colors.empty()) corners.colors = scratch_[kVertex];
        builder_.addPolygon(corners, face.material);
    }

    std::filesystem::path path_;
    SceneFiles& files_;
    std::string text_;
    TextScanner scanner_;
    MeshBuilder builder_;
    std::vector<Corner> corners_;
    std::vector<Face> faces_;
    std::vector<Material> materials_;
    std::vector<Texture> textures_;
    std::set<std::filesystem::path> libraries_;  // that were looked for
    std::map<std::string, uint32_t> materialIndices_;
    std::vector<std::pair<size_t, std::string>> uses_;  // of materials: line of the first one, and name
    std::map<std::string, uint32_t> useOf_;
    IgnoredNames ignored_;
    std::vector<std::string> warnings_;
    uint32_t material_ = Mesh::kNoIndex;
    std::array<std::vector<uint32_t>, 3> scratch_;  // of addFace
};

}  // namespace

ImportedMesh readObj(const std::filesystem::path& path, SceneFiles& files) {
    return ObjReader(path, files).read();
}

}  // namespace glint
