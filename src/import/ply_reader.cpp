// PLY meshes (Turk, The PLY Polygon File Format, 1994). assimp (5.2.5) is no substitute: it rounds double
// properties to float, accepts truncated ascii files and fills the rest with arbitrary memory, and accepts
// invalid vertex indices.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

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

// The numbers of the elements, property by property in the header's order. In ascii files an element is a
// line.
class PlyNumbers {
  public:
    PlyNumbers(const Context& context, std::string_view body, const std::string& file,
               const PlyHeader& header)
        : format_(header.format),
          at_(body.data()),
          end_(at_ + body.size()),
          pace_(context, at_, end_),
          file_(file),
          lines_(context, body, file, header.bodyLine) {}

    void beginElement(const PlyElement& element, uint64_t index) {
        element_ = &element;
        index_ = index;
        if (format_ != PlyFormat::Ascii) return;
        do {
            if (!lines_.nextLine()) lines_.fail(endsAfter(element, index));
        } while (lines_.lineDone());
    }
    double number(NumberType type) {
        return format_ == PlyFormat::Ascii ? lines_.number(element_->name.c_str()) : take<double>(type);
    }
    int64_t integer(NumberType type) {
        return format_ == PlyFormat::Ascii ? lines_.integer(element_->name.c_str()) : take<int64_t>(type);
    }
    void endElement() {
        if (format_ == PlyFormat::Ascii && !lines_.lineDone())
            lines_.fail("the line has more numbers than the header announces");
    }
    // Fails at the present element.
    [[noreturn]] void fail(const std::string& what) const {
        if (format_ == PlyFormat::Ascii) lines_.fail(element_->name + " " + what);
        failFile(file_, element_->name + " " + std::to_string(index_) + " " + what);
    }
    // Bounds the number of elements that can follow, so that a false header cannot reserve all memory.
    uint64_t atMost(const PlyElement& element) const {
        uint64_t least = 0;
        for (const PlyProperty& p : element.properties) least += sizeOf(p.isList ? p.countType : p.type);
        if (format_ == PlyFormat::Ascii) least = 2;  // a digit and a line end
        return static_cast<uint64_t>(end_ - at_) / std::max<uint64_t>(least, 1) + 1;
    }

  private:
    template <typename Number>
    Number take(NumberType type) {
        const char* const taken = at_;
        if (static_cast<size_t>(end_ - at_) < sizeOf(type)) failFile(file_, endsAfter(*element_, index_));
        at_ += sizeOf(type);
        pace_.reached(at_);
        return loadNumberAs<Number>(
            type, taken, format_ == PlyFormat::LittleEndian ? std::endian::little : std::endian::big);
    }

    const PlyFormat format_;
    const char* at_;  // of binary files
    const char* const end_;
    ReadingPace pace_;
    const std::string& file_;
    TextScanner lines_;  // of ascii files
    const PlyElement* element_ = nullptr;
    uint64_t index_ = 0;
};

class PlyReader {
    static constexpr double kRead = 0.9;  // part of the time for reading; the rest is for the faces

  public:
    // `materials` is empty or holds the material of all faces.
    PlyReader(SceneFiles& files, const std::string& bytes, const PlyHeader& header, const std::string& file,
              std::vector<Material> materials)
        : files_(files),
          header_(header),
          file_(file),
          numbers_(files.context(), std::string_view(bytes).substr(header.bodyOffset), file, header),
          materials_(std::move(materials)) {}

    ImportedMesh read(std::vector<std::string> warnings) {
        readElements();
        const ProgressPart part(files_, kRead, 1);
        addFaces();
        std::vector<std::string> ignored;
        ignored_.warn(file_, ignored);
        ImportedMesh imported = builder_.finish(file_, std::move(materials_), std::move(ignored));
        imported.warnings.insert(imported.warnings.end(), warnings.begin(), warnings.end());
        return imported;
    }

  private:
    // The ends of a face's corners and of its own attributes in the lists of faces.
    struct FaceEnd {
        size_t corners = 0, uvs = 0, colors = 0;
    };

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
                if (element.properties.empty()) continue;  // they take no bytes in the file
                const Slots none{std::vector<size_t>(element.properties.size(), kOther)};
                forEach(
                    element, none, [&](const PlyProperty& list) { skipList(list); }, [](const double*) {});
            }
        }
        if (faces == 0) fail("holds no faces; a point cloud cannot be rendered");
    }

    [[noreturn]] void fail(const std::string& what) const { failFile(file_, what); }

    void skipList(const PlyProperty& property) {
        for (int64_t i = readCount(property); i > 0; i--) numbers_.number(property.type);
    }

    int64_t readCount(const PlyProperty& property) {
        const int64_t count = numbers_.integer(property.countType);
        if (count < 0)
            numbers_.fail("list \"" + property.name + "\" has " + std::to_string(count) + " entries");
        return count;
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
        constexpr std::string_view kNames[] = {"x",
                                               "y",
                                               "z",
                                               "nx",
                                               "ny",
                                               "nz",
                                               "s",
                                               "t",
                                               "red",
                                               "green",
                                               "blue",
                                               "u",
                                               "v",
                                               "texture_u",
                                               "texture_v",
                                               "diffuse_red",
                                               "diffuse_green",
                                               "diffuse_blue"};
        constexpr size_t kSlots[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 6, 7, 6, 7, 8, 9, 10};
        Slots slots;
        slots.ofProperty.assign(element.properties.size(), kOther);
        bool found[kOther] = {};
        for (size_t i = 0; i < std::size(kNames); i++) {
            const PlyProperty* const property = element.find(kNames[i]);
            if (!property || property->isList || kSlots[i] < firstWanted || found[kSlots[i]]) continue;
            slots.ofProperty[static_cast<size_t>(property - element.properties.data())] = kSlots[i];
            found[kSlots[i]] = true;
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
            const PlyProperty& property = element.properties[p];
            if (!property.isList || (!isIndices(property) && property.name != "texcoord"))
                ignored_.add(element.name + " " + property.name);
        }
        return slots;
    }

    // Reads an element `count` times: readList(property) reads a list, and add(values) receives the numbers
    // by slot.
    template <typename ReadList, typename Add>
    void forEach(const PlyElement& element, const Slots& slots, const ReadList& readList, const Add& add) {
        for (uint64_t i = 0; i < element.count; i++) {
            double values[kOther + 1] = {};
            numbers_.beginElement(element, i);
            for (size_t p = 0; p < slots.ofProperty.size(); p++) {
                const PlyProperty& property = element.properties[p];
                if (property.isList)
                    readList(property);
                else
                    values[slots.ofProperty[p]] = numbers_.number(property.type);
            }
            numbers_.endElement();
            add(values);
        }
    }

    static bool isIndices(const PlyProperty& p) {
        return p.name == "vertex_indices" || p.name == "vertex_index";
    }

    // Integers are sRGB codes, floats are linear.
    void setColorCodes(const PlyElement& element) {
        const PlyProperty* red = element.find("diffuse_red");
        if (const PlyProperty* const own = element.find("red")) red = own;
        if (isInteger(red->type)) builder_.colorCodes = MeshBuilder::ColorCodes::Integers;
    }

    void readVertices(const PlyElement& element) {
        const Slots slots = findSlots(element, 0);
        if (!slots.positions) fail("the vertices lack one of the properties x, y, z");
        if (element.count >= Mesh::kNoIndex) fail("more than 2^32 - 2 vertices");
        if (slots.colors) setColorCodes(element);
        const uint64_t expected = std::min(element.count, numbers_.atMost(element));
        builder_.positions.reserve(expected);
        if (slots.normals) builder_.normals.reserve(expected);
        if (slots.uvs) builder_.uvs.reserve(expected);
        if (slots.colors) builder_.colors.reserve(expected);
        const auto skip = [&](const PlyProperty& list) { skipList(list); };
        forEach(element, slots, skip, [&](const double* v) {
            builder_.positions.emplace_back(v[0], v[1], v[2]);
            if (slots.normals) builder_.normals.emplace_back(v[3], v[4], v[5]);
            if (slots.uvs) builder_.uvs.emplace_back(v[6], v[7]);
            if (slots.colors) builder_.colors.emplace_back(v[8], v[9], v[10]);
        });
        vertexUvs_ = slots.uvs;
        vertexColors_ = slots.colors;
    }

    // Property with the vertex lists of the faces or strips, which may stand before the vertices.
    const PlyProperty& indicesOf(const PlyElement& element, const std::string& plural) {
        const auto vertices = std::ranges::find(header_.elements, "vertex", &PlyElement::name);
        if (vertices == header_.elements.end()) fail("holds no vertices");
        vertexCount_ = static_cast<int64_t>(vertices->count);
        if (builder_.positions.size() != vertices->count) keepFaces_ = true;
        const PlyProperty* found = element.find("vertex_indices");
        if (found == nullptr) found = element.find("vertex_index");
        if (found == nullptr) fail("the " + plural + " have neither a list vertex_indices nor vertex_index");
        if (!found->isList || !isInteger(found->type))
            fail("\"" + found->name + "\" must be a list of integers");
        return *found;
    }

    void readFaces(const PlyElement& element) {
        const PlyProperty& indices = indicesOf(element, "faces");
        const Slots slots = findSlots(element, 8);
        if (slots.colors && !vertexColors_) setColorCodes(element);
        if (slots.colors && vertexColors_) ignored_.add("face red, green, blue");
        if (!keepFaces_) builder_.reserve(std::min(element.count, numbers_.atMost(element)));
        const auto readList = [&](const PlyProperty& list) {
            if (&list == &indices)
                readCorners(list);
            else if (list.name == "texcoord")
                readTextureCoordinates(list);
            else
                skipList(list);
        };
        forEach(element, slots, readList, [&](const double* v) {
            if (slots.colors && !vertexColors_) faceColors_.emplace_back(v[8], v[9], v[10]);
            endFace();
        });
    }

    void readTextureCoordinates(const PlyProperty& property) {
        const int64_t count = readCount(property);
        double u = 0;
        for (int64_t i = 0; i < count; i++) {
            const double number = numbers_.number(property.type);
            if (i % 2 != 0) faceUvs_.emplace_back(u, number);
            u = number;
        }
    }

    void readStrips(const PlyElement& element) {
        const PlyProperty& indices = indicesOf(element, "triangle strips");
        const auto readList = [&](const PlyProperty& list) {
            &list == &indices ? readStrip(list) : skipList(list);
        };
        forEach(element, findSlots(element, kOther), readList, [](const double*) {});
    }

    // Reads a strip as scanners write it (Cyberware, Stanford): each vertex forms a triangle with the two
    // before it. Every other triangle is reversed, so that all face the same side; -1 starts a new strip.
    // Repeated vertices, which join strips, form no triangle.
    void readStrip(const PlyProperty& property) {
        const int64_t count = readCount(property);
        std::array<uint32_t, 2> last{};
        uint32_t length = 0;  // since the last -1
        for (int64_t i = 0; i < count; i++) {
            const int64_t index = numbers_.integer(property.type);
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
            numbers_.fail("uses vertex " + std::to_string(index) + ", the file has " +
                          std::to_string(vertexCount_) + " (numbered from 0)");
        return static_cast<uint32_t>(index);
    }

    void readCorners(const PlyProperty& property) {
        const int64_t count = readCount(property);
        if (count > static_cast<int64_t>(kMaxPolygonCorners))
            numbers_.fail("has " + std::to_string(count) + " vertices, the limit is " +
                          std::to_string(kMaxPolygonCorners));
        for (int64_t i = 0; i < count; i++)
            corners_.push_back(checkedVertex(numbers_.integer(property.type)));
    }

    // Ends the face, which has the last corners and attributes of the lists.
    void endFace() {
        faces_.push_back({corners_.size(), faceUvs_.size(), faceColors_.size()});
        if (!keepFaces_) addFaces();
    }

    void addFaces() {
        const FaceEnd own{0, builder_.uvs.size(), builder_.colors.size()};
        if (own.uvs + faceUvs_.size() >= Mesh::kNoIndex) fail("more than 2^32 - 2 texture coordinates");
        builder_.uvs.insert(builder_.uvs.end(), faceUvs_.begin(), faceUvs_.end());
        builder_.colors.insert(builder_.colors.end(), faceColors_.begin(), faceColors_.end());
        FaceEnd begin;
        for (size_t i = 0; i < faces_.size(); begin = faces_[i++]) {
            if (i > 0) files_.context().pace(i, faces_.size());
            addFace(begin, faces_[i], own);
        }
        faces_.clear();
        corners_.clear();
        faceUvs_.clear();
        faceColors_.clear();
    }

    // Adds a face, whose own attributes replace those of its vertices. A list of texture coordinates must
    // have two for each corner.
    void addFace(const FaceEnd& begin, const FaceEnd& end, const FaceEnd& own) {
        const size_t count = end.corners - begin.corners;
        const auto corners = std::span<const uint32_t>(corners_).subspan(begin.corners, count);
        MeshBuilder::Corners polygon{corners};
        if (!builder_.normals.empty()) polygon.normals = corners;
        if (vertexUvs_) polygon.uvs = corners;
        if (vertexColors_) polygon.colors = corners;
        if (end.uvs != begin.uvs && end.uvs - begin.uvs == count) {
            ownUvs_.resize(count);
            std::iota(ownUvs_.begin(), ownUvs_.end(), static_cast<uint32_t>(own.uvs + begin.uvs));
            polygon.uvs = ownUvs_;
        }
        if (end.colors != begin.colors && !vertexColors_) {
            ownColors_.assign(count, static_cast<uint32_t>(own.colors + begin.colors));
            polygon.colors = ownColors_;
        }
        builder_.addPolygon(polygon, materials_.empty() ? Mesh::kNoIndex : 0);
    }

    SceneFiles& files_;
    const PlyHeader& header_;
    const std::string& file_;
    PlyNumbers numbers_;
    MeshBuilder builder_;
    std::vector<Material> materials_;
    IgnoredNames ignored_;
    int64_t vertexCount_ = 0;
    bool vertexUvs_ = false, vertexColors_ = false;
    // Faces that precede the vertices are added after them.
    bool keepFaces_ = false;
    std::vector<FaceEnd> faces_;
    std::vector<uint32_t> corners_;
    std::vector<glm::dvec2> faceUvs_;
    std::vector<Color> faceColors_;
    std::vector<uint32_t> ownUvs_, ownColors_;
};

}  // namespace

ImportedMesh readPly(const std::filesystem::path& path, SceneFiles& files) {
    const std::string file = path.string();
    const std::string bytes = files.read(path);
    const PlyHeader header = readPlyHeader(files.context(), bytes, file);
    std::vector<Texture> textures;
    std::vector<std::string> warnings;
    std::vector<Material> materials;  // that of the file's texture, if it has one
    for (size_t i = 0; i < std::min<size_t>(header.textures.size(), 9); i++) {
        if (i > 0)
            warnings.push_back(printable(file + ": TextureFile " + header.textures[i] +
                                         " is ignored, all faces have the first one"));
        else if (const auto found = texturedMaterial(header.textures[0], path, files, textures, warnings))
            materials.push_back(*found);
    }
    ImportedMesh imported = PlyReader(files, bytes, header, file, std::move(materials)).read(warnings);
    imported.textures = std::move(textures);
    return imported;
}

}  // namespace glint
