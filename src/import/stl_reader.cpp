// STL (3D Systems, Stereolithography Interface Specification, 1988), ascii and binary. assimp (5.2.5) is no
// substitute: it rounds ascii coordinates to float, uses the stored normals, which are often wrong or zero,
// and reports no line numbers.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <limits>
#include <random>
#include <unordered_map>

#include "core/binary_numbers.h"
#include "import/mesh_builder.h"
#include "import/readers.h"
#include "import/text_scanner.h"

namespace glint {

namespace {

constexpr size_t kHeaderSize = 84;  // 80 bytes of anything and the number of triangles
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr size_t kFacetSize = 50;  // normal, three vertices, two attribute bytes

// Multilinear hashing with factors that differ between processes, so that no file can be written whose points
// all have the same hash (Lemire, Kaser, Strongly Universal String Hashing is Fast, 2014).
struct PointHash {
    size_t operator()(const glm::dvec3& p) const {
        static const auto random = [] {
            return uint64_t{std::random_device()()} << 32 | std::random_device()();
        };
        static const uint64_t keys[] = {random(), random(), random(), random(), random(), random(), random()};
        uint64_t hash = keys[6];
        for (int i = 0; i < 3; i++) {
            const uint64_t bits = std::bit_cast<uint64_t>(p[i]);
            hash += keys[2 * i] * (bits & 0xffffffff) + keys[2 * i + 1] * (bits >> 32);
        }
        return hash >> 32;
    }
};

// Makes a mesh of separate triangles by merging equal vertices.
class FacetCollector {
  public:
    explicit FacetCollector(const std::string& file) : builder_(file) {}

    FileWarnings& warnings() { return builder_.warnings; }

    void reserve(size_t facets) {
        builder_.reserve(facets);
        indices_.reserve(facets / 2);  // closed meshes have half as many vertices as triangles
    }

    void add(const glm::dvec3& normal, const std::array<glm::dvec3, 3>& vertices) {
        if (glm::dot(normal, glm::cross(vertices[1] - vertices[0], vertices[2] - vertices[0])) < 0)
            disagreeing_++;
        builder_.addPolygon(std::array<MeshCorner, 3>{
            {{indexOf(vertices[0])}, {indexOf(vertices[1])}, {indexOf(vertices[2])}}});
    }

    ImportedMesh finish() {
        if (disagreeing_ > 0)
            warnings().add("ignored the stored normals of ", counted(disagreeing_, "facet"),
                           ", which point against the winding of the vertices");
        return builder_.finish();
    }

  private:
    uint32_t indexOf(const glm::dvec3& vertex) {
        const glm::dvec3 key = vertex + 0.0;  // -0 becomes 0
        std::vector<glm::dvec3>& positions = builder_.result.mesh.positions;
        uint32_t index = static_cast<uint32_t>(positions.size());
        // NaN equals nothing: the search would visit all of them.
        if (key == key) index = indices_.try_emplace(key, index).first->second;
        if (index == positions.size()) positions.push_back(key);
        return index;
    }

    MeshBuilder builder_;
    std::unordered_map<glm::dvec3, uint32_t, PointHash> indices_;
    size_t disagreeing_ = 0;
};

// In ascii files line ends are blanks, except after the name of a solid.
class AsciiStl {
  public:
    AsciiStl(const Context& context, std::string_view text, const std::string& file)
        : scanner_(context, text, file), facets_(file) {}

    ImportedMesh read() {
        // Some programs sign their files before the first solid.
        while (nextWord("solid") != "solid") scanner_.restOfLine();
        for (;;) {
            scanner_.restOfLine();
            while (!expect("endsolid", "facet")) readFacet();
            scanner_.restOfLine();
            if (!scanner_.skipToWord()) break;
            expect("solid");
        }
        return facets_.finish();
    }

  private:
    std::string nextWord(const std::string& wanted) {
        if (!scanner_.skipToWord()) scanner_.fail("the file ends where \"", wanted, "\" is expected");
        return lowerCase(scanner_.word());
    }

    // Reads the word `keyword`, or `other`, if it is given: then the result is false. Fails at any other
    // word.
    bool expect(const std::string& keyword, const std::string& other = {}) {
        const std::string word = nextWord(keyword);
        if (word != keyword && (other.empty() || word != other))
            scanner_.fail("expected ", (other.empty() ? "" : '"' + other + "\" or "), '"', keyword,
                          "\" (got \"", word.substr(0, 40), "\")");
        return word == keyword;
    }

    // Normals are only compared with the winding, so invalid numbers (-1.#IND) are accepted.
    glm::dvec3 readNormal() {
        glm::dvec3 normal(0);
        for (int i = 0; i < 3; i++) {
            const std::string word = nextWord("a normal");
            const char* const end = word.data() + word.size();
            if (std::from_chars(word.data(), end, normal[i]).ptr != end) normal[i] = kNaN;
        }
        return normal;
    }

    void readFacet() {
        expect("normal");
        const glm::dvec3 normal = readNormal();
        for (const char* word : {"outer", "loop"}) expect(word);
        std::array<glm::dvec3, 3> vertices;
        for (glm::dvec3& vertex : vertices) {
            expect("vertex");
            for (int i = 0; i < 3; i++) vertex[i] = scanner_.numberPastLines("a vertex");
        }
        for (const char* word : {"endloop", "endfacet"}) expect(word);
        facets_.add(normal, vertices);
    }

    TextScanner scanner_;
    FacetCollector facets_;
};

ImportedMesh readBinary(const Context& context, std::string_view bytes, const std::string& file) {
    if (bytes.size() < kHeaderSize)
        failFile(file, "neither ascii STL (\"solid ...\") nor long enough for binary");
    const uint64_t count = loadNumber<uint32_t>(bytes.data() + kHeaderSize - 4);
    const uint64_t available = (bytes.size() - kHeaderSize) / kFacetSize;
    if (available < count)
        failFile(file, "byte ", bytes.size(), ": the file ends after ", available, " of ", count,
                 " triangles");
    FacetCollector facets(file);
    facets.reserve(count);
    size_t attributes = 0;
    for (uint64_t i = 0; i < count; i++) {
        context.pace(i, count);
        const char* facet = bytes.data() + kHeaderSize + i * kFacetSize;
        std::array<glm::dvec3, 4> vectors;
        for (size_t k = 0; k < 12; k++)
            vectors[k / 3][static_cast<int>(k % 3)] = loadNumber<float>(facet + 4 * k);
        facets.add(vectors[0], {vectors[1], vectors[2], vectors[3]});
        if (loadNumber<uint16_t>(facet + 48) != 0) attributes++;
    }
    if (attributes > 0)
        facets.warnings().add("ignored the attribute bytes of ", counted(attributes, "facet"),
                              ", in which some programs keep colours");
    const uint64_t rest = bytes.size() - kHeaderSize - count * kFacetSize;
    if (rest > 0) facets.warnings().add("ignored ", counted(rest, "byte"), " after the last triangle");
    return facets.finish();
}

// Binary files may start with "solid" too, so the size decides first: four characters of an ascii file, read
// as a number, mean half a billion triangles or more. `text` is the file without trailing zeros.
bool isAscii(std::string_view bytes, std::string_view text) {
    using namespace std::string_view_literals;
    if (bytes.size() >= kHeaderSize) {
        const uint64_t count = loadNumber<uint32_t>(bytes.data() + kHeaderSize - 4);
        if (bytes.size() == kHeaderSize + count * kFacetSize) return false;
    }
    for (const std::string_view utf16 : {"\xff\xfe"sv, "\xfe\xff"sv, "s\0o\0"sv})
        if (text.starts_with(utf16)) return true;  // the text reader refuses UTF-16
    // A binary file of another size is damaged; its counts and numbers hold zero bytes.
    std::string_view head = text.substr(0, 1024);
    if (head.find('\0') != head.npos) return false;
    if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
    while (!head.empty()) {
        head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
        if (lowerCase(head.substr(0, 5)) == "solid") return true;
        head.remove_prefix(std::min(head.find_first_of("\r\n"), head.size()));
    }
    return false;
}

}  // namespace

ImportedMesh readStl(const std::filesystem::path& path, SceneFiles& files) {
    const std::string file = path.string();
    const std::string bytes = files.read(path);
    // Some programs write zeros after the last solid.
    const std::string_view text = std::string_view(bytes).substr(0, bytes.find_last_not_of('\0') + 1);
    return isAscii(bytes, text) ? AsciiStl(files.context(), text, file).read()
                                : readBinary(files.context(), bytes, file);
}

}  // namespace glint
