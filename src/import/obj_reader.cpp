// OBJ polygons (Wavefront, Advanced Visualizer manual, appendix B1). tinyobjloader is no substitute: it reads
// "x" and "0,8" as 0, accepts indices beyond the arrays, reports no line numbers, and its numbers differ from
// the correctly rounded ones in the last bits.
#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/text_file.h"
#include "import/mesh_builder.h"
#include "import/readers.h"
#include "import/text_scanner.h"
#include "scene/limits.h"

namespace glint {

namespace {

constexpr Color kWhite = MeshBuilder::kNoColor;

// Indices of a face corner, in the order of v/vt/vn.
enum Kind { kVertex, kUv, kNormal };
constexpr Kind kAllKinds[] = {kVertex, kUv, kNormal};
constexpr const char* kKindNames[] = {"vertex", "texture vertex", "normal"};
constexpr uint32_t MeshCorner::*kIndices[] = {&MeshCorner::vertex, &MeshCorner::uv, &MeshCorner::normal};

// Reads the file twice, as faces may come before their vertices and materials: first both of these, then the
// faces.
class ObjReader {
  public:
    ObjReader(const std::filesystem::path& path, SceneFiles& files)
        : path_(path),
          files_(files),
          text_(files.read(path)),
          scanner_(files.context(), text_, path.string(), 1, true),
          builder_(path.string()) {}

    ImportedMesh read() {
        const TextScanner start = scanner_;
        {
            const ProgressPart part(files_, 0, kVertices);
            while (scanner_.nextLine()) readVertexLine(scanner_.word());
        }
        for (const size_t count : {mesh_.positions.size(), mesh_.uvs.size(), mesh_.normals.size()}) {
            if (count >= Mesh::kNoIndex) scanner_.fail("more than 2^32 - 2 vertices");
            counts_.push_back(static_cast<int64_t>(count));
        }
        builder_.colorCodes = MeshBuilder::ColorCodes::Srgb;  // as MeshLab, Blender and others mean them
        if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), kWhite);
        const ProgressPart part(files_, kVertices, 1);
        scanner_ = start;
        while (scanner_.nextLine()) readFaceLine(scanner_.word());
        builder_.warnings.addIgnored();
        return builder_.finish();
    }

  private:
    static constexpr double kVertices = 0.5;  // part of the time for reading vertices

    void readVertexLine(std::string_view keyword) {
        if (keyword == "v") {
            mesh_.positions.push_back(readVector("a vertex"));
            readColor();
        } else if (keyword == "vt") {
            const double u = scanner_.number("a texture vertex");
            // v may be missing, a third coordinate may follow.
            mesh_.uvs.emplace_back(u, scanner_.lineDone() ? 0 : scanner_.number("a texture vertex"));
        } else if (keyword == "vn") {
            mesh_.normals.push_back(readVector("a normal"));
        } else if (keyword == "mtllib") {
            readLibraries();
        }
    }

    void readFaceLine(std::string_view keyword) {
        if (keyword == "v") {
            soFar_[kVertex]++;
        } else if (keyword == "vt") {
            soFar_[kUv]++;
        } else if (keyword == "vn") {
            soFar_[kNormal]++;
        } else if (keyword == "f" || keyword == "fo") {  // fo: the old word for f
            readFace();
        } else if (keyword == "usemtl") {
            const std::string name(scanner_.restOfLine());
            const auto [known, isNew] = materials_.try_emplace(name, Mesh::kNoIndex);
            if (isNew) warn("material \"" + name + "\" is not defined in a material file; grey is used");
            material_ = known->second;
        } else if (!keyword.empty() && keyword != "o" && keyword != "g" && keyword != "s" &&
                   keyword != "mtllib") {
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
        polygon_.clear();
        for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word())
            polygon_.push_back(readCorner(word));
        if (polygon_.size() > kMaxPolygonCorners)
            scanner_.fail("face has ", polygon_.size(), " vertices, the limit is ", kMaxPolygonCorners);
        // An attribute counts only if all corners have it.
        for (const auto index : {&MeshCorner::uv, &MeshCorner::normal})
            if (std::ranges::find(polygon_, Mesh::kNoIndex, index) != polygon_.end())
                for (MeshCorner& corner : polygon_) corner.*index = Mesh::kNoIndex;
        builder_.addPolygon(polygon_, material_);
    }

    // v, v/vt, v//vn or v/vt/vn. Some exporters write slashes without an index; these are accepted.
    MeshCorner readCorner(std::string_view word) {
        MeshCorner corner;
        const char* at = word.data();
        const char* const end = at + word.size();
        for (const Kind kind : kAllKinds) {
            if (kind != kVertex && at < end) at++;  // a slash
            if (kind == kVertex || (at < end && *at != '/'))
                corner.*kIndices[kind] = readIndex(at, end, word, kind);
        }
        if (at != end) badCorner(word);
        if (!mesh_.colors.empty()) corner.color = corner.vertex;
        return corner;
    }

    // An index that ends at a slash or at the word's end, counted from 0.
    uint32_t readIndex(const char*& at, const char* end, std::string_view word, Kind kind) {
        int64_t index = 0;
        const auto [stop, error] = std::from_chars(at, end, index);
        if (error != std::errc() || (stop != end && *stop != '/')) badCorner(word);
        at = stop;
        const int64_t have = soFar_[kind];
        if (index == 0) scanner_.fail("face uses ", kKindNames[kind], " 0, indices start at 1");
        if (kind != kVertex && counts_[kind] == 0) {
            if (!std::exchange(missed_[kind], true))
                builder_.warnings.add("faces name ", (kind == kUv ? "texture vertices (vt)" : "normals (vn)"),
                                      ", but the file has none; drawn without them");
            return Mesh::kNoIndex;
        }
        if (index < -have)
            scanner_.fail("face uses ", kKindNames[kind], " ", index, ", there are ", have, " so far");
        if (index > counts_[kind])
            scanner_.fail("face uses ", kKindNames[kind], " ", index, ", the file has ", counts_[kind]);
        // Negative indices count back from the last one so far.
        return static_cast<uint32_t>(index > 0 ? index - 1 : have + index);
    }

    [[noreturn]] void badCorner(std::string_view word) const {
        scanner_.fail("\"", word.substr(0, 40), "\" is not a face vertex (v, v/vt, v//vn or v/vt/vn)");
    }

    void warn(const std::string& what) {
        builder_.result.warnings.push_back(
            printable(concat(path_.string(), ':', scanner_.line(), ": ", what)));
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
            warn(error.what() + std::string("; drawn without these materials"));
            return true;
        }
        const std::vector<Material>& all = builder_.result.materials;
        const size_t first = all.size();
        readMtl(text, file, files_, builder_.result);
        for (size_t i = first; i < all.size(); i++)  // the first definition of a name counts
            materials_.try_emplace(all[i].name, static_cast<uint32_t>(i));
        return true;
    }

    std::filesystem::path path_;
    SceneFiles& files_;
    std::string text_;
    TextScanner scanner_;
    MeshBuilder builder_;
    Mesh& mesh_ = builder_.result.mesh;
    std::vector<int64_t> counts_;                // of all items of each kind
    std::array<int64_t, 3> soFar_{};             // of those before the present line
    std::array<bool, 3> missed_{};               // faces name items of a kind that the file lacks
    std::set<std::filesystem::path> libraries_;  // that were looked for
    std::map<std::string, uint32_t> materials_;  // by name; kNoIndex if undefined
    uint32_t material_ = Mesh::kNoIndex;
    std::vector<MeshCorner> polygon_;  // scratch of readFace
};

}  // namespace

ImportedMesh readObj(const std::filesystem::path& path, SceneFiles& files) {
    return ObjReader(path, files).read();
}

}  // namespace glint
