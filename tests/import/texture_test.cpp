// Textures in scene files and models.
#include <cmath>

#include "core/image_io.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::texture_test {
// A folder with tiny.png, 2 x 1 texels: sRGB codes 188 and 0.
class TextureFilesTest : public testing::Test {
  protected:
    TextureFilesTest() {
        Image image(2, 1, 4, 0.0f);
        for (int c = 0; c < 3; c++) image.at(0, 0, c) = 0.5029f;
        image.at(0, 0, 3) = 1;
        writeImage(folder_.path() / "tiny.png", image);
    }
    Scene parseIn(const std::string& text) const { return parseScene(text, "s.json", folder_.path()); }
    std::string errorIn(const std::string& material) const {
        return errorOf([&] { parseIn(R"({"materials": {"m": )" + material + "}}"); });
    }
    const TemporaryFolder folder_;
};

TEST_F(TextureFilesTest, ImagesAreReadOnceAndDecoded) {
    const Scene scene = parseIn(R"({"materials": {
        "a": {"diffuse": {"texture": "tiny.png", "wrap": ["clamp", "mirror"], "filter": "nearest",
                          "scale": [2, 3], "offset": [0.5, -1], "color": [1, 0.5, 0]}},
        "b": {"diffuse": 0.3, "ambient": {"texture": "./tiny.png"}, "mirror": {"texture": "tiny.png", "color": 0.5}}}})");
    ASSERT_EQ(scene.textures.size(), 3u);
    const auto& image = std::get<ImageTexture>(scene.textures[0].source);
    // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4
    EXPECT_NEAR(image.image->at(0, 0, 0), std::pow((188 / 255.0 + 0.055) / 1.055, 2.4), 1e-7);
    EXPECT_NEAR(image.image->at(0, 0, 0), 0.50289, 1e-5);
    EXPECT_EQ(image.image->at(1, 0, 3), 0);
    EXPECT_EQ(image.wrapU, Wrap::Clamp);
    EXPECT_EQ(image.wrapV, Wrap::Mirror);
    EXPECT_EQ(image.filter, TexelFilter::Nearest);
    EXPECT_EQ(scene.textures[0].scale, glm::dvec2(2, 3));
    EXPECT_EQ(scene.textures[0].offset, glm::dvec2(0.5, -1));
    EXPECT_EQ(scene.materials[0].diffuse, Color(1, 0.5, 0));
    // Ambient follows diffuse, texture and all.
    EXPECT_EQ(scene.materials[0].ambient, Color(1, 0.5, 0));
    EXPECT_EQ(scene.materials[0].ambientTexture, scene.materials[0].diffuseTexture);
    EXPECT_EQ(scene.materials[1].diffuseTexture, Material::kNoTexture);
    EXPECT_EQ(scene.materials[1].ambient, Color(1));
    EXPECT_EQ(scene.materials[1].mirror, Color(0.5));
    for (const Texture& texture : scene.textures)
        EXPECT_EQ(std::get<ImageTexture>(texture.source).image, image.image);
}

TEST_F(TextureFilesTest, CheckersAndEnvironments) {
    const Scene scene =
        parseIn(R"({"background": {"environment": "tiny.png", "rotation": 90, "intensity": [1, 2, 3]},
        "materials": {"a": {"diffuse": {"checker": [1, [0.5, 0, 0]], "solid": true, "scale": 4, "corner": [1, 2, 3]}}}})");
    const auto& checker = std::get<CheckerTexture>(scene.textures[0].source);
    EXPECT_EQ(checker.a, Color(1));
    EXPECT_EQ(checker.b, Color(0.5, 0, 0));
    EXPECT_TRUE(checker.solid);
    EXPECT_EQ(checker.corner, glm::dvec3(1, 2, 3));
    EXPECT_EQ(scene.textures[0].scale.x, 4);
    ASSERT_TRUE(scene.environment.has_value());
    EXPECT_EQ(scene.environment->rotation, 90);
    EXPECT_EQ(scene.environment->intensity, Color(1, 2, 3));
    EXPECT_EQ(scene.environment->image->width, 2);
}

TEST_F(TextureFilesTest, ErrorsSayWhereAndHowToMend) {
    folder_.write("broken.png", "not an image");
    const std::string broken = errorIn(R"({"specular": {"texture": "broken.png"}})");
    EXPECT_STARTS(broken,
                  "s.json: /materials/m/specular/texture: " + (folder_.path() / "broken.png").string());
    EXPECT_EQ(errorIn(R"({"diffuse": {"textur": "tiny.png"}})"),
              "s.json: /materials/m/diffuse: must hold \"texture\": \"FILE\" or \"checker\": [a, b], or be a "
              "number or [r, g, b]");
    EXPECT_EQ(
        errorIn(R"({"diffuse": {"texture": "tiny.png", "wrap": "tile"}})"),
        "s.json: /materials/m/diffuse/wrap: must be \"repeat\", \"clamp\" or \"mirror\" (got \"tile\")");
    EXPECT_EQ(errorIn(R"({"diffuse": {"texture": "tiny.png", "filter": 1}})"),
              "s.json: /materials/m/diffuse/filter: must be \"bilinear\" or \"nearest\" (got 1)");
    EXPECT_EQ(errorIn(R"({"diffuse": {"texture": "tiny.png", "scale": 0}})"),
              "s.json: /materials/m/diffuse/scale: must be finite and not 0 (got 0)");
    EXPECT_EQ(errorIn(R"({"diffuse": {"checker": [1]}})"),
              "s.json: /materials/m/diffuse/checker: must be two colours [a, b] (got [1])");
    EXPECT_EQ(errorIn(R"({"diffuse": {"checker": [1, 0], "solid": true, "offset": [1, 0]}})"),
              "s.json: /materials/m/diffuse/offset: a solid checker is moved by \"corner\": [x, y, z]");
    EXPECT_EQ(errorIn(R"({"diffuse": {"checker": [1, -1]}})"),
              "s.json: /materials/m/diffuse/checker/1: must be >= 0 (got -1)");
    EXPECT_EQ(errorIn(R"({"alphaCutoff": 0.5})"),
              "s.json: /materials/m/alphaCutoff: needs a diffuse texture, whose alpha it is compared with");
    EXPECT_EQ(errorIn(R"({"diffuse": {"texture": "tiny.png"}, "alphaCutoff": 2})"),
              "s.json: /materials/m/alphaCutoff: must be from 0 to 1 (got 2)");
    EXPECT_EQ(errorIn(R"({"mirror": {"texture": "tiny.png", "color": 2}})"),
              "s.json: /materials/m/mirror: must be from 0 to 1 (got 2)");
    EXPECT_EQ(errorOf([&] { parseIn(R"({"background": {"rotation": 1}})"); }),
              "s.json: /background: missing key \"environment\"");
}

// A mask of its own size, and one that is the colours' own alpha under another name.
TEST_F(TextureFilesTest, MtlMasks) {
    Image mask(4, 4, 4, 1.0f);
    mask.at(1, 2, 3) = 0;
    writeImage(folder_.path() / "mask.png", mask);
    folder_.write("m.mtl",
                  "newmtl a\nmap_Kd tiny.png\nmap_d -s 2 2 mask.png\n"
                  "newmtl b\nmap_Kd mask.png\nmap_d ./mask.png\n");
    const auto path = folder_.write(
        "m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    const Scene scene = loadScene(path);
    for (const Material& material : scene.materials) {
        const Image& image = *std::get<ImageTexture>(scene.textures.at(material.diffuseTexture).source).image;
        EXPECT_EQ(image.at(1, 2, 3), 0);
        EXPECT_EQ(image.at(2, 1, 3), 1);
    }
    EXPECT_EQ(scene.warnings, Lines{(folder_.path() / "m.mtl").string() + ": map_d is placed as map_Kd is"});
}

TEST_F(TextureFilesTest, ObjBringsCoordinatesColorsAndMaps) {
    folder_.write("m.mtl",
                  "newmtl skin\nKd 0 0 0\nmap_Kd -s 2 3 1 -o 0.5 0 0 tiny.png\nnewmtl leaf\nKd 1 1 1\n"
                  "map_Kd tiny.png\nmap_d tiny.png\nnewmtl lost\nKd 0.5 0.5 0.5\nmap_Kd gone.png\n");
    const auto path = folder_.write("m.obj",
                                    "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0\n"
                                    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.25 0.75\n"
                                    "usemtl skin\nf 1/1 2/2 3/3 4/4\nusemtl leaf\nf 1/1 2/2 3/-1\n"
                                    "usemtl lost\nf 1 2 3\n");
    const Scene scene = loadScene(path);
    const Mesh& mesh = meshOf(scene);
    ASSERT_EQ(mesh.corners.size(), 4u);
    ASSERT_EQ(mesh.uvCorners.size(), 4u);
    for (size_t i = 0; i < 2; i++) EXPECT_EQ(mesh.uvCorners[i], mesh.corners[i]);
    EXPECT_EQ(mesh.uvCorners[2], glm::uvec3(0, 1, 3));
    EXPECT_EQ(mesh.uvCorners[3], glm::uvec3(Mesh::kNoIndex));
    EXPECT_EQ(mesh.uvs[3], glm::dvec2(0.25, 0.75));
    EXPECT_EQ(mesh.colors[1], Color(0, 1, 0));
    EXPECT_EQ(mesh.colors[3], Color(1));
    EXPECT_EQ(mesh.colorCorners[0], mesh.corners[0]);
    const Material& skin = scene.materials[0];
    EXPECT_EQ(skin.diffuse, Color(1));  // a black Kd would hide the map
    EXPECT_EQ(skin.ambientTexture, skin.diffuseTexture);
    EXPECT_EQ(scene.textures[skin.diffuseTexture].scale, glm::dvec2(2, 3));
    EXPECT_EQ(scene.textures[skin.diffuseTexture].offset, glm::dvec2(0.5, 0));
    EXPECT_EQ(scene.materials[1].alphaCutoff, 0.5);
    EXPECT_EQ(scene.materials[2].diffuseTexture, Material::kNoTexture);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_HAS(scene.warnings[0], "gone.png: no such file; drawn without it");
}

// A mirroring transform exchanges the second and third corner of everything.
TEST_F(TextureFilesTest, MirroredMeshesKeepTheirCoordinates) {
    folder_.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n");
    const Scene scene = parseIn(R"({"meshes": {"m": {"file": "m.obj"}},
        "objects": [{"type": "mesh", "mesh": "m", "transform": [{"scale": [-1, 1, 1]}]}]})");
    const Mesh& mesh = meshOf(scene);
    EXPECT_EQ(mesh.corners[0], glm::uvec3(0, 2, 1));
    EXPECT_EQ(mesh.uvCorners[0], glm::uvec3(0, 2, 1));
    EXPECT_EQ(scene.objects[0].applied.linear[0][0], -1);
}

}  // namespace glint::test::texture_test
