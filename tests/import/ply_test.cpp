#include <cmath>

#include "core/image_io.h"
#include "import/readers.h"
#include "support.h"

namespace glint::test::ply_test {

using glm::dvec3;
using glm::uvec3;

ImportedMesh import(const std::string& bytes) {
    return OneFile("m.ply").mesh(bytes);
}

std::string error(const std::string& bytes) {
    return OneFile("m.ply").error(bytes);
}

std::string header(const std::string& format, const std::string& rest) {
    return "ply\nformat " + format + " 1.0\ncomment made by a test\n" + rest + "end_header\n";
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kList = "property list uchar int vertex_indices\n";
const std::string kSquare = "element vertex 4\n" + kXyz + "element face 2\n" + kList;
const std::string kStrips = "element tristrips 1\nproperty list int int vertex_indices\n";
const std::string kSquareVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

// The same square with every scalar type somewhere, elements and properties to skip, and lists in the wrong
// places.
std::string binarySquare(bool big) {
    std::string bytes =
        header(big ? "binary_big_endian" : "binary_little_endian",
               "element camera 1\nproperty list ushort int8 tags\nproperty double view\n"
               "element vertex 4\nproperty int16 y\nproperty float32 confidence\nproperty double x\n"
               "property list uint8 uint16 links\nproperty char z\n"
               "element face 2\nproperty uint32 flags\nproperty list int16 uint vertex_index\n"
               "property list int ushort more\n");
    put<uint16_t>(bytes, 3, big);
    for (int8_t i = 0; i < 3; i++) put<int8_t>(bytes, i, big);
    put<double>(bytes, 7, big);
    const double x[] = {0.1, 1e300, -2.5, 123456.123456789};
    for (int i = 0; i < 4; i++) {
        put<int16_t>(bytes, static_cast<int16_t>(-1000 * i), big);
        put<float>(bytes, 0.5f, big);
        put<double>(bytes, x[i], big);
        put<uint8_t>(bytes, 2, big);
        put<uint16_t>(bytes, 65535, big);
        put<uint16_t>(bytes, 1, big);
        put<int8_t>(bytes, static_cast<int8_t>(-i), big);
    }
    for (uint32_t face = 0; face < 2; face++) {
        put<uint32_t>(bytes, 0xffffffffu, big);
        put<int16_t>(bytes, 3, big);
        for (uint32_t k = 0; k < 3; k++) put<uint32_t>(bytes, face + k, big);
        put<int32_t>(bytes, 1, big);
        put<uint16_t>(bytes, 9, big);
    }
    return bytes;
}

TEST(Ply, AsciiWithNormalsQuadsAndExtras) {
    const ImportedMesh imported =
        import(header("ascii", "element vertex 4\n" + kXyz +
                                   "property float nx\nproperty float ny\nproperty float nz\nproperty float "
                                   "s\nproperty uchar red\n"
                                   "element face 2\nproperty uchar flag\n" +
                                   kList + "element edge 1\nproperty int a\nproperty int b\n") +
               "0 0 0 0 0 1 0.5 255\n1 0 0 0 0 2 0.5 255\n1 1 0 0 1 0 0.5 255\n0 1 0 1 0 0 0.5 255\n9 4 0 1 "
               "2 3\n9 3 2 1 0\n0 1\n");
    const Mesh& mesh = imported.mesh;
    EXPECT_EQ(mesh.positions, (std::vector<dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.normals, (std::vector<dvec3>{{0, 0, 1}, {0, 0, 2}, {0, 1, 0}, {1, 0, 0}}));
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}, {2, 1, 0}}));
    EXPECT_EQ(mesh.normalCorners, mesh.corners);
    EXPECT_EQ(mesh.faces, (std::vector<uint32_t>{0, 0, 1}));
    EXPECT_EQ(imported.warnings, Lines{"ignored: vertex s, vertex red, face flag, element edge"});
}

// Colours of vertices replace those of faces, also if faces come first.
TEST(Ply, EachElementHasItsOwnTypeOfColours) {
    const std::string faces = "element face 1\n" + kList +
                              "property uchar red\nproperty uchar "
                              "green\nproperty uchar blue\n";
    const ImportedMesh imported = import(header("ascii", faces + "element vertex 3\n" + kXyz +
                                                             "property float red\nproperty float green\n"
                                                             "property float blue\n") +
                                         "3 0 1 2 9 9 9\n0 0 0 0.25 0.5 2\n1 0 0 0 0 0\n0 1 0 0 0 0\n");
    EXPECT_EQ(imported.mesh.colors.at(0), Color(0.25, 0.5, 2));
}

TEST(Ply, TextureCoordinatesAndColoursOfEveryType) {
    const auto colorOf = [](const std::string& type, const std::string& prefix, const std::string& rgb) {
        const std::string three = "property " + type + " " + prefix + "red\nproperty " + type + " " + prefix +
                                  "green\nproperty " + type + " " + prefix + "blue\n";
        const ImportedMesh imported =
            import("\xef\xbb\xbf" +
                   header("ascii", "element vertex 3\n" + kXyz + "property float " +
                                       (prefix.empty() ? "s" : "texture_u") + "\nproperty float " +
                                       (prefix.empty() ? "t" : "texture_v") + "\n" + three +
                                       "element face 1\n" + kList) +
                   "0 0 0 0.5 1 " + rgb + "\n1 0 0 0 0 0 0 0\n0 1 0 0 0 0 0 0\n3 0 1 2\n");
        EXPECT_EQ(imported.mesh.uvs.at(0), glm::dvec2(0.5, 1));
        EXPECT_EQ(imported.mesh.uvCorners, imported.mesh.corners);
        return imported.mesh.colors.at(0);
    };
    const double half = std::pow((128 / 255.0 + 0.055) / 1.055, 2.4);  // IEC 61966-2-1
    for (const char* type : {"uchar", "ushort", "int", "float"}) {
        EXPECT_NEAR(colorOf(type, "", "255 0 128").x, 1, 1e-15) << type;
        EXPECT_NEAR(colorOf(type, "", "255 0 128").z, half, 1e-15) << type;
    }
    EXPECT_NEAR(colorOf("uchar", "diffuse_", "255 0 128").z, half, 1e-15);
    EXPECT_NEAR(colorOf("ushort", "", "65535 0 32896").z, half, 1e-15);
    EXPECT_EQ(colorOf("float", "", "0.25 0.5 2"), Color(0.25, 0.5, 2)) << "fractions are linear";
}

// MeshLab's way: a list of texture coordinates, and colours, of each face; here around the list of vertices.
TEST(Ply, FacesWithColoursAndTextureCoordinatesOfTheirOwn) {
    const std::string wedge = "property list uchar float texcoord\n";
    const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    const std::string vertices = "element vertex 4\n" + kXyz;
    for (const bool late : {false, true}) {
        const std::string faces = "element face 3\n" + rgb + wedge + kList;
        const std::string facesText =
            "255 0 0 6 0 0 0.5 0 1 1 3 0 1 2\n0 255 0 0 3 0 2 3\n0 0 255 8 0 0 1 0 1 1 0 1 4 0 1 2 3\n";
        const Mesh mesh = import(header("ascii", late ? faces + vertices : vertices + faces) +
                                 (late ? facesText + kSquareVertices : kSquareVertices + facesText))
                              .mesh;
        ASSERT_EQ(mesh.corners.size(), 4u);
        ASSERT_EQ(mesh.uvCorners.size(), 4u);
        EXPECT_EQ(mesh.uvs[mesh.uvCorners[0].y], glm::dvec2(0.5, 0));
        EXPECT_EQ(mesh.uvs[mesh.uvCorners[0].z], glm::dvec2(1, 1));
        EXPECT_EQ(mesh.uvCorners[1], uvec3(Mesh::kNoIndex)) << "an empty list";
        EXPECT_EQ(mesh.uvs[mesh.uvCorners[3].z], glm::dvec2(0, 1)) << "0 2 3 of the square";
        const Color colors[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
        for (size_t i = 0; i < 4; i++) {
            ASSERT_EQ(mesh.colorCorners[i].x, mesh.colorCorners[i].z);
            EXPECT_NEAR(glm::distance(mesh.colors[mesh.colorCorners[i].x], colors[i]), 0, 1e-15);
        }
    }
}

TEST(Ply, FacesWithoutTextureCoordinatesMayComeFirst) {
    const Mesh mesh = import(header("ascii", kSquare + "property list uchar float texcoord\n") +
                             kSquareVertices + "3 0 1 2 0\n3 0 2 3 6 0 0 1 1 0 1\n")
                          .mesh;
    ASSERT_EQ(mesh.uvCorners.size(), 2u);
    EXPECT_EQ(mesh.uvCorners[0], uvec3(Mesh::kNoIndex));
    EXPECT_EQ(mesh.uvs[mesh.uvCorners[1].y], glm::dvec2(1, 1));
}

TEST(Ply, TheTextureOfMeshLab) {
    const TemporaryFolder folder;
    const std::string text =
        "ply\nformat ascii 1.0\ncomment TextureFile gone.png\n" + kSquare + "end_header\n" + kSquareVertices;
    const ImportedMesh imported = importMesh(folder.write("m.ply", text + "3 0 1 2\n3 0 2 3\n"));
    EXPECT_TRUE(imported.materials.empty());
    ASSERT_EQ(imported.warnings.size(), 1u);
    EXPECT_ENDS(imported.warnings[0], "gone.png: no such file; drawn without it");
    writeImage(folder.path() / "gone.png", Image(1, 1, 3, 0.5f));
    const ImportedMesh textured = importMesh(folder.path() / "m.ply");
    ASSERT_EQ(textured.textures.size(), 1u);
    EXPECT_EQ(textured.materials.at(0).diffuseTexture, 0u);
    EXPECT_EQ(textured.mesh.materials, (std::vector<uint32_t>{0, 0}));
}

TEST(Ply, AsciiKeepsDoublePrecisionAndBadVertices) {
    const Mesh mesh =
        import(header("ascii",
                      "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                      "element face 1\nproperty list uchar int vertex_index\n") +
               "123456.123456789 0.1 nan\n\n1 -inf 0\n0 1 1e999\n3 0 1 2\n")
            .mesh;
    EXPECT_EQ(mesh.positions[0].x, 123456.123456789);
    EXPECT_EQ(mesh.positions[0].y, 0.1);
    EXPECT_TRUE(std::isnan(mesh.positions[0].z));
    EXPECT_EQ(mesh.positions[1].y, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{0, 1, 2}}));
}

TEST(Ply, BinaryOfBothEnds) {
    for (const bool big : {false, true}) {
        const Mesh mesh = import(binarySquare(big)).mesh;
        ASSERT_EQ(mesh.positions.size(), 4u);
        EXPECT_EQ(mesh.positions[0], dvec3(0.1, 0, 0));
        EXPECT_EQ(mesh.positions[1], dvec3(1e300, -1000, -1));
        EXPECT_EQ(mesh.positions[3], dvec3(123456.123456789, -3000, -3));
        EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {1, 2, 3}}));
        EXPECT_TRUE(mesh.faces.empty());
    }
}

TEST(Ply, EveryTruncationOfABinaryFileIsSaid) {
    const std::string whole = binarySquare(false);
    const size_t body = whole.find("end_header\n") + 11;
    for (size_t size = body; size < whole.size(); size++) {
        const std::string message = error(whole.substr(0, size));
        EXPECT_STARTS(message, ": the file ends after ") << size;
    }
    EXPECT_EQ(error(whole.substr(0, whole.size() - 1)), ": the file ends after 1 of 2 elements \"face\"");
}

TEST(Ply, TruncatedAsciiIsSaid) {
    const std::string text = header("ascii", kSquare) + kSquareVertices;  // the header has 10 lines
    EXPECT_EQ(error(text + "3 0 1 2\n"), ":15: the file ends after 1 of 2 elements \"face\"");
    EXPECT_EQ(error(text + "3 0 1 2\n3 0 2\n"), ":16: face needs a whole number more");
    EXPECT_EQ(error(header("ascii", kSquare) + "0 0 0\n1 0"), ":12: vertex needs a number more");
}

TEST(Ply, LineEndsOfAllSystems) {
    const std::string unixText = header("ascii", kSquare) + kSquareVertices + "3 0 1 2\n3 0 2 3\n";
    std::string dos, mac;
    for (const char c : unixText) {
        dos += c == '\n' ? "\r\n" : std::string(1, c);
        mac += c == '\n' ? '\r' : c;
    }
    for (const std::string& text : {unixText, dos, mac})
        EXPECT_EQ(import(text).mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}}));
    // Binary behind a header with CR LF; the first byte of the data is a line feed.
    std::string binary =
        "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 3\r\nproperty uchar x\r\nproperty uchar "
        "y\r\n"
        "property uchar z\r\nelement face 1\r\nproperty list uchar uchar vertex_indices\r\nend_header\r\n";
    binary += std::string("\n\0\0\0\1\0\0\0\1\3\0\1\2", 13);
    EXPECT_EQ(import(binary).mesh.positions[0], dvec3(10, 0, 0));
}

TEST(Ply, BadIndicesAndCounts) {
    const std::string text = header("ascii", kSquare) + kSquareVertices;
    EXPECT_EQ(error(text + "3 0 1 4\n3 0 1 2\n"),
              ":15: face uses vertex 4, the file has 4 (numbered from 0)");
    EXPECT_EQ(error(text + "3 0 1 2\n3 0 -1 2\n"),
              ":16: face uses vertex -1, the file has 4 (numbered from 0)");
    EXPECT_EQ(error(text + "-3 0 1 2\n"), ":15: face list \"vertex_indices\" has -3 entries");
    EXPECT_EQ(error(text + "3 0 1 x\n"), ":15: \"x\" is not a whole number (face needs one)");
    EXPECT_EQ(error(text + "3 0 1 2 3\n"), ":15: the line has more numbers than the header announces");
    EXPECT_EQ(error(text + "20000 0 1 2\n"), ":15: face has 20000 vertices, the limit is 10000");
    EXPECT_EQ(error(header("ascii", kSquare) + "0 0 zero\n"),
              ":11: \"zero\" is not a number (vertex needs one)");

    std::string binary =
        header("binary_little_endian", "element vertex 3\n" + kXyz + "element face 2\n" + kList);
    for (int i = 0; i < 9; i++) put<float>(binary, static_cast<float>(i), false);
    for (const int last : {2, 7}) {
        put<uint8_t>(binary, 3, false);
        for (const int index : {0, 1, last}) put<int32_t>(binary, index, false);
    }
    EXPECT_EQ(error(binary), ": face 1 uses vertex 7, the file has 3 (numbered from 0)");
}

TEST(Ply, AHeaderThatLiesReservesNoMemory) {
    EXPECT_EQ(error(header("binary_little_endian",
                           "element vertex 4000000000\n" + kXyz + "element face 1\n" + kList) +
                    "xx"),
              ": the file ends after 0 of 4000000000 elements \"vertex\"");
    EXPECT_EQ(
        error(header("ascii", "element vertex 1\n" + kXyz + "element face 9000000000000000000\n" + kList) +
              "0 0 0\n"),
        ":11: the file ends after 0 of 9000000000000000000 elements \"face\"");
    // Elements without properties take no room, however many there are.
    const Mesh mesh = import(header("ascii", "element nothing 9000000000000000000\n" + kSquare) +
                             kSquareVertices + "3 0 1 2\n3 0 2 3\n")
                          .mesh;
    EXPECT_EQ(mesh.corners.size(), 2u);
}

TEST(Ply, FacesOnBothSidesOfTheVerticesKeepTheirOrder) {
    const Mesh mesh =
        import(header("ascii", "element face 1\n" + kList + "element vertex 4\n" + kXyz + kStrips) +
               "3 3 2 1\n" + kSquareVertices + "3 0 1 2\n")
            .mesh;
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{3, 2, 1}, {0, 1, 2}}));
    EXPECT_TRUE(mesh.faces.empty());
}

TEST(Ply, VertexIndicesGoBeforeVertexIndex) {
    const Mesh mesh = import(header("ascii", "element vertex 4\n" + kXyz +
                                                 "element face 1\nproperty int vertex_index\n" + kList) +
                             kSquareVertices + "7 3 3 2 1\n")
                          .mesh;
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{3, 2, 1}}));
}

TEST(Ply, HeadersThatAreNotUnderstood) {
    EXPECT_EQ(error("solid cube\n"), ":1: not a PLY file: it must start with \"ply\"");
    EXPECT_EQ(error("ply\nformat ascii 2.0\nend_header\n"), ":2: format version \"2.0\" is not 1.0");
    EXPECT_EQ(error("ply\nformat binary 1.0\nend_header\n"),
              ":2: unknown format \"binary\" (known: ascii, binary_little_endian, binary_big_endian)");
    EXPECT_EQ(error("ply\nend_header\n"), ":2: the header has no format line");
    EXPECT_EQ(error("ply\nformat ascii 1.0\nelement vertex 3\n"), ":3: the file ends before end_header");
    EXPECT_EQ(error("ply\ncomment not end_header\nformat ascii 1.0\n"),
              ":3: the file ends before end_header");
    EXPECT_EQ(error(header("ascii", "element vertex -1\n")), ":4: element count -1 is negative");
    EXPECT_EQ(error(header("ascii", "element vertex many\n")),
              ":4: \"many\" is not a whole number (an element count needs one)");
    EXPECT_EQ(error(header("ascii", "element vertex 1\nproperty real x\n")),
              ":5: unknown property type \"real\"");
    EXPECT_EQ(error(header("ascii", "element vertex 1\nproperty list float int x\n")),
              ":5: a list's count must be of an integer type");
    EXPECT_EQ(error(header("ascii", "property float x\n")), ":4: a property before the first element");
    EXPECT_EQ(error(header("ascii", "elements vertex 1\n")), ":4: unknown header word \"elements\"");
    EXPECT_EQ(error(header("ascii", "element vertex 1\nelement vertex 1\n")),
              ":5: element \"vertex\" stands here twice");
}

TEST(Ply, ContentsThatCannotBeDrawn) {
    EXPECT_EQ(error(header("ascii", "element vertex 1\n" + kXyz) + "0 0 0\n"),
              ": holds no faces; a point cloud cannot be rendered");
    EXPECT_EQ(error(header("ascii", "element vertex 1\n" + kXyz + "element face 0\n" + kList) + "0 0 0\n"),
              ": holds no faces; a point cloud cannot be rendered");
    EXPECT_EQ(error(header("ascii", "element vertex 1\nproperty float x\nelement face 1\n" + kList)),
              ": the vertices lack one of the properties x, y, z");
    EXPECT_EQ(error(header("ascii", "element vertex 1\n" + kXyz + "element face 1\nproperty int n\n") +
                    "0 0 0\n1\n"),
              ": the faces have neither a list vertex_indices nor vertex_index");
    EXPECT_EQ(error(header("ascii", "element face 1\n" + kList) + "3 0 1 2\n"), ": holds no vertices");
    EXPECT_EQ(error(header("ascii", "element vertex 1\n" + kXyz +
                                        "element face 1\nproperty list uchar float vertex_index\n") +
                    "0 0 0\n"),
              ": \"vertex_index\" must be a list of integers");
}

// A row of four triangles over five vertices and, after -1, one of a sixth: (0 1 2), (1 2 3) turned round,
// ... Runs of fewer than three vertices and repeated vertices make none.
TEST(Ply, TriangleStrips) {
    const std::string vertices = "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n9 9 9\n";
    const std::string head = header("ascii", "element vertex 6\n" + kXyz + kStrips);
    const ImportedMesh plain = import(head + vertices + "9 0 1 2 3 4 -1 5 0 1\n");
    EXPECT_EQ(plain.mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {5, 0, 1}}));
    EXPECT_TRUE(plain.mesh.faces.empty()) << "each is a face of its own";
    EXPECT_TRUE(plain.warnings.empty());
    // The repeated vertex counts: (3 2 4) is the third after (0 1 2), and turned round.
    const ImportedMesh joined = import(head + vertices + "11 -1 -1 0 1 -1 0 1 2 2 3 4\n");
    EXPECT_EQ(joined.mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {3, 2, 4}}));
}

std::string binaryStrip(bool big) {
    std::string bytes =
        header(big ? "binary_big_endian" : "binary_little_endian", "element vertex 4\n" + kXyz + kStrips);
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f})
        put<float>(bytes, x, big);
    put<int32_t>(bytes, 6, big);
    for (const int32_t index : {0, 1, 2, 3, -1, 0}) put<int32_t>(bytes, index, big);
    return bytes;
}

TEST(Ply, BinaryTriangleStrips) {
    for (const bool big : {false, true}) {
        const std::string bytes = binaryStrip(big);
        EXPECT_EQ(import(bytes).mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {2, 1, 3}})) << big;
        EXPECT_EQ(error(bytes.substr(0, bytes.size() - 1)),
                  ": the file ends after 0 of 1 elements \"tristrips\"");
    }
}

TEST(Ply, StripsThatCannotBeDrawn) {
    const std::string head = header("ascii", "element vertex 3\n" + kXyz + kStrips) + "0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(error(head + "3 0 1 3\n"), ":14: tristrips uses vertex 3, the file has 3 (numbered from 0)");
    EXPECT_EQ(error(head + "3 0 1 -2\n"), ":14: tristrips uses vertex -2, the file has 3 (numbered from 0)");
    EXPECT_EQ(error(head + "-1 0 1 2\n"), ":14: tristrips list \"vertex_indices\" has -1 entries");
    EXPECT_NE(error(head + "4 0 1 2\n"), "no error") << "the line ends too early";
    EXPECT_EQ(error(head), ":13: the file ends after 0 of 1 elements \"tristrips\"");
    EXPECT_EQ(error(head + "2 0 1\n"), ": holds no faces; points and lines cannot be rendered");
    EXPECT_EQ(error(header("ascii", "element vertex 1\n" + kXyz + "element tristrips 1\nproperty int n\n") +
                    "0 0 0\n1\n"),
              ": the triangle strips have neither a list vertex_indices nor vertex_index");
}

// Found by fuzzing: names of elements came into messages as they are.
TEST(Ply, MessagesArePrintable) {
    for (const std::string form : {"ascii", "binary_little_endian"}) {
        const std::string message =
            error(header(form, "element \x1b[31m 5\nproperty list uchar int n\n" + kXyz));
        EXPECT_HAS(message, "[31m");
        EXPECT_EQ(message.find('\x1b'), std::string::npos) << message;
    }
}

}  // namespace glint::test::ply_test
