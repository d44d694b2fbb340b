// glTF materials as Whitted's: the formulas of docs/reference/file-formats.md, and the pictures.
#include <cmath>

#include "core/codecs.h"
#include "core/quantize.h"
#include "gltf_maker.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::gltf_material_test {

Scene load(const std::string& bytes) {
    return OneFile("a.gltf").scene(bytes);
}

// Of the material with these members; `rest` goes into the document.
Material material(const std::string& members, const std::string& rest = "") {
    const Scene scene = load(triangleGltf("\"materials\": [{" + members + "}]" + rest));
    return scene.materials.at(0);
}

std::string pbr(const std::string& members) {
    return "\"pbrMetallicRoughness\": {" + members + "}";
}

std::string extension(const std::string& name, const std::string& members) {
    return "\"extensions\": {\"KHR_materials_" + name + "\": {" + members + "}}";
}

std::string png(int width, int height, int channels, const Bytes& samples) {
    const Bytes file = encodePng(width, height, channels, samples);
    return {file.begin(), file.end()};
}

std::string dataUri(const std::string& bytes) {
    return "\"data:image/png;base64," + base64(bytes) + "\"";
}

// A triangle with TEXCOORD_0 and TEXCOORD_1, a material, and texture 0 of this picture.
Scene textured(const std::string& members, const std::string& picture, const std::string& texture = "",
               const std::string& rest = "") {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    maker.floats({0, 0, 1, 0, 0.25f, 0.75f}, "VEC2");
    maker.floats({0.5f, 0.5f, 0, 0, 1, 1}, "VEC2");
    return load(maker.text(
        R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0,
          "TEXCOORD_0": 1, "TEXCOORD_1": 2}, "material": 0}]}], "materials": [{)" +
        members + R"(}], "textures": [{"source": 0)" + texture + R"(}], "images": [{"uri": )" +
        dataUri(picture) + "}]" + rest));
}

std::string specularGlossiness(const std::string& members) {
    return R"("extensions": {"KHR_materials_pbrSpecularGlossiness": {)" + members + "}}";
}

// Reflectance 0.04 and glossiness 1/2 are a dielectric of roughness 1/2, whose base colour is 0.96 of the
// diffuse one: all numbers of ARoughDielectric but diffuse follow.
TEST(GltfMaterial, SpecularGlossinessAsMetallicRoughness) {
    const std::string members = specularGlossiness(
        R"("diffuseFactor": [0.8, 0.4, 0.2, 1], "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.5)");
    const Material m = material(members);
    expectNear(m.diffuse, 0.96 * Color(0.8, 0.4, 0.2));
    EXPECT_DOUBLE_EQ(m.shininess, 30);
    expectNear(m.specular, Color(0.16));
    EXPECT_EQ(m.mirror, Color(0));
    EXPECT_EQ(m.ambient, m.diffuse);
    // A smooth metal: nothing is scattered, the mirror has the specular colour.
    const Material gold = material(specularGlossiness(R"("specularFactor": [1, 0.75, 0.3])"));
    EXPECT_EQ(gold.diffuse, Color(0));
    expectNear(gold.mirror, Color(1, 0.75, 0.3));
    // A rough one: 1 - 0.04 of its red surroundings' light, as nothing else shows them.
    const Material rough =
        material(specularGlossiness(R"("specularFactor": [1, 0.04, 0.54], "glossinessFactor": 0)"));
    EXPECT_EQ(rough.mirror, Color(0));
    expectNear(rough.ambient, Color(0.96, 0, 0.5));
    // It counts where both are given, and is asked for without complaint where a file requires it.
    const Scene both =
        load(triangleGltf("\"materials\": [{" + pbr(R"("baseColorFactor": [0, 0, 1, 1])") + ", " + members +
                          R"(}], "extensionsUsed": ["KHR_materials_pbrSpecularGlossiness"],
        "extensionsRequired": ["KHR_materials_pbrSpecularGlossiness"])"));
    EXPECT_EQ(both.materials.at(0).diffuse, m.diffuse);
    EXPECT_EQ(both.warnings,
              Lines{"KHR_materials_pbrSpecularGlossiness is approximated by metallic-roughness"});
}

// A texture's colours are sRGB, its alpha is a number: 188 is half of the light (IEC 61966-2-1), 51 a fifth.
TEST(GltfMaterial, SpecularGlossinessTextures) {
    const Scene scene = textured(specularGlossiness(R"("diffuseTexture": {"index": 0, "texCoord": 1},
        "specularGlossinessTexture": {"index": 0}, "glossinessFactor": 0.5)"),
                                 png(1, 1, 4, {188, 0, 0, 204}));
    const Material& m = scene.materials.at(0);
    const double half = linearFromSrgb(188 / 255.0);
    EXPECT_NEAR(half, 0.5, 0.005);
    expectNear(m.diffuse, Color(1 - half), 1e-6);
    EXPECT_NE(m.diffuseTexture, Material::kNoTexture);
    EXPECT_EQ(m.specularTexture, Material::kNoTexture);
    const double alpha = 0.6 * 0.6;  // roughness 1 - 0.5 * 204 / 255
    EXPECT_NEAR(m.shininess, 2 / (alpha * alpha) - 2, 1e-5);
    expectNear(m.specular, Color((m.shininess + 2) / 8 * half, 0, 0), 1e-6);
    EXPECT_EQ(scene.warnings.back(), "specularGlossinessTexture is replaced by its mean values");
}

TEST(GltfMaterial, ARoughDielectric) {
    const Material m = material(pbr(R"("baseColorFactor": [0.8, 0.4, 0.2, 1], "metallicFactor": 0,
        "roughnessFactor": 0.5)"));
    expectNear(m.diffuse, Color(0.8, 0.4, 0.2));
    // alpha = 1/4: 2 * 16 - 2 = 30; F0 = (0.5 / 2.5)^2 = 0.04, times (30 + 2) / 8.
    EXPECT_DOUBLE_EQ(m.shininess, 30);
    expectNear(m.specular, Color(0.16));
    EXPECT_EQ(m.mirror, Color(0));
    EXPECT_EQ(m.transmission, Color(0));
    EXPECT_EQ(m.ambient, m.diffuse);
}

// The highlight's peak is that of GGX seen head on, D F / 4 with D = 1 / (pi alpha^2) (Walter et al. 2007),
// times pi for glint's units.
TEST(GltfMaterial, HighlightsAreAsBrightAsTheirDistribution) {
    for (const double roughness : {0.2, 0.4, 0.7, 1.0}) {
        const Material m =
            material(pbr("\"metallicFactor\": 0, \"roughnessFactor\": " + std::to_string(roughness)));
        const double alpha2 = std::pow(roughness, 4);
        EXPECT_NEAR(m.specular.x, 0.04 / (4 * alpha2), 1e-9 / alpha2);
    }
}

TEST(GltfMaterial, Metals) {
    const Material mirror = material(pbr(R"("baseColorFactor": [1, 0.8, 0.5, 1], "roughnessFactor": 0.1)"));
    EXPECT_EQ(mirror.diffuse, Color(0));
    expectNear(mirror.mirror, 0.8 * Color(1, 0.8, 0.5));  // 1 - 2 * 0.1
    expectNear(mirror.ambient, 0.2 * Color(1, 0.8, 0.5));
    const Material rough = material(pbr(R"("baseColorFactor": [1, 0.8, 0.5, 1], "roughnessFactor": 0.9)"));
    EXPECT_EQ(rough.mirror, Color(0));
    expectNear(rough.ambient, Color(1, 0.8, 0.5));
    const Material smooth = material(pbr(R"("metallicFactor": 1, "roughnessFactor": 0)"));
    EXPECT_EQ(smooth.shininess, 1e5);
    EXPECT_EQ(smooth.mirror, Color(1));
}

TEST(GltfMaterial, IorSetsTheReflectance) {
    const Material m =
        material(pbr(R"("metallicFactor": 0, "roughnessFactor": 0)") + ", " + extension("ior", "\"ior\": 2"));
    expectNear(m.mirror, Color(1.0 / 9));
}

TEST(GltfMaterial, Glass) {
    const Material m =
        material(pbr(R"("baseColorFactor": [1, 0.9, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 0)") +
                 R"(, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75},
            "KHR_materials_ior": {"ior": 1.33}, "KHR_materials_volume": {"thicknessFactor": 0.1,
            "attenuationDistance": 2, "attenuationColor": [0.25, 1, 0.5]}})");
    expectNear(m.transmission, 0.75 * Color(1, 0.9, 0.8));
    EXPECT_EQ(m.ior, 1.33);
    EXPECT_EQ(m.mirror, Color(0));
    expectNear(m.diffuse, 0.25 * Color(1, 0.9, 0.8));
    // After the attenuation distance the attenuation colour is left.
    expectNear(glm::exp(-2.0 * m.attenuation), Color(0.25, 1, 0.5));
}

TEST(GltfMaterial, ThinGlassDoesNotBend) {
    const Material m = material(pbr(R"("metallicFactor": 0, "roughnessFactor": 0)") + ", " +
                                extension("transmission", "\"transmissionFactor\": 1"));
    EXPECT_EQ(m.ior, 1);
    expectNear(m.transmission, Color(0.96));
    expectNear(m.mirror, Color(0.04));
}

TEST(GltfMaterial, Blending) {
    const Material m = material(pbr(R"("baseColorFactor": [1, 0.5, 0.5, 0.25], "metallicFactor": 0)") +
                                R"(, "alphaMode": "BLEND")");
    expectNear(m.diffuse, 0.25 * Color(1, 0.5, 0.5));
    expectNear(m.transmission, Color(0.75));
    EXPECT_EQ(m.ior, 1);
    const Material opaque = material(pbr(R"("baseColorFactor": [1, 0.5, 0.5, 0.25], "metallicFactor": 0)"));
    EXPECT_EQ(opaque.transmission, Color(0));
}

// Without lights in the file ambient light is 0.2, with them 1 for what is emitted and nothing else.
TEST(GltfMaterial, Emission) {
    const std::string members = pbr("\"metallicFactor\": 0") + R"(, "emissiveFactor": [0.1, 0, 0.5], )" +
                                extension("emissive_strength", "\"emissiveStrength\": 4");
    const Scene alone = load(triangleGltf("\"materials\": [{" + members + "}]"));
    EXPECT_EQ(alone.ambient, Color(0.2));
    expectNear(alone.ambient * alone.materials[0].ambient, 0.2 * Color(1) + Color(0.4, 0, 2));
    const Scene lit =
        load(triangleGltf("\"materials\": [{" + members +
                              R"(}], "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}})",
                          R"(, "extensions": {"KHR_lights_punctual": {"light": 0}})"));
    EXPECT_EQ(lit.ambient, Color(1));
    expectNear(lit.materials[0].ambient, Color(0.4, 0, 2));
}

TEST(GltfMaterial, Unlit) {
    const Material m =
        material(pbr(R"("baseColorFactor": [0.5, 0.25, 1, 1])") + ", " + extension("unlit", ""));
    expectNear(0.2 * m.ambient, Color(0.5, 0.25, 1));
    EXPECT_EQ(m.diffuse + m.specular + m.mirror, Color(0));
}

TEST(GltfMaterial, Textures) {
    // 2 x 1: red, green.
    const std::string picture = png(2, 1, 3, {255, 0, 0, 0, 128, 0});
    const Scene scene = textured(pbr(R"("metallicFactor": 0, "baseColorTexture": {"index": 0})"), picture,
                                 R"(, "sampler": 0)",
                                 R"(, "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}])");
    const Material& m = scene.materials.at(0);
    ASSERT_EQ(m.diffuseTexture, 0u);
    EXPECT_EQ(m.ambientTexture, 0u);
    EXPECT_EQ(m.mirrorTexture, Material::kNoTexture);
    const auto& image = std::get<ImageTexture>(scene.textures.at(0).source);
    EXPECT_EQ(image.wrapU, Wrap::Clamp);
    EXPECT_EQ(image.wrapV, Wrap::Mirror);
    EXPECT_EQ(image.filter, TexelFilter::Nearest);
    EXPECT_EQ(image.image->at(0, 0, 0), 1.0f);
    EXPECT_EQ(image.image->at(1, 0, 1), static_cast<float>(linearFromSrgb(128.0 / 255)));
    // glTF's v counts from the top.
    EXPECT_EQ(meshOf(scene).uvs, (std::vector<glm::dvec2>{{0, 1}, {1, 1}, {0.25, 0.25}}));
    EXPECT_EQ(meshOf(scene).uvCorners, std::vector<glm::uvec3>{glm::uvec3(0, 1, 2)});
    EXPECT_EQ(scene.textures[0].scale, glm::dvec2(1));
    EXPECT_EQ(scene.textures[0].offset, glm::dvec2(0));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfMaterial, TextureTransformsAndOtherCoordinates) {
    const Scene scene =
        textured(pbr(R"("baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform":
            {"offset": [0.1, 0.2], "scale": [2, 3], "texCoord": 1}}})"),
                 png(1, 1, 3, {9, 9, 9}));
    const Texture& t = scene.textures.at(0);
    // glTF: (u, v) = (0.5, 0.5) of TEXCOORD_1 goes to (0.1 + 1, 0.2 + 1.5), which is 1 - 1.7 from below.
    const glm::dvec2 uv = meshOf(scene).uvs.at(0);
    EXPECT_EQ(uv, glm::dvec2(0.5, 0.5));
    EXPECT_NEAR((t.scale * uv + t.offset).x, 1.1, 1e-15);
    EXPECT_NEAR((t.scale * uv + t.offset).y, 1 - 1.7, 1e-15);
}

TEST(GltfMaterial, Masks) {
    const std::string picture = png(1, 1, 4, {255, 255, 255, 100});
    const Scene scene =
        textured(pbr(R"("baseColorFactor": [1, 1, 1, 0.8], "baseColorTexture": {"index": 0})") +
                     R"(, "alphaMode": "MASK", "alphaCutoff": 0.2)",
                 picture);
    EXPECT_DOUBLE_EQ(scene.materials.at(0).alphaCutoff, 0.25);  // 0.25 * 0.8 = 0.2
    EXPECT_EQ(scene.materials[0].transmission, Color(0));
    const Scene blended =
        textured(pbr(R"("baseColorTexture": {"index": 0})") + R"(, "alphaMode": "BLEND")", picture);
    EXPECT_EQ(blended.materials.at(0).alphaCutoff, 0.5);
    EXPECT_EQ(blended.warnings,
              Lines{"alphaMode BLEND with a texture: surfaces are there where alpha is 0.5 or more"});
}

// The means of the numbers in the file, which are not colours: green roughness, blue metallic.
TEST(GltfMaterial, MetallicRoughnessTexturesAreAveraged) {
    const Scene scene = textured(pbr(R"("roughnessFactor": 0.5, "metallicRoughnessTexture": {"index": 0})"),
                                 png(2, 1, 3, {0, 255, 0, 0, 51, 102}));
    // roughness (1 + 0.2) / 2 / 2 = 0.3, metallic 0.4 / 2 = 0.2
    const Material& m = scene.materials.at(0);
    EXPECT_NEAR(m.shininess, 2 / std::pow(0.3, 4) - 2, 1e-3);
    expectNear(m.diffuse, Color(0.8), 1e-6);
    EXPECT_EQ(scene.warnings, Lines{"metallicRoughnessTexture is replaced by its mean values"});
}

TEST(GltfMaterial, WhatIsIgnoredIsNamed) {
    const Scene scene = textured(R"("normalTexture": {"index": 0}, "occlusionTexture": {"index": 0})",
                                 png(1, 1, 3, {0, 0, 0}));
    EXPECT_EQ(scene.warnings,
              (Lines{"normal maps (normalTexture) are ignored",
                     "baked shadows (occlusionTexture) are ignored: rays find shadows themselves"}));
    EXPECT_TRUE(scene.textures.empty());
    EXPECT_EQ(textured(pbr(R"("baseColorTexture": {"index": 0})"), "KTX").warnings,
              Lines{"/images/0: neither PNG, JPEG nor WebP; rendered without this image"});
}

// The shape is worth more than its picture.
TEST(GltfMaterial, PicturesThatCannotBeReadAreWarnedOf) {
    const TemporaryFolder folder;
    folder.write("damaged.png", "\x89PNG\r\n\x1a\n");
    for (const std::string uri : {"gone.png", "../gone.png", "https://example.org/a.png", "damaged.png"}) {
        const auto path = folder.write(
            "a.gltf",
            triangleGltf(R"("materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                "textures": [{"source": 0}], "images": [{"uri": ")" +
                         uri + "\"}]"));
        const Scene scene = loadScene(path);
        EXPECT_EQ(scene.objects.size(), 1u);
        EXPECT_EQ(scene.materials.at(0).diffuseTexture, Material::kNoTexture);
        ASSERT_EQ(scene.warnings.size(), 1u) << uri;
        EXPECT_STARTS(scene.warnings[0], path.string() + ": /images/0");
        EXPECT_ENDS(scene.warnings[0], "; rendered without this image");
    }
    folder.write("a.png", png(1, 1, 3, {255, 255, 255}));
    const Scene beside = loadScene(folder.write(
        "a.gltf", triangleGltf(R"("materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}], "images": [{"uri": "C:%5Ctextures%5Ca.png"}])")));
    EXPECT_EQ(beside.textures.size(), 1u) << "the file of that name beside the model";
}

// KHR_texture_transform: uv' = offset + R (scale uv), counter-clockwise as seen with v downwards.
TEST(GltfMaterial, TurnedTextures) {
    const double a = 0.5, c = std::cos(a), s = std::sin(a);
    const std::string turn = R"("extensions": {"KHR_texture_transform": {"offset": [0.1, 0.2],
        "rotation": 0.5, "scale": [2, 3]}})";
    const Scene scene =
        textured(pbr("\"baseColorTexture\": {\"index\": 0, " + turn + "}"), png(1, 1, 3, {9, 9, 9}));
    EXPECT_EQ(scene.warnings, Lines{});
    EXPECT_EQ(scene.textures.at(0).scale, glm::dvec2(1));
    EXPECT_EQ(scene.textures[0].offset, glm::dvec2(0));
    const glm::dvec2 from(0.25, 0.75), uv = meshOf(scene).uvs.at(2);
    EXPECT_NEAR(uv.x, 0.1 + c * 2 * from.x + s * 3 * from.y, 1e-15);
    EXPECT_NEAR(1 - uv.y, 0.2 - s * 2 * from.x + c * 3 * from.y, 1e-15);
    const Scene two = textured(pbr("\"baseColorTexture\": {\"index\": 0, " + turn + "}") +
                                   R"(, "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0})",
                               png(1, 1, 3, {9, 9, 9}));
    EXPECT_EQ(two.warnings,
              Lines{"a material's textures are turned differently; all are turned as the first one"});
}

TEST(GltfMaterial, PicturesInBufferViewsAndFiles) {
    const std::string picture = png(1, 1, 3, {255, 255, 255});
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    maker.floats({0, 0, 1, 0, 0.25f, 0.75f}, "VEC2");
    const size_t view = maker.view(picture);
    const TemporaryFolder folder;
    folder.write("a b.png", picture);
    const auto path = folder.write(
        "a.glb", maker.binary(
                     R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0,
               "TEXCOORD_0": 1}, "material": 0}]}], "materials": [{"pbrMetallicRoughness":
               {"baseColorTexture": {"index": 0}}, "emissiveFactor": [1, 1, 1],
               "emissiveTexture": {"index": 1}}], "textures": [{"source": 0}, {"source": 1}],
               "images": [{"mimeType": "image/png", "bufferView": )" +
                     std::to_string(view) + R"(}, {"uri": "a%20b.png"}])"));
    const Scene scene = loadScene(path);
    ASSERT_EQ(scene.textures.size(), 2u);
    for (const Texture& texture : scene.textures)
        EXPECT_EQ(std::get<ImageTexture>(texture.source).image->pixels, std::vector<float>(3, 1.0f));
    EXPECT_EQ(scene.materials.at(0).ambientTexture, 1u);
}

}  // namespace glint::test::gltf_material_test
