// PLY meshes. assimp (5.2.5) is no substitute: it rounds double properties to float, accepts truncated ascii
// files and fills the rest with arbitrary memory, and accepts invalid vertex indices.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "core/error.h"
#include "core/text_file.h"
#include "import/mesh_builder.h"
#include "import/ply_header.h"
#include "import/readers.h"
#include "import/text_scanner.h"
#include "scene/limits.h"

namespace glint {

namespace {

std::string endsAfter(const PlyElement& element, uint64_t index) {
    return "the file ends after " + std::to_string(index) + " of " + std::to_string(element.count) +
           " elements \"" + element.name + "\"";
}

// AsciiSource and BinarySource return the numbers of the elements, property by property in the header's
// order. fail() adds the place. atMost() bounds the number of elements that can follow, so that a false
// header cannot reserve all memory. In ascii files an element is a line.
class AsciiSource {
  public:
    AsciiSource(const Context& context, std::string_view body, const std::string& file, size_t line)
        : text_(body), lines_(context, body, file, line) {}

    void beginElement(const PlyElement& element, uint64_t index) {
        owner_ = element.name.c_str();
        do {
            if (!lines_.nextLine()) lines_.fail(endsAfter(element, index));
        } while (lines_.lineDone());
    }
    double nextNumber(NumberType) { return lines_.number(owner_); }
    int64_t nextInteger(NumberType) { return lines_.integer(owner_); }
    void endElement() {
        if (!lines_.lineDone()) lines_.fail("the line has more numbers than the header announces");
    }
    void fail(const std::string& what) const { lines_.fail(std::string(owner_) + " " + what); }
    uint64_t atMost(const PlyElement&) const { return text_.size() / 2 + 1; }  // a digit and a line end each

  private:
    std::string_view text_;
    TextScanner lines_;
    const char* owner_ = "";
};

class BinarySource {
  public:
    BinarySource(const Context& context, std::string_view body, const std::string& file, std::endian order)
        : at_(body.data()), end_(at_ + body.size()), pace_(context, at_, end_), file_(file), order_(order) {}

    void beginElement(const PlyElement& element, uint64_t index) {
        element_ = &element;
        index_ = index;
    }
    double nextNumber(NumberType type) { return loadNumberAs<double>(type, take(sizeOf(type)), order_); }
    int64_t nextInteger(NumberType type) { return loadNumberAs<int64_t>(type, take(sizeOf(type)), order_); }
    void endElement() {}
    void fail(const std::string& what) const {
        failFile(file_, element_->name + " " + std::to_string(index_) + " " + what);
    }
    uint64_t atMost(const PlyElement& element) const {
        uint64_t least = 0;
        for (const PlyProperty& p : element.properties) least += sizeOf(p.isList ? p.countType : p.type);
        return static_cast<uint64_t>(end_ - at_) / std::max<uint64_t>(least, 1);
    }

  private:
    const char* take(size_t size) {
        if (static_cast<size_t>(end_ - at_) < size) failFile(file_, endsAfter(*element_, index_));
        const char* taken = at_;
        at_ += size;
        pace_.reached(at_);
        return taken;
    }

    const char* at_;
    const char* end_;
    ReadingPace pace_;
    std::string file_;
    std::endian order_;
    const PlyElement* element_ = nullptr;
    uint64_t index_ = 0;
};

// The source is a template parameter so that its functions are inlined: half a million faces in 20 ms.
template <typename SourceT>
class PlyBody {
    static constexpr double kRead = 0.9;  // part of the time for reading; the rest is for pending faces

  public:
    // `materials` is empty or holds the material of all faces.
    PlyBody(SceneFiles& files, SourceT& source, const PlyHeader& header, const std::string& file,
            std::vector<Material> materials)
        : files_(files), source_(source), header_(header), file_(file), materials_(std::move(materials)) {}

    ImportedMesh read() {
        readElements();
        const ProgressPart part(files_, kRead, 1);
        addFaces();
        std::vector<std::string> warnings;
        ignored_.warn(file_, warnings);
        return builder_.finish(file_, std::move(materials_), std::move(warnings));
    }

  private:
    void readElements() {
        const ProgressPart part(files_, 0, kRead);
        uint64_t faces = 0;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                readVertices(element);
            } else if (element.name == "face") {
                faces += element.count;
                readFaces(element);
            } else if (element.name == "tristrips") {
                faces += element.count;
                readStrips(element);
            } else {
                ignored_.add("element " + element.name);
                skip(element);
            }
        }
        if (faces == 0) fail("holds no faces; a point cloud cannot be rendered");
    }

    [[noreturn]] void fail(const std::string& what) const { failFile(file_, what); }

    void skipProperty(const PlyProperty& property) {
        const int64_t count = property.isList ? readCount(property) : 1;
        for (int64_t i = 0; i < count; i++) source_.nextNumber(property.type);
    }

    int64_t readCount(const PlyProperty& property) {
        const int64_t count = source_.nextInteger(property.countType);
        if (count < 0)
            source_.fail("list \"" + property.name + "\" has " + std::to_string(count) + " entries");
        return count;
    }

    void skip(const PlyElement& element) {
        if (element.properties.empty()) return;  // nothing in the file, however many
        for (uint64_t i = 0; i < element.count; i++) {
            source_.beginElement(element, i);
            for (const PlyProperty& property : element.properties) skipProperty(property);
            source_.endElement();
        }
    }

    // For each property its slot among the values that readers use, or kOther; and the complete groups.
    static constexpr size_t kOther = 11;
    struct Slots {
        std::vector<size_t> ofProperty;
        bool positions = false, normals = false, uvs = false, colors = false;
    };

    // Finds the groups of properties that are complete in an element, and ignores the rest.
    Slots findSlots(const PlyElement& element, size_t firstWanted) {
        // Texture coordinates go by several names: Blender s t, MeshLab texture_u texture_v, others u v.
        constexpr std::string_view kNames[kOther][3] = {{"x"},
                                                        {"y"},
                                                        {"z"},
                                                        {"nx"},
                                                        {"ny"},
                                                        {"nz"},
                                                        {"s", "u", "texture_u"},
                                                        {"t", "v", "texture_v"},
                                                        {"red", "diffuse_red"},
                                                        {"green", "diffuse_green"},
                                                        {"blue", "diffuse_blue"}};
        Slots slots;
        slots.ofProperty.assign(element.properties.size(), kOther);
        bool found[kOther] = {};
        for (size_t slot = firstWanted; slot < kOther; slot++)
            for (const std::string_view name : kNames[slot]) {
                const int at = name.empty() ? -1 : element.find(name);
                if (at < 0 || element.properties[static_cast<size_t>(at)].isList || found[slot]) continue;
                slots.ofProperty[static_cast<size_t>(at)] = slot;
                found[slot] = true;
            }
        slots.positions = found[0] && found[1] && found[2];
        slots.normals = found[3] && found[4] && found[5];
        slots.uvs = found[6] && found[7];
        slots.colors = found[8] && found[9] && found[10];
        for (size_t p = 0; p < slots.ofProperty.size(); p++) {
            size_t& slot = slots.ofProperty[p];
            const bool used = slot < 3 || (slot < 6 ? slots.normals : slot < 8 ? slots.uvs : slots.colors);
            if (used && slot != kOther) continue;
            slot = kOther;
            if (!isFaceList(element.properties[p]))
                ignored_.add(element.name + " " + element.properties[p].name);
        }
        return slots;
    }

    // True for lists of faces: vertices, or a pair of texture coordinates for each vertex.
    static bool isFaceList(const PlyProperty& p) {
        return p.isList && (p.name == "vertex_indices" || p.name == "vertex_index" || p.name == "texcoord");
    }

    // Integers are sRGB codes, floats are linear.
    void setColorCodes(const PlyElement& element) {
        const int red = std::max(element.find("red"), element.find("diffuse_red"));
        if (isInteger(element.properties[static_cast<size_t>(red)].type))
            builder_.colorCodes = MeshBuilder::ColorCodes::Integers;
    }

    void readVertices(const PlyElement& element) {
        const Slots slots = findSlots(element, 0);
        if (!slots.positions) fail("the vertices lack one of the properties x, y, z");
        if (element.count >= Mesh::kNoIndex) fail("more than 2^32 - 2 vertices");
        if (slots.colors) setColorCodes(element);
        const uint64_t expected = std::min(element.count, source_.atMost(element));
        builder_.positions.reserve(expected);
        if (slots.normals) builder_.normals.reserve(expected);
        if (slots.uvs) builder_.uvs.reserve(expected);
        if (slots.colors) builder_.colors.reserve(expected);
        for (uint64_t i = 0; i < element.count; i++) {
            double values[kOther + 1] = {};
            source_.beginElement(element, i);
            for (size_t p = 0; p < slots.ofProperty.size(); p++) {
                if (element.properties[p].isList)
                    skipProperty(element.properties[p]);
                else
                    values[slots.ofProperty[p]] = source_.nextNumber(element.properties[p].type);
            }
            source_.endElement();
            builder_.positions.emplace_back(values[0], values[1], values[2]);
            if (slots.normals) builder_.normals.emplace_back(values[3], values[4], values[5]);
            if (slots.uvs) builder_.uvs.emplace_back(values[6], values[7]);
            if (slots.colors) builder_.colors.emplace_back(values[8], values[9], values[10]);
        }
        vertexUvs_ = slots.uvs;
        vertexColors_ = slots.colors;
    }

    // Property with the vertex lists of the faces or strips.
    const PlyProperty& indicesOf(const PlyElement& element, const std::string& plural) const {
        int list = element.find("vertex_indices");
        if (list < 0) list = element.find("vertex_index");
        if (list < 0) fail("the " + plural + " have neither a list vertex_indices nor vertex_index");
        const PlyProperty& indices = element.properties[static_cast<size_t>(list)];
        if (!indices.isList || !isInteger(indices.type))
            fail("\"" + indices.name + "\" must be a list of integers");
        return indices;
    }

    void readFaces(const PlyElement& element) {
        const PlyProperty& indices = indicesOf(element, "faces");
        vertexCount_ = countOfVertices();
        const Slots slots = findSlots(element, 8);
        if (slots.colors && !vertexColors_) setColorCodes(element);
        if (slots.colors && vertexColors_) ignored_.add("face red, green, blue");
        if (haveVertices()) builder_.reserve(std::min(element.count, source_.atMost(element)));
        for (uint64_t i = 0; i < element.count; i++) {
            double values[kOther + 1] = {};
            source_.beginElement(element, i);
            for (size_t p = 0; p < slots.ofProperty.size(); p++) {
                const PlyProperty& property = element.properties[p];
                if (&property == &indices)
                    readCorners(property);
                else if (property.isList && property.name == "texcoord")
                    readTextureCoordinates(property);
                else if (property.isList)
                    skipProperty(property);
                else
                    values[slots.ofProperty[p]] = source_.nextNumber(property.type);
            }
            source_.endElement();
            if (slots.colors) faceColors_.resize(faceEnds_.size(), MeshBuilder::kNoColor);
            if (slots.colors) faceColors_.emplace_back(values[8], values[9], values[10]);
            endFace();
        }
    }

    // Two numbers for each corner; a list of any other length is ignored.
    void readTextureCoordinates(const PlyProperty& property) {
        const int64_t count = readCount(property);
        faceUvs_.resize(faceEnds_.empty() ? 0 : faceEnds_.back(), kNoUv);
        double u = 0;
        for (int64_t i = 0; i < count; i++) {
            const double number = source_.nextNumber(property.type);
            if (i % 2 != 0 && i < 2 * static_cast<int64_t>(kMaxPolygonCorners))
                faceUvs_.emplace_back(u, number);
            u = number;
        }
    }

    void readStrips(const PlyElement& element) {
        const PlyProperty& indices = indicesOf(element, "triangle strips");
        vertexCount_ = countOfVertices();
        findSlots(element, kOther);
        for (uint64_t i = 0; i < element.count; i++) {
            source_.beginElement(element, i);
            for (const PlyProperty& property : element.properties)
                &property == &indices ? readStrip(property) : skipProperty(property);
            source_.endElement();
        }
    }

    // Reads a strip as scanners write it (Cyberware, Stanford): each vertex forms a triangle with the two
    // before it. Every other triangle is reversed, so that all face the same side; -1 starts a new strip.
    // Repeated vertices, which join strips, form no triangle.
    void readStrip(const PlyProperty& property) {
        const int64_t count = readCount(property);
        std::array<uint32_t, 2> last{};
        uint32_t length = 0;  // since the last -1
        for (int64_t i = 0; i < count; i++) {
            const int64_t index = source_.nextInteger(property.type);
            if (index == -1) {
                length = 0;
                continue;
            }
            const uint32_t vertex = checkedVertex(index);
            if (length >= 2 && vertex != last[0] && vertex != last[1] && last[0] != last[1]) {
                const bool turned = length % 2 != 0;
                corners_.insert(corners_.end(), {last[turned ? 1 : 0], last[turned ? 0 : 1], vertex});
                endFace();
            }
            last = {last[1], vertex};
            length++;
        }
    }

    uint32_t checkedVertex(int64_t index) const {
        if (index < 0 || index >= vertexCount_)
            source_.fail("uses vertex " + std::to_string(index) + ", the file has " +
                         std::to_string(vertexCount_) + " (numbered from 0)");
        return static_cast<uint32_t>(index);
    }

    void readCorners(const PlyProperty& property) {
        const int64_t count = readCount(property);
        if (count > static_cast<int64_t>(kMaxPolygonCorners))
            source_.fail("has " + std::to_string(count) + " vertices, the limit is " +
                         std::to_string(kMaxPolygonCorners));
        for (int64_t i = 0; i < count; i++) {
            corners_.push_back(checkedVertex(source_.nextInteger(property.type)));
        }
    }

    // By the header: the faces may stand before the vertices.
    int64_t countOfVertices() const {
        for (const PlyElement& element : header_.elements)
            if (element.name == "vertex") return static_cast<int64_t>(element.count);
        fail("holds no vertices");
    }

    bool haveVertices() const { return builder_.positions.size() == static_cast<size_t>(vertexCount_); }

    // Ends the face whose corners are the last of corners_. Faces that precede the vertices are pending.
    void endFace() {
        const size_t begin = faceEnds_.empty() ? 0 : faceEnds_.back();
        if (!faceUvs_.empty() && faceUvs_.size() != corners_.size()) {
            faceUvs_.resize(begin, kNoUv);
            faceUvs_.resize(corners_.size(), kNoUv);
        }
        faceEnds_.push_back(corners_.size());
        if (haveVertices()) addFaces();
    }

    void addFaces() {
        size_t begin = 0;
        for (size_t i = 0; i < faceEnds_.size(); begin = faceEnds_[i++]) {
            files_.context().pace(i, faceEnds_.size());
            addFace(i, begin, faceEnds_[i] - begin);
        }
        corners_.clear();
        faceEnds_.clear();
        faceUvs_.clear();
        faceColors_.clear();
    }

    // Adds a face. Its own attributes follow those of the vertices.
    void addFace(size_t face, size_t begin, size_t count) {
        const auto corners = std::span<const uint32_t>(corners_).subspan(begin, count);
        MeshBuilder::Corners polygon{corners};
        if (!builder_.normals.empty()) polygon.normals = corners;
        if (vertexUvs_) polygon.uvs = corners;
        if (vertexColors_) polygon.colors = corners;
        if (builder_.uvs.size() + count >= Mesh::kNoIndex) fail("more than 2^32 - 2 texture coordinates");
        if (count > 0 && !faceUvs_.empty() && !std::isnan(faceUvs_[begin].x)) {
            ownUvs_.resize(count);
            std::iota(ownUvs_.begin(), ownUvs_.end(), static_cast<uint32_t>(builder_.uvs.size()));
            builder_.uvs.insert(builder_.uvs.end(), faceUvs_.begin() + static_cast<std::ptrdiff_t>(begin),
                                faceUvs_.begin() + static_cast<std::ptrdiff_t>(begin + count));
            polygon.uvs = ownUvs_;
        }
        if (!faceColors_.empty() && !vertexColors_) {
            ownColors_.assign(count, static_cast<uint32_t>(builder_.colors.size()));
            builder_.colors.push_back(face < faceColors_.size() ? faceColors_[face] : MeshBuilder::kNoColor);
            polygon.colors = ownColors_;
        }
        builder_.addPolygon(polygon, materials_.empty() ? Mesh::kNoIndex : 0);
    }

    SceneFiles& files_;
    SourceT& source_;
    const PlyHeader& header_;
    const std::string& file_;
    MeshBuilder builder_;
    std::vector<Material> materials_;
    IgnoredNames ignored_;
    int64_t vertexCount_ = 0;
    bool vertexUvs_ = false, vertexColors_ = false;
    // Pending faces: corners, the end of each face's corners, and the faces' own attributes. Each array is
    // empty or complete (colours may be fewer).
    static constexpr glm::dvec2 kNoUv{std::numeric_limits<double>::quiet_NaN()};
    std::vector<uint32_t> corners_;
    std::vector<size_t> faceEnds_;
    std::vector<glm::dvec2> faceUvs_;
    std::vector<Color> faceColors_;
    std::vector<uint32_t> ownUvs_, ownColors_;
};

// The material of the file's texture, if it has one.
std::vector<Material> textured(const PlyHeader& header, const std::filesystem::path& path, SceneFiles& files,
                               std::vector<Texture>& textures, std::vector<std::string>& warnings) {
    if (header.textures.empty()) return {};
    const auto material = texturedMaterial(header.textures.front(), path, files, textures, warnings);
    for (size_t i = 1; i < std::min<size_t>(header.textures.size(), 9); i++)
        warnings.push_back(printable(path.string() + ": TextureFile " + header.textures[i] +
                                     " is ignored, all faces have the first one"));
    return material ? std::vector{*material} : std::vector<Material>();
}

}  // namespace

ImportedMesh readPly(const std::filesystem::path& path, SceneFiles& files) {
    const std::string file = path.string();
    const std::string bytes = files.read(path);
    const PlyHeader header = readPlyHeader(files.context(), bytes, file);
    const std::string_view body = std::string_view(bytes).substr(header.bodyOffset);
    std::vector<Texture> textures;
    std::vector<std::string> warnings;
    std::vector<Material> materials = textured(header, path, files, textures, warnings);
    const auto read = [&](auto source) {
        ImportedMesh imported = PlyBody(files, source, header, file, std::move(materials)).read();
        imported.textures = std::move(textures);
        imported.warnings.insert(imported.warnings.end(), warnings.begin(), warnings.end());
        return imported;
    };
    if (header.format == PlyFormat::Ascii)
        return read(AsciiSource(files.context(), body, file, header.bodyLine));
    return read(
        BinarySource(files.context(), body, file,
                     header.format == PlyFormat::LittleEndian ? std::endian::little : std::endian::big));
}

}  // namespace glint
