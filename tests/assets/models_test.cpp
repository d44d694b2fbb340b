// Well-known models: triangle counts and boxes as their sources state them.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>

#include "import/load.h"
#include "import/readers.h"
#include "support/support.h"

namespace glint::test::models_test {

using glm::dvec3;

struct Model {
    const char* file;
    size_t triangles;
    dvec3 low, high;  // printed with five digits
    const char* warning = "";
};

void PrintTo(const Model& model, std::ostream* out) {
    *out << model.file;
}

const Model kModels[] = {
    {"meshes/stanford-bunny.obj", 69451, {-0.09469, 0.032987, -0.061874}, {0.061009, 0.18732, 0.0588}},
    {"meshes/bun_zipper.ply",
     69451,
     {-0.09469, 0.032987, -0.061874},
     {0.061009, 0.18732, 0.0588},
     "ignored: vertex confidence, vertex intensity"},
    {"meshes/dragon_vrip_res2.ply", 202520, {-0.10819, 0.052739, -0.050345}, {0.096406, 0.19714, 0.041137}},
    {"meshes/dragon_vrip_res3.ply", 47794, {-0.10767, 0.052774, -0.050051}, {0.095982, 0.19664, 0.040826}},
    {"meshes/armadillo.obj", 86482, {-0.43528, -0.5734, -0.37948}, {0.40334, 0.42655, 0.38333}},
    {"meshes/teapot.obj", 6320, {-3, 0, -2}, {3.434, 3.15, 2}},
    {"meshes/suzanne.ply", 968, {-1.3672, 0.28356, -0.895}, {1.3672, 2.2523, 0.80812}},
    {"meshes/spot/spot_triangulated.obj", 5856, {-0.47155, -0.73678, -0.66891}, {0.47155, 0.95365, 1.049}},
    {"meshes/spot/spot_quadrangulated.obj", 5856, {-0.47155, -0.73678, -0.66891}, {0.47155, 0.95365, 1.049}},
    {"meshes/spot/spot_control_mesh.obj",
     372,
     {-0.58597, -0.75913, -0.69622},
     {0.58597, 0.98403, 1.0778},
     "4 faces cross themselves"},  // none of them is flat, and seen along an axis they do
    {"cornell/cornell_box.obj", 36, {0, 0, 0}, {556, 548.8, 559.2}},
    {"cornell/cornellbox_suzanne.obj", 980, {-5.1449, -0.031673, -4.9553}, {4.6588, 9.7728, 4.7865}},
    {"meshes/spd_mount_sf9.ply", 524288, {-1, -1, -0.60973}, {1, 1, 0.30485}},
};

class Asset : public testing::TestWithParam<Model> {};

TEST_P(Asset, HasTheStatedTrianglesAndBox) {
    const auto path = assetPath(GetParam().file);
    const Scene scene = loadScene(path);
    const Mesh& mesh = *std::get<MeshShape>(scene.objects[0].shape).mesh;
    EXPECT_EQ(mesh.corners.size(), GetParam().triangles);
    dvec3 low(1e300), high(-1e300);
    for (const glm::uvec3& c : mesh.corners)
        for (int k = 0; k < 3; k++) {
            low = glm::min(low, mesh.positions[c[k]]);
            high = glm::max(high, mesh.positions[c[k]]);
        }
    for (int k = 0; k < 3; k++) {
        const double unit = 1e-4 * std::max(std::abs(low[k]), std::abs(high[k]));  // of five digits
        EXPECT_NEAR(low[k], GetParam().low[k], unit);
        EXPECT_NEAR(high[k], GetParam().high[k], unit);
    }
    const std::string warning = scene.warnings.empty() ? "" : scene.warnings[0];
    EXPECT_LE(scene.warnings.size(), 1u);
    EXPECT_EQ(warning.empty(), *GetParam().warning == 0) << warning;
    EXPECT_NE(warning.find(GetParam().warning), std::string::npos) << warning;
}

std::string modelName(const testing::TestParamInfo<Model>& tested) {
    std::string name = std::filesystem::path(tested.param.file).filename().string();
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Models, Asset, testing::ValuesIn(kModels), modelName);

TEST(Assets, BunnyIsTheSameInObjAndPly) {
    const auto obj = assetPath("meshes/stanford-bunny.obj"), ply = assetPath("meshes/bun_zipper.ply");
    const Mesh a = importMesh(obj).mesh, b = importMesh(ply).mesh;
    EXPECT_EQ(a.corners, b.corners);
    ASSERT_EQ(a.positions.size(), b.positions.size());
    // The OBJ has six decimals, so it is off by half a unit of the sixth.
    for (size_t i = 0; i < a.positions.size(); i++)
        for (int k = 0; k < 3; k++) ASSERT_NEAR(a.positions[i][k], b.positions[i][k], 0.5000001e-6) << i;
}

TEST(Assets, SuzanneHasNormalsAndQuads) {
    const auto path = assetPath("meshes/suzanne.ply");
    const Mesh mesh = importMesh(path).mesh;
    EXPECT_EQ(mesh.positions.size(), 1966u);  // as the header says
    EXPECT_EQ(mesh.normals.size(), 1966u);
    EXPECT_EQ(mesh.normalCorners, mesh.corners);
    ASSERT_EQ(mesh.faces.size(), 968u);
    EXPECT_EQ(mesh.faces.back(), 499u);  // 500 faces, 468 of them quads
}

}  // namespace glint::test::models_test
