#include <cmath>

#include "import/readers.h"
#include "support.h"

namespace glint::test::obj_test {

using glm::dvec3;
using glm::uvec3;

constexpr uint32_t kNone = Mesh::kNoIndex;

ImportedMesh import(const std::string& text) {
    return OneFile("m.obj").mesh(text);
}

std::string error(const std::string& text) {
    return OneFile("m.obj").error(text);
}

const std::string kFour = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

// The material of an OBJ file that has no other.
struct Painted {
    Material material;
    Lines warnings;  // without the name of the MTL file
};

class Obj : public FolderTest {
  protected:
    // A square with the materials of an MTL file of this text.
    ImportedMesh importWith(const std::string& mtl) const {
        write("m.mtl", mtl);
        return importMesh(write("m.obj", "mtllib m.mtl\n" + kFour + "usemtl m\nf 1 2 3 4\n"));
    }
    Painted paint(const std::string& lines) const {
        ImportedMesh imported = importWith("newmtl m\n" + lines);
        const std::string prefix = file("m.mtl").string() + ": ";
        for (std::string& line : imported.warnings)
            if (line.starts_with(prefix)) line = line.substr(prefix.size());
        return {imported.materials.at(0), imported.warnings};
    }
};

TEST_F(Obj, Cube) {
    const Mesh mesh = import(kCubeObj).mesh;
    EXPECT_EQ(mesh.positions.size(), 8u);
    ASSERT_EQ(mesh.corners.size(), 12u);
    EXPECT_EQ(mesh.faces, (std::vector<uint32_t>{0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5}));
    EXPECT_EQ(mesh.corners[0], uvec3(0, 3, 2));
    EXPECT_EQ(mesh.corners[1], uvec3(0, 2, 1));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.normalCorners.empty());
    EXPECT_TRUE(mesh.materials.empty());
    // The divergence theorem: the outward triangles of a unit cube span the volume 1.
    double volume = 0;
    for (const uvec3& c : mesh.corners)
        volume += glm::dot(mesh.positions[c.x], glm::cross(mesh.positions[c.y], mesh.positions[c.z])) / 6;
    EXPECT_DOUBLE_EQ(volume, 1);
}

TEST_F(Obj, TrianglesAloneNeedNoFaceList) {
    const Mesh mesh = import(kFour + "f 1 2 3\nf 1 3 4\n").mesh;
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(mesh.faces.empty());
}

TEST_F(Obj, NegativeIndicesCountBackFromHere) {
    const Mesh mesh = import("v 9 9 9\n" + kFour + "f -4 -3 -2 -1\nv 5 5 5\nf -1 -2 1\n").mesh;
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>{{1, 2, 3}, {1, 3, 4}, {5, 4, 0}}));
}

TEST_F(Obj, FacesMayComeBeforeTheirVertices) {
    EXPECT_EQ(import("f 1 2 3\n" + kFour).mesh.corners[0], uvec3(0, 1, 2));
}

TEST_F(Obj, LineEndsOfAllSystems) {
    std::string text = "# dos\r\nv 0 0 0\r\nv 1 0 0 \r\nv 0 1 0\r\nf 1 2 3\r\n";
    EXPECT_EQ(import(text).mesh.positions[2], dvec3(0, 1, 0));
    std::string mac;
    for (const char c : text)
        if (c != '\n') mac += c;
    EXPECT_EQ(import(mac).mesh.corners, (std::vector<uvec3>{{0, 1, 2}}));
    EXPECT_EQ(error("v 0 0 0\r\nv 0 0 0\r\nf 1 2 9\r\n"), ":3: face uses vertex 9, the file has 2");
    EXPECT_EQ(error("v 0 0 0\rv 0 0 0\rf 1 2 9\r"), ":3: face uses vertex 9, the file has 2");
    EXPECT_EQ(import(kFour + "f 1 2 3").mesh.corners.size(), 1u);  // no line end at the end
}

TEST_F(Obj, ContinuedLinesAndComments) {
    const std::vector<uvec3> corners = {{0, 1, 2}, {2, 1, 0}};
    const ImportedMesh imported =
        import("# a path C:\\\no a\ng b\ns 1\nv 0 0 \\\n0 # end\nv 1 0 0\nv 0 1 0\nf 1 \\\r\n2 3\nf 3 2 1");
    EXPECT_EQ(imported.mesh.corners, corners);
    EXPECT_EQ(imported.warnings, Lines{}) << "objects, groups and smoothing are not drawn, but no loss";
    EXPECT_EQ(import("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 \\\r\n2 \\\r\n3\r\nf 3 2 1\r\n").mesh.corners,
              corners)
        << "two continued lines with line ends of DOS";
    EXPECT_EQ(error("v 0 0 \\\n0\nv x 0 0\n"), ":3: \"x\" is not a number (a vertex needs one)");
}

TEST_F(Obj, NumbersInAllSpellingsAndFullPrecision) {
    const Mesh mesh = import(
                          "v +1 -2. .5\nv 1e3 1E-2 +.25e+1\nv 123456.123456789 0.1 -0.35444599999999998\n"
                          "v 1 2 3 1.0\nv 1 2 3 0.5 0.5 0.5\nv 1e-400 -1e-400 4.9e-324\nf 1 2 3\n")
                          .mesh;
    EXPECT_EQ(mesh.positions[0], dvec3(1, -2, 0.5));
    EXPECT_EQ(mesh.positions[1], dvec3(1000, 0.01, 2.5));
    EXPECT_EQ(mesh.positions[2], dvec3(123456.123456789, 0.1, -0.35444599999999998));
    EXPECT_EQ(mesh.positions[4], dvec3(1, 2, 3));
    EXPECT_EQ(mesh.positions[5], dvec3(0, 0, 4.9e-324));
}

TEST_F(Obj, VerticesThatAreNotFiniteAreKept) {
    const Mesh mesh = import("v nan 0 0\nv 1 -inf 0\nv 0 1e999 0\nf 1 2 3\n").mesh;
    EXPECT_TRUE(std::isnan(mesh.positions[0].x));
    EXPECT_EQ(mesh.positions[1].y, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(mesh.positions[2].y, std::numeric_limits<double>::infinity());
    EXPECT_EQ(mesh.corners.size(), 1u);
}

TEST_F(Obj, NormalsWhereAllCornersHaveThem) {
    const Mesh mesh =
        import(
            kFour +
            "vn 0 0 1\nvn 0 1 1\nvt 0 0\nf 1//1 2//2 3//1\nf 1/1/1 3/1/-1 4/1/1\nf 1//1 2 3\nf 1/1 2/1 3/1\n")
            .mesh;
    ASSERT_EQ(mesh.normals.size(), 2u);
    EXPECT_EQ(mesh.normals[1], dvec3(0, 1, 1));  // as in the file, not normalised
    EXPECT_EQ(mesh.normalCorners, (std::vector<uvec3>{{0, 1, 0}, {0, 1, 0}, uvec3(kNone), uvec3(kNone)}));
}

TEST_F(Obj, SlashesWithNothingBehindThem) {
    const Mesh mesh = import(kFour + "vn 0 0 1\nf 1// 2// 3//\nf 1/ 2/ 3/\nf 1//1 2//1 3//1\n").mesh;
    EXPECT_EQ(mesh.corners, (std::vector<uvec3>(3, {0, 1, 2})));
    EXPECT_EQ(mesh.normalCorners, (std::vector<uvec3>{uvec3(kNone), uvec3(kNone), uvec3(0)}));
}

TEST_F(Obj, NormalsThatNoFaceUsesAreDropped) {
    const Mesh mesh = import(kFour + "vn 0 0 1\nf 1 2 3\n").mesh;
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.normalCorners.empty());
}

TEST_F(Obj, NormalsThatAreNotFiniteLeaveTheTriangleFlat) {
    const ImportedMesh imported =
        import(kFour + "vn 0 0 1\nvn nan 0 0\nf 1//1 2//1 3//1\nf 1//1 3//2 4//1\n");
    EXPECT_EQ(imported.mesh.normalCorners, (std::vector<uvec3>{{0, 0, 0}, uvec3(kNone)}));
    EXPECT_EQ(imported.warnings, Lines{"the vertex normals of 1 triangle are not finite and are not used"});
}

TEST_F(Obj, FacesThatCrossThemselvesAreCounted) {
    const ImportedMesh imported =
        import("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\nf 1 3 2 4\nf 1 4 2 3\nf 2 1 4 3\n");
    EXPECT_EQ(imported.mesh.corners.size(), 8u);
    EXPECT_EQ(imported.warnings,
              Lines{"2 faces cross themselves: the triangles that they are split into overlap"});
}

TEST_F(Obj, DegenerateFacesAreCountedAndFacesKeepTheirNumbers) {
    const ImportedMesh imported =
        import(kFour + "f 1 1 2\nf 1 2 3\nf 1 2\nf 1 2 1 2\nf 1 2 2 3\nf 4 3 2 1\n");
    EXPECT_EQ(imported.mesh.corners.size(), 4u);
    EXPECT_EQ(imported.mesh.faces, (std::vector<uint32_t>{1, 4, 5, 5}));
    EXPECT_EQ(imported.mesh.corners[1], uvec3(0, 1, 2));
    EXPECT_EQ(imported.warnings, Lines{"3 faces with fewer than three different vertices left out"});
}

TEST_F(Obj, ErrorsSayLineAndReason) {
    EXPECT_EQ(error(kFour + "f 1 2 9\n"), ":5: face uses vertex 9, the file has 4");
    EXPECT_EQ(error(kFour + "f 1 2 0\n"), ":5: face uses vertex 0, indices start at 1");
    EXPECT_EQ(error(kFour + "f 1 2 -5\n"), ":5: face uses vertex -5, there are 4 so far");
    EXPECT_EQ(error(kFour + "f 1 2 99999999999\n"), ":5: face uses vertex 99999999999, the file has 4");
    EXPECT_EQ(error(kFour + "vn 0 0 1\nf 1//1 2//1 3//2\n"), ":6: face uses normal 2, the file has 1");
    EXPECT_EQ(error(kFour + "vt 0 0\nf 1/1 2/1 3/2\n"), ":6: face uses texture vertex 2, the file has 1");
    EXPECT_EQ(error(kFour + "f 1 two 3\n"), ":5: \"two\" is not a face vertex (v, v/vt, v//vn or v/vt/vn)");
    for (const std::string corner : {"1///", "1/1/1/1", "1.5", "/1", "1/x", "99999999999999999999", "\\"})
        EXPECT_EQ(error(kFour + "f 1 2 " + corner + "\n"),
                  ":5: \"" + corner + "\" is not a face vertex (v, v/vt, v//vn or v/vt/vn)");
    EXPECT_EQ(error("v 1 2\n"), ":1: a vertex needs a number more");
    EXPECT_EQ(error("v 1 2 # 3\n"), ":1: a vertex needs a number more");
    EXPECT_EQ(error("v 1 2 x3\n"), ":1: \"x3\" is not a number (a vertex needs one)");
    EXPECT_EQ(error("v 1 2 3x\n"), ":1: \"3x\" is not a number (a vertex needs one)");
    EXPECT_EQ(error("vn 1 2\n"), ":1: a normal needs a number more");
    EXPECT_EQ(error(kFour), ": holds no faces; points and lines cannot be rendered");
    EXPECT_EQ(error(kFour + "f 1 1 1\n"), ": no face has three different vertices");
    EXPECT_EQ(error("\x7f\x45\x4c\x46 binary"), ": holds no faces; points and lines cannot be rendered");
    std::string giant = "f";
    for (int i = 0; i < 10001; i++) giant += " 1";
    EXPECT_EQ(error(kFour + giant), ":5: face has 10001 vertices, the limit is 10000");
}

TEST_F(Obj, Materials) {
    write("a b.mtl",
          "newmtl red paint\nKa 0.1 0.2 0.3\nKd 0.8 0 0\nKs 0.5 0.5 0.5\nNs 60\nillum 2\n"
          "newmtl chrome\nKd 0.1 0.1 0.1\nKs 0.9 0.8 2\nNs 500\nillum 3\n"
          "newmtl paper\r\nKa 1 1 1\r\nKd 0.7 0.7 0.7\r\nKs 1 1 1\r\nNs 10\r\nillum 0\r\n");
    const auto file =
        write("m.obj", "mtllib a b.mtl\n" + kFour +
                           "usemtl chrome\nf 1 2 3 4\nusemtl red paint\nf 1 2 3\nusemtl paper\nf 1 2 4\n");
    const ImportedMesh imported = importMesh(file);
    EXPECT_TRUE(imported.warnings.empty());
    ASSERT_EQ(imported.materials.size(), 3u);
    EXPECT_EQ(imported.mesh.materials, (std::vector<uint32_t>{1, 1, 0, 2}));
    const Material& red = imported.materials[0];
    EXPECT_EQ(red.name, "red paint");
    expectNear(red.ambient, Color(0.1, 0.2, 0.3), 1e-15);
    expectNear(red.diffuse, Color(0.8, 0, 0), 1e-15);
    EXPECT_EQ(red.specular, Color(0.5));
    EXPECT_EQ(red.shininess, 60);
    EXPECT_EQ(red.mirror, Color(0));
    const Material& chrome = imported.materials[1];
    expectNear(chrome.ambient, Color(0.1), 1e-15);  // no Ka
    expectNear(chrome.specular, Color(0.9, 0.8, 2), 1e-15);
    expectNear(chrome.mirror, Color(0.9, 0.8, 1), 1e-15);
    const Material& paper = imported.materials[2];
    expectNear(paper.ambient, Color(0.7), 1e-15);
    expectNear(paper.diffuse, Color(0.7), 1e-15);
    EXPECT_EQ(paper.specular, Color(0));
}

// Wavefront's d (and Tr = 1 - d), Tf, Ni and illumination models.
TEST_F(Obj, MaterialsLetLightThrough) {
    write("m.mtl",
          "newmtl veil\nKd 0.8 0.4 0\nKs 0.5 0.5 0.5\nNs 10\nd 0.25\nNi 1.5\nillum 2\n"
          "newmtl tinted\nKd 0.8 0.8 0.8\nTr 0.5\nTf 1 0.5 0\nillum 4\n"
          "newmtl glass\nKd 0 0 0\nKs 1 1 1\nNs 100\nTf 0.9 1 2\nNi 1.45\nillum 7\n"
          "newmtl painted\nKd 0.5 0.5 0.5\nTf 1 1 1\nNi 1.5\nillum 2\n");
    const auto file =
        write("m.obj", "mtllib m.mtl\n" + kFour +
                           "usemtl veil\nf 1 2 3\nusemtl tinted\nf 1 2 3\nusemtl glass\nf 1 2 3\n"
                           "usemtl painted\nf 1 2 3\n");
    const ImportedMesh imported = importMesh(file);
    EXPECT_TRUE(imported.warnings.empty());
    ASSERT_EQ(imported.materials.size(), 4u);
    const Material& veil = imported.materials[0];
    expectNear(veil.transmission, Color(0.75), 1e-15);
    expectNear(veil.diffuse, Color(0.2, 0.1, 0), 1e-15);
    expectNear(veil.ambient, Color(0.2, 0.1, 0), 1e-15);
    expectNear(veil.specular, Color(0.125), 1e-15);
    EXPECT_EQ(veil.ior, 1);  // Ni bends light in the models 6 and 7 alone
    const Material& tinted = imported.materials[1];
    expectNear(tinted.transmission, Color(0.5, 0.25, 0), 1e-15);
    expectNear(tinted.diffuse, Color(0.4), 1e-15);
    EXPECT_EQ(tinted.ior, 1);
    const Material& glass = imported.materials[2];
    expectNear(glass.transmission, Color(0.9, 1, 1), 1e-15);
    expectNear(glass.specular, Color(1), 1e-15);
    EXPECT_EQ(glass.mirror, Color(0));  // Fresnel's law instead
    EXPECT_DOUBLE_EQ(glass.ior, 1.45);
    const Material& painted = imported.materials[3];  // exporters write Tf of opaque things too
    EXPECT_EQ(painted.transmission, Color(0));
    expectNear(painted.diffuse, Color(0.5), 1e-15);
}

TEST_F(Obj, MaterialsWarnOfWhatIsNotDrawn) {
    const auto mtl = write("m.mtl",
                           "newmtl a\nKd 1 1 1\nKa 0 0 0\nKs 1 1 1\nNs 0\nKe 2 0 0\nmap_Kd a.png\n"
                           "newmtl b\nKd 1 1 1\nKe 0 0 0\nmap_Kd -mm 0 1 b.png\nmap_bump c.png\n"
                           "Kd spectral x.rfl\nmap_bump d.png\n");
    const auto obj = write(
        "m.obj", "mtllib m.mtl gone.mtl\n" + kFour +
                     "f 1 2 3\nusemtl a\nf 1 2 3\nusemtl nobody\nf 1 2 3\nusemtl nobody\nf 1 2 3\nl 1 2\n"
                     "curv 0 1\nl 3 4\n");
    const ImportedMesh imported = importMesh(obj);
    const auto missing = [&](const char* name) { return file(name).string() + ": no such file; "; };
    EXPECT_EQ(imported.warnings,
              (Lines{mtl.string() + ": ignored: Ke, map_Kd -mm, map_bump, Kd spectral",
                     mtl.string() + ": " + missing("a.png") + "drawn without it",
                     mtl.string() + ": " + missing("b.png") + "drawn without it",
                     obj.string() + ":1: " + missing("gone.mtl") + "drawn without these materials",
                     obj.string() + ":9: material \"nobody\" is not defined in a material file; grey is used",
                     obj.string() + ": ignored: l, curv"}));
    ASSERT_EQ(imported.materials.size(), 3u);
    EXPECT_EQ(imported.materials[0].ambient, Color(1));   // Ka black: as diffuse
    EXPECT_EQ(imported.materials[0].specular, Color(0));  // Ns 0: no highlight
    EXPECT_EQ(imported.materials[2].name, "default");
    EXPECT_EQ(imported.mesh.materials, (std::vector<uint32_t>{2, 0, 2, 2}));
}

const Lines kInvisible{"material \"m\": d, Tr or Tf would make it invisible; drawn opaque"};

// Tr 1 and d 0 alone hide a surface altogether; exporters write them of opaque ones.
TEST_F(Obj, MaterialsThatWouldBeInvisibleAreOpaque) {
    for (const char* lines : {"Kd 1 0 0\nTr 1\n", "Kd 1 0 0\nd 0\nillum 9\n", "Kd 1 0 0\nd 0\n",
                              "Kd 1 0 0\nillum 4\nTf 1 1 1\n", "Kd 1 0 0\nillum 7\nNi 1\nTf 1 1 1\n"}) {
        const Painted painted = paint(lines);
        EXPECT_EQ(painted.material.transmission, Color(0)) << lines;
        EXPECT_EQ(painted.material.diffuse, Color(1, 0, 0)) << lines;
        EXPECT_EQ(painted.warnings, kInvisible) << lines;
    }
    EXPECT_EQ(paint("Kd 1 0 0\nd 1\nTr 1\n").warnings, Lines{}) << "d counts";
    EXPECT_EQ(paint("Kd 1 0 0\nillum 7\nNi 1.5\nd 0\n").material.transmission, Color(1)) << "glass";
    const Painted halo = paint("Kd 1 0 0\nd -halo 0.5\n");
    EXPECT_EQ(halo.material.transmission, Color(0.5));
    EXPECT_EQ(halo.warnings, Lines{"ignored: d -halo"});
}

TEST_F(Obj, MaterialNumbers) {
    EXPECT_EQ(paint("Kd 0.5\n").material.diffuse, Color(0.5)) << "g and b are r where they are missing";
    EXPECT_EQ(paint("Kd 0.25 0.75\n").material.diffuse, Color(0.25, 0.75, 0.25));
    EXPECT_EQ(paint("kd 0.1 0.2 0.3\n").material.diffuse, Color(0.1, 0.2, 0.3));
    EXPECT_EQ(paint("").material.diffuse, Color(0.8)) << "a material without colours is grey";
    const Painted negative = paint("Kd -1 0.5 0\nKs 1 1 1\nNs -1.96\nd 2\n");
    EXPECT_EQ(negative.material.diffuse, Color(0, 0.5, 0));
    EXPECT_EQ(negative.material.specular, Color(0)) << "an exponent of 0 is no highlight";
    EXPECT_EQ(negative.material.transmission, Color(0));
    EXPECT_EQ(negative.warnings, (Lines{"Kd -1 in line 2 is out of range, 0 is used",
                                        "Ns -1.96 in line 4 is out of range, 0 is used",
                                        "d 2 in line 5 is out of range, 1 is used"}));
    const Painted odd = paint("Kd nan nan nan\nNi 0\nTf 1 0 0\nillum 7\n");
    EXPECT_EQ(odd.material.ior, 1);
    EXPECT_EQ(odd.material.diffuse, Color(0.8));
    EXPECT_EQ(odd.warnings, (Lines{"Kd nan in line 2 is out of range, 0.8 is used",
                                   "Ni 0 in line 3 is out of range, 1 is used"}));
    for (const auto& [line, what] : {std::pair{"Kd 0,8 0,8 0,8", "\"0,8\" is not a number (Kd needs one)"},
                                     {"Ns x", "\"x\" is not a number (Ns needs one)"},
                                     {"map_Kd -s 0,5 1 1 a.png", "\"0,5\" is not a number (-s needs one)"}}) {
        const std::string text = std::string("newmtl m\n") + line + "\n";
        EXPECT_EQ(errorOf([&] { importWith(text); }), file("m.mtl").string() + ":2: " + what);
    }
}

TEST_F(Obj, MaterialFilesFromElsewhereAreLookedForBesideTheModel) {
    write("my m.mtl", "newmtl m\nKd 1 0 0\n");
    write("m.mtl", "newmtl m\nKd 1 0 0\n");
    for (const char* name : {"/home/x/m.mtl", "../m.mtl", "C:\\x\\m.mtl", "C:\\\\x\\\\m.mtl", "other/m.mtl",
                             "D:\\my files\\my m.mtl", "https://example.org/m.mtl"}) {
        const ImportedMesh imported =
            importMesh(write("m.obj", std::string("mtllib ") + name + "\n" + kFour + "usemtl m\nf 1 2 3\n"));
        ASSERT_EQ(imported.materials.size(), 1u) << name;
        EXPECT_EQ(imported.materials[0].diffuse, Color(1, 0, 0)) << name;
        EXPECT_EQ(imported.warnings, Lines{}) << name;
    }
    const ImportedMesh late = importMesh(write("m.obj", kFour + "usemtl m\nf 1 2 3\nmtllib m.mtl\n"));
    ASSERT_EQ(late.materials.size(), 1u) << "a material may be used before its file is named";
    EXPECT_EQ(late.materials[0].diffuse, Color(1, 0, 0));
    EXPECT_EQ(late.warnings, Lines{});
    write("empty.mtl", "");
    const ImportedMesh none = importMesh(write("m.obj", "mtllib empty.mtl\n" + kFour + "f 1 2 3\n"));
    EXPECT_EQ(none.warnings, Lines{file("m.obj").string() + ":1: " + file("empty.mtl").string() +
                                   ": the file is empty; drawn without these materials"});
}

TEST_F(Obj, ByteOrderMarks) {
    const std::string mark = "\xef\xbb\xbf";
    EXPECT_EQ(import(mark + "v -1 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n").mesh.positions[0],
              dvec3(-1, 0, 0));
    EXPECT_EQ(importWith(mark + "newmtl m\nKd 1 0 0\n").materials.at(0).diffuse, Color(1, 0, 0));
    std::string wide;
    for (const char c : "v 0 0 0\n") wide += std::string(1, c) + '\0';
    for (const std::string& text : {"\xff\xfe" + wide, wide, std::string("\xfe\xff\0v", 4)})
        EXPECT_EQ(error(text), ": is UTF-16 text, save it as UTF-8");
}

TEST_F(Obj, FacesThatNameWhatTheFileLeavesOut) {
    for (const auto& [face, what] : {std::pair{"f 1//1 2//2 3//3", "normals (vn)"},
                                     {"f 1/1 2/2 3/3", "texture vertices (vt)"},
                                     {"f 1/-1 2/-2 3/-3", "texture vertices (vt)"}}) {
        const auto file = write("m.obj", kFour + face + "\n");
        const ImportedMesh imported = importMesh(file);
        EXPECT_EQ(imported.mesh.corners, (std::vector<uvec3>{{0, 1, 2}}));
        EXPECT_TRUE(imported.mesh.normals.empty() && imported.mesh.uvs.empty());
        EXPECT_EQ(imported.warnings, Lines{file.string() + ": faces name " + what +
                                           ", but the file has none; drawn without them"});
    }
}

TEST_F(Obj, VertexColours) {
    const auto colorsOf = [](const std::string& rgb) {
        const ImportedMesh imported = import("v 0 0 0 " + rgb + "\nv 1 0 0\nv 1 1 0 1 1 1\nf 1 2 3\n");
        EXPECT_EQ(imported.mesh.colors.at(1), Color(1)) << "without a colour";
        return std::pair(imported.mesh.colors.at(0), imported.warnings.size());
    };
    // IEC 61966-2-1: ((0.5 + 0.055) / 1.055)^2.4
    EXPECT_NEAR(colorsOf("0.5 0 1").first.x, std::pow(0.555 / 1.055, 2.4), 1e-15);
    EXPECT_EQ(colorsOf("0.5 0 1").second, 0u);
    EXPECT_NEAR(colorsOf("128 0 255").first.x, std::pow((128 / 255.0 + 0.055) / 1.055, 2.4), 1e-15);
    EXPECT_EQ(colorsOf("128 0 255").second, 1u) << "codes, not fractions";
    EXPECT_EQ(colorsOf("nan 0 0"), std::pair(Color(1), size_t{1}));
    EXPECT_EQ(colorsOf("0 -1 0"), std::pair(Color(1), size_t{1}));
}

TEST_F(Obj, OtherExtensionsAreRefused) {
    const auto file = write("m.off", "solid");
    EXPECT_EQ(errorOf([&] { importMesh(file); }),
              file.string() + ": a mesh file must end in .obj, .ply, .stl, .gltf or .glb");
    EXPECT_EQ(importMesh(write("M.OBJ", kCubeObj)).mesh.corners.size(), 12u);
}

}  // namespace glint::test::obj_test
