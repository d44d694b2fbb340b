// STL files written byte by byte.

#include "import/readers.h"
#include "support.h"

namespace glint::test::stl_test {

using glm::dvec3;

struct Facet {
    dvec3 normal, a, b, c;
    uint16_t attribute = 0;
};

std::string binary(const std::vector<Facet>& facets, const std::string& title = "made by a test") {
    std::string bytes = title;
    bytes.resize(80, '\0');
    put(bytes, static_cast<uint32_t>(facets.size()));
    for (const Facet& facet : facets) {
        for (const dvec3& v : {facet.normal, facet.a, facet.b, facet.c})
            for (int i = 0; i < 3; i++) put(bytes, static_cast<float>(v[i]));
        put(bytes, facet.attribute);
    }
    return bytes;
}

// A tetrahedron wound outwards: 4 triangles, 12 corners, 4 different vertices.
const std::vector<Facet> kTetrahedron = {{{0, 0, -1}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                         {{0, -1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                         {{-1, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                         {{1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

std::string asciiFacet(const std::string& normal, const std::string& a, const std::string& b,
                       const std::string& c) {
    return "facet normal " + normal + "\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
           "\n endloop\nendfacet\n";
}

const std::string kFacet = asciiFacet("0 0 1", "0 0 0", "1 0 0", "0 1 0");

double signedVolume(const Mesh& mesh) {
    double volume = 0;
    for (const glm::uvec3& c : mesh.corners)
        volume += glm::dot(mesh.positions[c.x], glm::cross(mesh.positions[c.y], mesh.positions[c.z])) / 6;
    return volume;
}

ImportedMesh import(const std::string& bytes) {
    return OneFile("m.stl").mesh(bytes);
}

std::string error(const std::string& bytes) {
    return OneFile("m.stl").error(bytes);
}

TEST(Stl, BinaryVerticesAreWelded) {
    const ImportedMesh imported = import(binary(kTetrahedron));
    EXPECT_EQ(imported.mesh.corners.size(), 4u);
    EXPECT_EQ(imported.mesh.positions.size(), 4u);
    EXPECT_TRUE(imported.mesh.normals.empty());
    EXPECT_TRUE(imported.materials.empty());
    EXPECT_TRUE(imported.warnings.empty());
    EXPECT_DOUBLE_EQ(signedVolume(imported.mesh), 1.0 / 6);
}

TEST(Stl, BinaryThatStartsWithSolid) {
    EXPECT_EQ(
        import(binary(kTetrahedron, "solid things come from ascii files as a rule")).mesh.corners.size(), 4u);
}

TEST(Stl, AsciiNumbersAreRead) {
    const ImportedMesh imported =
        import("solid a name with facet and vertex in it\n" +
               asciiFacet("0 0 0", "1.0000000001 +2 -3e-2", "123456.123456789 0 0", "0 1 0") +
               "endsolid a name with facet and vertex in it\n");
    ASSERT_EQ(imported.mesh.positions.size(), 3u);
    EXPECT_EQ(imported.mesh.positions[0], dvec3(1.0000000001, 2, -3e-2));
    EXPECT_EQ(imported.mesh.positions[1].x, 123456.123456789);
    EXPECT_TRUE(imported.warnings.empty());  // a normal of zero disagrees with nothing
}

TEST(Stl, AsciiLayoutIsFree) {
    EXPECT_EQ(import("solid\r\nFACET NORMAL 0 0 1 OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 VERTEX 0 1 0 ENDLOOP "
                     "ENDFACET\r\nENDSOLID\r\n")
                  .mesh.corners.size(),
              1u);
}

TEST(Stl, OddTextIsRead) {
    const std::string text = "solid a\n" + kFacet + "endsolid a\n";
    const std::string odd =
        "solid a\n" + asciiFacet("-1.#IND nan 1,0", "0 0 0", "1 0 0", "0 1 0") + "endsolid\n";
    for (const std::string& bytes :
         {"\xef\xbb\xbf" + text, "; made by x\n# y\n" + text, text + std::string(900, '\0'), odd}) {
        EXPECT_EQ(import(bytes).mesh.corners.size(), 1u) << bytes;
        EXPECT_TRUE(import(bytes).warnings.empty());
    }
    for (const bool big : {false, true}) {
        std::string wide = big ? "\xfe\xff" : "\xff\xfe";
        for (const char c : text) wide += big ? std::string(1, '\0') + c : c + std::string(1, '\0');
        EXPECT_EQ(error(wide), ": is UTF-16 text, save it as UTF-8");
    }
    EXPECT_EQ(import(binary(kTetrahedron, "\xff\xfe")).mesh.corners.size(), 4u) << "a title of a binary file";
    EXPECT_EQ(import(binary(kTetrahedron, "a")).mesh.corners.size(), 4u);
}

TEST(Stl, SeveralSolidsAreOneMesh) {
    const Mesh mesh = import("solid a\n" + kFacet + "endsolid a\nsolid b\n" +
                             asciiFacet("0 0 1", "1 0 0", "1 1 0", "0 1 0") + "endsolid\n")
                          .mesh;
    EXPECT_EQ(mesh.corners.size(), 2u);
    EXPECT_EQ(mesh.positions.size(), 4u);  // the edge between them is shared
}

TEST(Stl, ZerosOfBothSignsAreEqual) {
    EXPECT_EQ(import("solid\n" + kFacet + asciiFacet("0 0 1", "-0 0 0", "0 1 -0.0", "-1 0 0") + "endsolid\n")
                  .mesh.positions.size(),
              4u);
}

TEST(Stl, NormalsAgainstTheWindingAreWarnedAbout) {
    std::vector<Facet> facets = kTetrahedron;
    facets[1].normal = -facets[1].normal;
    facets[3].normal = dvec3(0);
    EXPECT_EQ(
        import(binary(facets)).warnings,
        Lines{"ignored the stored normals of 1 facet, which point against the winding of the vertices"});
    EXPECT_DOUBLE_EQ(signedVolume(import(binary(facets)).mesh), 1.0 / 6);
}

TEST(Stl, WhatElseIsWarnedAbout) {
    std::vector<Facet> facets = kTetrahedron;
    facets[0].attribute = 0x8123;
    facets[2].attribute = 1;
    EXPECT_EQ(import(binary(facets) + "tail").warnings,
              (Lines{"ignored the attribute bytes of 2 facets, in which some programs keep colours",
                     "ignored 4 bytes after the last triangle"}));
    facets = kTetrahedron;
    facets.push_back({{0, 0, 1}, {1, 1, 1}, {1, 1, 1}, {2, 2, 2}});
    EXPECT_EQ(import(binary(facets)).warnings,
              Lines{"1 face with fewer than three different vertices left out"});
}

TEST(Stl, Errors) {
    const std::string whole = binary(kTetrahedron);
    EXPECT_EQ(error(whole.substr(0, 84 + 3 * 50 + 49)), ": byte 283: the file ends after 3 of 4 triangles");
    EXPECT_EQ(error(whole.substr(0, 83)), ": neither ascii STL (\"solid ...\") nor long enough for binary");
    EXPECT_EQ(error(binary({})), ": holds no faces; points and lines cannot be rendered");
    EXPECT_EQ(error("solid a\nendsolid a\n"), ": holds no faces; points and lines cannot be rendered");
    EXPECT_EQ(error("solid a\n" + kFacet), ":8: the file ends where \"endsolid\" is expected");
    EXPECT_EQ(error("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 x\n"),
              ":5: \"x\" is not a number (a vertex needs one)");
    EXPECT_EQ(error("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0"),
              ":5: the file ends within a vertex");
    EXPECT_EQ(error("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 "
                    "1 0\nvertex 0 1 0\nendloop\n"),
              ":7: expected \"endloop\" (got \"vertex\")");
    EXPECT_EQ(error("solid a\nface normal\n"), ":2: expected \"facet\" or \"endsolid\" (got \"face\")");
}

// Any prefix of a good file is read or refused, never worse.
TEST(Stl, TruncationsAreRefused) {
    const std::string whole = binary(kTetrahedron), text = "solid a\n" + kFacet + "endsolid\n";
    for (size_t n = 1; n < whole.size(); n++) EXPECT_NE(error(whole.substr(0, n)), "no error") << n;
    for (size_t n = 1; n + 9 < text.size(); n++) EXPECT_NE(error(text.substr(0, n)), "no error") << n;
}

}  // namespace glint::test::stl_test
