// glTF's sample files: triangles and boxes as their sources state them.
#include <cctype>
#include <cmath>

#include "import/load.h"
#include "support/support.h"

namespace glint::test::gltf_test {
using glm::dvec3;
using glm::uvec3;

const Mesh& meshOf(const Scene& scene, size_t object = 0) {
    return *std::get<MeshShape>(scene.objects.at(object).shape).mesh;
}

dvec3 apply(const Object& object, const dvec3& p) {
    const Affine t = object.transform.value_or(Affine{});
    return t.linear * p + t.offset;
}

struct Sample {
    const char* file;
    size_t triangles, objects, textures;
    dvec3 low, high;  // as the list of the assets states them
};
void PrintTo(const Sample& sample, std::ostream* out) {
    *out << sample.file;
}

const Sample kSamples[] = {
    {"Avocado/Avocado.gltf", 682, 1, 1, {-0.021281, -4.7739e-05, -0.013809}, {0.021281, 0.062848, 0.013809}},
    {"BoxTextured/BoxTextured.gltf", 12, 1, 1, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}},
    {"BoxTextured.glb", 12, 1, 1, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}},
    {"Fox/Fox.gltf", 576, 1, 1, {-12.593, -0.12174, -88.095}, {12.593, 78.907, 66.625}},
    {"diamond.glb", 96, 1, 0, {-0.99136, -0.42851, -0.99172}, {0.9913, 0.67777, 0.99094}},
    {"usd-shaderball-ball.glb", 63856, 4, 2, {-4.4399, -4.1996e-07, -4.4399}, {4.4607, 8.2013, 4.4607}}};

class GltfAsset : public testing::TestWithParam<Sample> {};

TEST_P(GltfAsset, HasTheStatedTrianglesAndBox) {
    const auto path = assetPath(std::string("gltf/") + GetParam().file);
    const Scene scene = loadScene(path);
    EXPECT_EQ(scene.objects.size(), GetParam().objects);
    EXPECT_EQ(scene.textures.size(), GetParam().textures);
    size_t triangles = 0;
    dvec3 low(1e300), high(-1e300);
    for (size_t i = 0; i < scene.objects.size(); i++) {
        const Mesh& mesh = meshOf(scene, i);
        triangles += mesh.corners.size();
        EXPECT_EQ(mesh.uvCorners.empty(), scene.textures.empty() || (i == 0 && scene.objects.size() == 4));
        for (const uvec3& c : mesh.corners)
            for (int k = 0; k < 3; k++) {
                low = glm::min(low, apply(scene.objects[i], mesh.positions[c[k]]));
                high = glm::max(high, apply(scene.objects[i], mesh.positions[c[k]]));
            }
    }
    EXPECT_EQ(triangles, GetParam().triangles);
    for (int k = 0; k < 3; k++) {
        // Printed with five digits, from coordinates that float matrices had turned.
        const double turned = 0x1p-24 * std::max(glm::length(low), glm::length(high));
        EXPECT_NEAR(low[k], GetParam().low[k], 1e-4 * std::abs(low[k]) + turned);
        EXPECT_NEAR(high[k], GetParam().high[k], 1e-4 * std::abs(high[k]) + turned);
    }
}

std::string sampleName(const testing::TestParamInfo<Sample>& tested) {
    std::string name = tested.param.file;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Files, GltfAsset, testing::ValuesIn(kSamples), sampleName);

TEST(GltfAssets, TheBoxIsTheSameInBothContainers) {
    const Scene text = loadScene(assetPath("gltf/BoxTextured/BoxTextured.gltf"));
    const Scene binary = loadScene(assetPath("gltf/BoxTextured.glb"));
    EXPECT_EQ(meshOf(text).positions, meshOf(binary).positions);
    EXPECT_EQ(meshOf(text).corners, meshOf(binary).corners);
    EXPECT_EQ(meshOf(text).uvs, meshOf(binary).uvs);
    const auto pixels = [](const Scene& scene) {
        return std::get<ImageTexture>(scene.textures[0].source).image->pixels;
    };
    EXPECT_EQ(pixels(text), pixels(binary));
    EXPECT_EQ(std::get<ImageTexture>(text.textures[0].source).wrapU, Wrap::Mirror);  // 33648
    EXPECT_EQ(std::get<ImageTexture>(text.textures[0].source).wrapV, Wrap::Clamp);   // 33071
    EXPECT_EQ(std::get<ImageTexture>(binary.textures[0].source).wrapV, Wrap::Repeat);
}

}  // namespace glint::test::gltf_test
