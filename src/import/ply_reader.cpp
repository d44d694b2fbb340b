// PLY meshes (Turk, The PLY Polygon File Format, 1994). assimp (5.2.5) is no substitute: it rounds double
// properties to float, accepts truncated ascii files and fills the rest with arbitrary memory, and accepts
// invalid vertex indices.
#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <set>
#include <utility>

#include "core/binary_numbers.h"
#include "core/enum_names.h"
#include "core/text_file.h"
#include "import/mesh_builder.h"
#include "import/readers.h"
#include "import/text_scanner.h"
#include "scene/limits.h"

namespace glint {

namespace {

// The use of a property: a number of a vertex or face, whose groups begin here, or a list.
enum Role : size_t { kPosition, kNormal = 3, kUv = 6, kColor = 8, kIndices = 11, kCornerUvs, kUnused };

// Names of the numbers that a mesh takes from an element, which must have all of a group; the first such
// group counts. Blender writes s t, MeshLab texture_u texture_v.
struct NumberGroup {
    Role role;
    std::vector<std::string_view> names;
};
const NumberGroup kGroups[] = {{kPosition, {"x", "y", "z"}},
                               {kNormal, {"nx", "ny", "nz"}},
                               {kUv, {"s", "t"}},
                               {kUv, {"u", "v"}},
                               {kUv, {"texture_u", "texture_v"}},
                               {kColor, {"red", "green", "blue"}},
                               {kColor, {"diffuse_red", "diffuse_green", "diffuse_blue"}}};

// ---- The header

struct PlyProperty {
    std::string name;
    NumberType type = NumberType::Float32;
    bool isList = false;
    NumberType countType = NumberType::Uint8;  // of a list
    size_t role = kUnused;
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;

    // The property of that name, or null.
    PlyProperty* find(std::string_view property) {
        const auto at = std::ranges::find(properties, property, &PlyProperty::name);
        return at == properties.end() ? nullptr : &*at;
    }
    bool has(size_t role) const {
        return std::ranges::find(properties, role, &PlyProperty::role) != properties.end();
    }
};

enum class PlyFormat { Ascii, LittleEndian, BigEndian };

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> textures;  // "comment TextureFile NAME", as MeshLab writes it
    size_t bodyOffset = 0;              // the first byte after the header
    size_t bodyLine = 1;                // the number of the first line after it
};

// Names of each type: those of 1994, and those that name the size.
constexpr std::string_view kTypeNames[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};

NumberType readType(TextScanner& line) {
    const std::string_view word = line.word();
    for (size_t i = 0; i < std::size(kTypeNames); i++)
        if (word == kTypeNames[i][0] || word == kTypeNames[i][1]) return static_cast<NumberType>(i);
    line.fail("unknown property type \"", word, "\"");
}

PlyFormat readFormat(TextScanner& line) {
    constexpr std::string_view kFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    const std::string_view format = line.word(), version = line.word();
    if (version != "1.0") line.fail("format version \"", version, "\" is not 1.0");
    const auto known = std::ranges::find(kFormats, format);
    if (known == std::end(kFormats))
        line.fail("unknown format \"", format, "\" (known: ", joined(kFormats), ")");
    return static_cast<PlyFormat>(known - kFormats);
}

PlyProperty readProperty(TextScanner& line) {
    PlyProperty property;
    TextScanner copy = line;
    if (copy.word() == "list") {
        line.word();
        property.isList = true;
        property.countType = readType(line);
        if (!isInteger(property.countType)) line.fail("a list's count must be of an integer type");
    }
    property.type = readType(line);
    property.name = line.word();
    if (property.name.empty()) line.fail("the property has no name");
    return property;
}

// The offset after the line "end_header". Binary data may follow, so only the header shows whether lines end
// with CR alone.
size_t findBody(std::string_view bytes) {
    constexpr std::string_view kMark = "end_header";
    size_t mark = bytes.find(kMark);
    while (mark != std::string_view::npos && mark > 0 && bytes[mark - 1] != '\n' && bytes[mark - 1] != '\r')
        mark = bytes.find(kMark, mark + 1);
    if (mark == std::string_view::npos) return bytes.size();
    const bool feeds = bytes.substr(0, mark).find('\n') != std::string_view::npos;
    const size_t lineEnd = bytes.find(feeds ? '\n' : '\r', mark);
    return lineEnd == std::string_view::npos ? bytes.size() : lineEnd + 1;
}

PlyHeader readPlyHeader(const Context& context, std::string_view bytes, const std::string& file) {
    PlyHeader header;
    header.bodyOffset = findBody(bytes);
    TextScanner lines(context, bytes.substr(0, header.bodyOffset), file);
    if (!lines.nextLine() || lines.word() != "ply") lines.fail("not a PLY file: it must start with \"ply\"");
    bool hasFormat = false;
    std::set<std::string> names;  // of elements
    while (lines.nextLine()) {
        const std::string_view keyword = lines.word();
        if (keyword == "end_header") {
            if (!hasFormat) lines.fail("the header has no format line");
            header.bodyLine = lines.line() + 1;
            return header;
        }
        if (keyword == "format") {
            header.format = readFormat(lines);
            hasFormat = true;
        } else if (keyword == "element") {
            PlyElement& element = header.elements.emplace_back();
            element.name = lines.word();
            const int64_t count = lines.integer("an element count");
            if (count < 0) lines.fail("element count ", count, " is negative");
            element.count = static_cast<uint64_t>(count);
            if (!names.insert(element.name).second)
                lines.fail("element \"", element.name, "\" stands here twice");
        } else if (keyword == "property") {
            if (header.elements.empty()) lines.fail("a property before the first element");
            header.elements.back().properties.push_back(readProperty(lines));
        } else if (keyword == "comment") {
            if (lines.word() == "TextureFile") header.textures.emplace_back(lines.restOfLine());
        } else if (!keyword.empty() && keyword != "obj_info") {
            lines.fail("unknown header word \"", keyword.substr(0, 40), "\"");
        }
    }
    lines.fail("the file ends before end_header");
}

// ---- The elements

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
    template <typename... Parts>
    [[noreturn]] void fail(const Parts&... what) const {
        if (format_ == PlyFormat::Ascii) lines_.fail(element_->name, ' ', what...);
        failFile(file_, element_->name, ' ', index_, ' ', what...);
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
  public:
    PlyReader(const std::filesystem::path& path, SceneFiles& files)
        : files_(files), file_(path.string()), bytes_(files.read(path)) {}

    ImportedMesh read() {
        for (size_t i = 0; i < std::min<size_t>(header_.textures.size(), 9); i++) {
            if (i == 0)
                addTexturedMaterial(header_.textures[0], file_, files_, builder_.result);
            else
                builder_.warnings.add("TextureFile ", header_.textures[i],
                                      " is ignored, all faces have the first one");
        }
        // Faces are added as they are read, after their vertices.
        const bool twice = header_.elements.empty() || header_.elements[0].name != "vertex";
        if (twice) {
            const ProgressPart part(files_, 0, 0.5);
            readElements(true, false);
        }
        const ProgressPart part(files_, twice ? 0.5 : 0, 1);
        readElements(!twice, true);
        builder_.warnings.addIgnored();
        return builder_.finish();
    }

  private:
    static constexpr uint32_t kStripEnd = Mesh::kNoIndex;

    void readElements(bool vertices, bool faces) {
        numbers_.emplace(files_.context(), std::string_view(bytes_).substr(header_.bodyOffset), file_,
                         header_);
        uint64_t faceCount = 0;
        for (PlyElement& element : header_.elements) {
            const bool isVertex = element.name == "vertex";
            const bool isFace = element.name == "face" || element.name == "tristrips";
            if (isFace) faceCount += element.count;
            if (!isVertex && !isFace) builder_.warnings.ignore("element " + element.name);
            if (isVertex && vertices)
                readVertices(element);
            else if (isFace && faces)
                readFaces(element);
            else if (!element.properties.empty())  // others take no bytes in the file
                forEach(element, [](const double*) {});
        }
        if (faceCount == 0) failFile(file_, "holds no faces; a point cloud cannot be rendered");
    }

    // Gives roles to the groups of numbers from `firstWanted` on that are complete. Ignores all other
    // properties without a role.
    void giveRoles(PlyElement& element, Role firstWanted) {
        for (const NumberGroup& group : kGroups) {
            std::vector<PlyProperty*> found;
            for (const std::string_view name : group.names)
                if (PlyProperty* const p = element.find(name); p && !p->isList) found.push_back(p);
            if (group.role < firstWanted || found.size() < group.names.size() || element.has(group.role))
                continue;
            for (size_t i = 0; i < found.size(); i++) found[i]->role = group.role + i;
        }
        for (const PlyProperty& property : element.properties)
            if (property.role == kUnused) builder_.warnings.ignore(element.name + " " + property.name);
    }

    // The same with the lists of a face or strip.
    void giveRolesWithLists(PlyElement& element, Role firstWanted, const std::string& plural) {
        const auto vertices = std::ranges::find(header_.elements, "vertex", &PlyElement::name);
        if (vertices == header_.elements.end()) failFile(file_, "holds no vertices");
        vertexCount_ = static_cast<int64_t>(vertices->count);
        PlyProperty* indices = element.find("vertex_indices");
        if (!indices) indices = element.find("vertex_index");
        if (!indices) failFile(file_, "the ", plural, " have neither a list vertex_indices nor vertex_index");
        if (!indices->isList || !isInteger(indices->type))
            failFile(file_, "\"", indices->name, "\" must be a list of integers");
        indices->role = kIndices;
        PlyProperty* const uvs = element.find("texcoord");
        if (uvs && uvs->isList) uvs->role = kCornerUvs;
        giveRoles(element, firstWanted);
    }

    // Reads all elements of a kind: add(numbers) receives the numbers of each by role; its lists are in
    // indices_ and cornerUvs_.
    template <typename Add>
    void forEach(const PlyElement& element, const Add& add) {
        for (uint64_t i = 0; i < element.count; i++) {
            double values[kUnused + 1] = {};
            indices_.clear();
            cornerUvs_.clear();
            numbers_->beginElement(element, i);
            for (const PlyProperty& property : element.properties) {
                if (property.isList)
                    readList(property, element.name == "face");
                else
                    values[property.role] = numbers_->number(property.type);
            }
            numbers_->endElement();
            add(values);
        }
    }

    void readList(const PlyProperty& property, bool isFace) {
        const size_t role = property.role;
        const int64_t count = numbers_->integer(property.countType);
        if (count < 0) numbers_->fail("list \"", property.name, "\" has ", count, " entries");
        if (role == kIndices && isFace && count > static_cast<int64_t>(kMaxPolygonCorners))
            numbers_->fail("has ", count, " vertices, the limit is ", kMaxPolygonCorners);
        for (int64_t i = 0; i < count; i++) {
            if (role == kIndices) {
                indices_.push_back(checkedVertex(numbers_->integer(property.type), isFace));
                continue;
            }
            const double number = numbers_->number(property.type);
            if (role == kCornerUvs) cornerUvs_.push_back(number);
        }
    }

    // kStripEnd for the -1 of a strip.
    uint32_t checkedVertex(int64_t index, bool isFace) const {
        if (index == -1 && !isFace) return kStripEnd;
        if (index < 0 || index >= vertexCount_)
            numbers_->fail("uses vertex ", index, ", the file has ", vertexCount_, " (numbered from 0)");
        return static_cast<uint32_t>(index);
    }

    void readVertices(PlyElement& element) {
        giveRoles(element, kPosition);
        if (!element.has(kPosition)) failFile(file_, "the vertices lack one of the properties x, y, z");
        if (element.count >= Mesh::kNoIndex) failFile(file_, "more than 2^32 - 2 vertices");
        if (element.has(kColor)) setColorCodes(element);
        const bool normals = element.has(kNormal);
        vertexUvs_ = element.has(kUv);
        vertexColors_ = element.has(kColor);
        forEach(element, [&](const double* v) {
            mesh_.positions.emplace_back(v[0], v[1], v[2]);
            if (normals) mesh_.normals.emplace_back(v[3], v[4], v[5]);
            if (vertexUvs_) mesh_.uvs.emplace_back(v[6], v[7]);
            if (vertexColors_) mesh_.colors.emplace_back(v[8], v[9], v[10]);
        });
    }

    // Integers are sRGB codes, floats are linear.
    void setColorCodes(const PlyElement& element) {
        const bool integers = std::ranges::any_of(element.properties, [](const PlyProperty& property) {
            return property.role == kColor && isInteger(property.type);
        });
        builder_.colorCodes = integers ? MeshBuilder::ColorCodes::Integers : MeshBuilder::ColorCodes::Linear;
    }

    void readFaces(PlyElement& element) {
        if (element.name == "tristrips") {
            giveRolesWithLists(element, kIndices, "triangle strips");
            return forEach(element, [&](const double*) { addStrip(); });
        }
        giveRolesWithLists(element, kColor, "faces");
        const bool ownColors = element.has(kColor) && !vertexColors_;
        if (ownColors) setColorCodes(element);
        if (element.has(kColor) && vertexColors_) builder_.warnings.ignore("face red, green, blue");
        // At least a byte for the count and for each index.
        builder_.reserve(std::min<uint64_t>(element.count, bytes_.size() / 4));
        forEach(element, [&](const double* v) {
            if (ownColors) mesh_.colors.emplace_back(v[8], v[9], v[10]);
            addFace(ownColors);
        });
    }

    // Adds a triangle for each vertex of a strip and the two before it, as scanners write it (Cyberware,
    // Stanford). Every other triangle is reversed, so that all face the same side; -1 starts a new strip.
    // Repeated vertices, which join strips, form no triangle.
    void addStrip() {
        const std::vector<uint32_t> strip = std::exchange(indices_, {});
        std::array<uint32_t, 2> last{};
        uint32_t length = 0;  // since the last -1
        for (const uint32_t vertex : strip) {
            if (vertex == kStripEnd) {
                length = 0;
                continue;
            }
            if (length >= 2 && vertex != last[0] && vertex != last[1] && last[0] != last[1]) {
                const bool turned = length % 2 != 0;
                indices_ = {last[turned ? 1 : 0], last[turned ? 0 : 1], vertex};
                addFace(false);
            }
            last = {last[1], vertex};
            length++;
        }
    }

    // Adds the face of the vertices indices_. Its own attributes replace those of its vertices: the last
    // colour, and a list of texture coordinates with two for each corner.
    void addFace(bool ownColor) {
        const size_t count = indices_.size();
        const bool ownUvs = !cornerUvs_.empty() && cornerUvs_.size() / 2 == count;
        const size_t firstUv = mesh_.uvs.size();
        if (firstUv + count >= Mesh::kNoIndex) failFile(file_, "more than 2^32 - 2 texture coordinates");
        for (size_t k = 0; ownUvs && k < count; k++)
            mesh_.uvs.emplace_back(cornerUvs_[2 * k], cornerUvs_[2 * k + 1]);
        polygon_.assign(count, {});
        for (size_t k = 0; k < count; k++) {
            const uint32_t vertex = indices_[k];
            polygon_[k].vertex = vertex;
            if (!mesh_.normals.empty()) polygon_[k].normal = vertex;
            if (vertexUvs_) polygon_[k].uv = vertex;
            if (ownUvs) polygon_[k].uv = static_cast<uint32_t>(firstUv + k);
            if (vertexColors_) polygon_[k].color = vertex;
            if (ownColor) polygon_[k].color = static_cast<uint32_t>(mesh_.colors.size() - 1);
        }
        builder_.addPolygon(polygon_, builder_.result.materials.empty() ? Mesh::kNoIndex : 0);
    }

    SceneFiles& files_;
    const std::string file_, bytes_;
    PlyHeader header_ = readPlyHeader(files_.context(), bytes_, file_);
    std::optional<PlyNumbers> numbers_;
    MeshBuilder builder_{file_};
    Mesh& mesh_ = builder_.result.mesh;
    int64_t vertexCount_ = 0;
    // Lists of the element at hand.
    std::vector<uint32_t> indices_;
    std::vector<double> cornerUvs_;
    bool vertexUvs_ = false, vertexColors_ = false;
    std::vector<MeshCorner> polygon_;  // scratch of addFace
};

}  // namespace

ImportedMesh readPly(const std::filesystem::path& path, SceneFiles& files) {
    return PlyReader(path, files).read();
}

}  // namespace glint
