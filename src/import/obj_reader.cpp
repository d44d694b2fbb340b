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

constexpr int64_t kNone = -1;                   // Mesh::kNoIndex in 32 bits
constexpr int64_t kMissing = int64_t{1} << 40;  // index into a list that is still empty
constexpr Color kWhite = MeshBuilder::kNoColor;

// Indices of a face corner by kind. They count from 0 and may be out of range, as a face may come before its
// vertices.
enum Kind { kVertex, kUv, kNormal };
constexpr Kind kAllKinds[] = {kVertex, kUv, kNormal};
constexpr const char* kKindNames[] = {"vertex", "texture vertex", "normal"};
using Corner = std::array<int64_t, 3>;

// A name that usemtl or a material library gives.
struct NamedMaterial {
    size_t firstUse = 0;                 // line; 0: not used
    uint32_t material = Mesh::kNoIndex;  // its first definition, which may follow the use
};

struct Face {
    size_t firstCorner;
    size_t cornerCount;
    size_t line;
    const NamedMaterial* material;  // or null
};

class ObjReader {
  public:
    ObjReader(const std::filesystem::path& path, SceneFiles& files)
        : path_(path),
          files_(files),
          text_(files.read(path)),
          scanner_(files.context(), text_, path.string(), 1, true),
          builder_(path.string()) {}

    ImportedMesh read() {
        {
            const ProgressPart part(files_, 0, kRead);
            while (scanner_.nextLine()) readLine();
        }
        checkIndices();
        std::map<size_t, std::string> undefined;  // by line
        for (const auto& [name, named] : materials_)
            if (named.firstUse > 0 && named.material == Mesh::kNoIndex)
                undefined.emplace(named.firstUse, name);
        for (const auto& [line, name] : undefined)
            warn(line, "material \"" + name + "\" is not defined in a material file; grey is used");
        builder_.colorCodes = MeshBuilder::ColorCodes::Srgb;  // as MeshLab, Blender and others mean them
        if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), kWhite);
        const ProgressPart part(files_, kRead, 1);
        builder_.reserve(faces_.size());
        for (size_t i = 0; i < faces_.size(); i++) {
            files_.context().pace(i, faces_.size());
            addFace(faces_[i]);
        }
        builder_.warnings.addIgnored();
        return builder_.finish();
    }

  private:
    static constexpr double kRead = 0.8;  // part of the time for reading lines

    void readLine() {
        const std::string_view keyword = scanner_.word();
        if (keyword == "v") {
            mesh_.positions.push_back(readVector("a vertex"));
            readColor();
        } else if (keyword == "vt") {
            const double u = scanner_.number("a texture vertex");
            // v may be missing, a third coordinate may follow.
            mesh_.uvs.emplace_back(u, scanner_.lineDone() ? 0 : scanner_.number("a texture vertex"));
        } else if (keyword == "vn") {
            mesh_.normals.push_back(readVector("a normal"));
        } else if (keyword == "f" || keyword == "fo") {  // fo: the old word for f
            readFace();
        } else if (keyword == "usemtl") {
            NamedMaterial& named = materials_[std::string(scanner_.restOfLine())];
            if (named.firstUse == 0) named.firstUse = scanner_.line();
            material_ = &named;
        } else if (keyword == "mtllib") {
            readLibraries();
        } else if (!keyword.empty() && keyword != "o" && keyword != "g" && keyword != "s") {
            builder_.warnings.ignore(keyword);  // lines, curves, and unknown keywords
        }
    }

    glm::dvec3 readVector(const char* owner) {
        const double x = scanner_.number(owner), y = scanner_.number(owner);
        return {x, y, scanner_.number(owner)};
    }

    // Three numbers or more after a vertex are its colour (ZBrush, MeshLab); a single one is a weight.
    void readColor() {
        std::vector<double> rgb;
        while (!scanner_.lineDone()) rgb.push_back(scanner_.number("a vertex"));
        if (rgb.size() < 3) return;
        mesh_.colors.resize(mesh_.positions.size() - 1, kWhite);
        mesh_.colors.emplace_back(rgb[0], rgb[1], rgb[2]);
    }

    void readFace() {
        Face face{corners_.size(), 0, scanner_.line(), material_};
        for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word())
            corners_.push_back(readCorner(word));
        face.cornerCount = corners_.size() - face.firstCorner;
        if (face.cornerCount > kMaxPolygonCorners)
            scanner_.fail("face has ", face.cornerCount, " vertices, the limit is ", kMaxPolygonCorners);
        faces_.push_back(face);
    }

    // v, v/vt, v//vn or v/vt/vn. Some exporters write slashes without an index; these are accepted.
    Corner readCorner(std::string_view word) {
        Corner corner = {kNone, kNone, kNone};
        const char* at = word.data();
        const char* const end = at + word.size();
        for (const Kind kind : kAllKinds) {
            if (kind != kVertex && at < end) at++;  // a slash
            if (kind == kVertex || (at < end && *at != '/')) corner[kind] = readIndex(at, end, word, kind);
        }
        if (at != end) badCorner(word);
        return corner;
    }

    // Items of a kind so far.
    int64_t countOf(Kind kind) const {
        return static_cast<int64_t>(kind == kVertex ? mesh_.positions.size()
                                    : kind == kUv   ? mesh_.uvs.size()
                                                    : mesh_.normals.size());
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
        if (index < 0 && have == 0 && !mesh_.positions.empty()) return kMissing;
        scanner_.fail(
            "face uses ", kKindNames[kind], " ", index,
            (index == 0 ? ", indices start at 1" : ", there are " + std::to_string(have) + " so far"));
    }

    [[noreturn]] void badCorner(std::string_view word) const {
        scanner_.fail("\"", word.substr(0, 40), "\" is not a face vertex (v, v/vt, v//vn or v/vt/vn)");
    }

    void warn(size_t line, const std::string& what) {
        builder_.result.warnings.push_back(
            printable(path_.string() + ":" + std::to_string(line) + ": " + what));
    }

    // Reads the libraries of a line: one file, whose name may hold blanks, or several.
    void readLibraries() {
        TextScanner words = scanner_;
        const std::string names(scanner_.restOfLine());
        if (readLibrary(names, names.find_first_of(" \t") == names.npos)) return;
        for (std::string_view name = words.word(); !name.empty(); name = words.word())
            readLibrary(std::string(name), true);
    }

    // Reads a material library once, under all of its names. If its file does not exist: a warning with
    // `warns`, otherwise false.
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
        const std::vector<Material>& all = builder_.result.materials;
        const size_t first = all.size();
        readMtl(text, file, files_, builder_.result);
        for (size_t i = first; i < all.size(); i++) {
            uint32_t& known = materials_[all[i].name].material;
            if (known == Mesh::kNoIndex) known = static_cast<uint32_t>(i);
        }
        return true;
    }

    void checkIndices() {
        // Faces may name texture vertices and normals that the file leaves out altogether.
        for (const auto& [kind, what] :
             {std::pair(kUv, "texture vertices (vt)"), {kNormal, "normals (vn)"}}) {
            const auto names = [kind = kind](const Corner& corner) { return corner[kind] != kNone; };
            if (countOf(kind) > 0 || std::ranges::none_of(corners_, names)) continue;
            for (Corner& corner : corners_) corner[kind] = kNone;
            builder_.warnings.add("faces name ", what, ", but the file has none; drawn without them");
        }
        for (const Face& face : faces_)
            for (size_t i = face.firstCorner; i < face.firstCorner + face.cornerCount; i++)
                for (const Kind kind : kAllKinds)
                    if (corners_[i][kind] >= countOf(kind))
                        scanner_.failAt(face.line, "face uses ", kKindNames[kind], " ", corners_[i][kind] + 1,
                                        ", the file has ", countOf(kind));
        for (const Kind kind : kAllKinds)
            if (countOf(kind) >= int64_t{Mesh::kNoIndex}) scanner_.fail("more than 2^32 - 2 vertices");
    }

    void addFace(const Face& face) {
        const auto corners = std::span(corners_).subspan(face.firstCorner, face.cornerCount);
        polygon_.assign(corners.size(), {});
        // An attribute counts only if all corners have it.
        const auto put = [&](Kind kind, uint32_t MeshCorner::*index) {
            if (std::ranges::any_of(corners, [&](const Corner& c) { return c[kind] == kNone; })) return;
            for (size_t i = 0; i < corners.size(); i++)
                polygon_[i].*index = static_cast<uint32_t>(corners[i][kind]);
        };
        put(kVertex, &MeshCorner::vertex);
        put(kNormal, &MeshCorner::normal);
        put(kUv, &MeshCorner::uv);
        if (!mesh_.colors.empty()) put(kVertex, &MeshCorner::color);
        builder_.addPolygon(polygon_, face.material ? face.material->material : Mesh::kNoIndex);
    }

    std::filesystem::path path_;
    SceneFiles& files_;
    std::string text_;
    TextScanner scanner_;
    MeshBuilder builder_;
    Mesh& mesh_ = builder_.result.mesh;
    std::vector<Corner> corners_;
    std::vector<Face> faces_;
    std::set<std::filesystem::path> libraries_;       // that were looked for
    std::map<std::string, NamedMaterial> materials_;  // by name
    const NamedMaterial* material_ = nullptr;
    std::vector<MeshCorner> polygon_;  // scratch of addFace
};

}  // namespace

ImportedMesh readObj(const std::filesystem::path& path, SceneFiles& files) {
    return ObjReader(path, files).read();
}

}  // namespace glint
