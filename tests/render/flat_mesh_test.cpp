// T81 for neighbours: rays that start on a face of a flat mesh do not hit the neighbouring faces. A point's
// rounding may move it over an edge, and in a plane through the origin of coordinates no error bound lifts it
// off.
#include <cmath>

#include "mutant_kernels.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::flat_mesh_test {
using glm::dvec3;

std::shared_ptr<const Mesh> flatGrid(uint32_t count, double cell, const dvec3& from) {
    auto mesh = glint::test::gridMesh(count);
    for (dvec3& p : mesh->positions) p = from + cell * dvec3(p.y, 0, p.x);
    return mesh;
}

enum class Made { OneMesh, Tiles };

// A mirror floor of 60 x 60 at the given height. It is so far away that a coordinate's last place is a
// thousandth of a cell. The camera is above it, far enough that coordinates are not counted from the floor's
// middle; there is nothing else.
Case floorCase(Made made, double height) {
    constexpr double kCell = 0.1, kSize = 60;
    const dvec3 middle(1000, height, 700);
    Case c = textCase(R"({"objects": [], "background": 0, "ambient": 0.1, "maxDepth": 2,
        "lights": [{"type": "directional", "direction": [-0.5, -1, -0.4]}],
        "materials": {"m": {"diffuse": 0.5, "mirror": 0.5}},
        "camera": {"eye": [1000, 220, 964], "target": [1000, 0, 700], "fovY": 6}})",
                      400, 300);
    Scene scene = std::move(c.scene);
    const dvec3 corner = middle - dvec3(kSize / 2, 0, kSize / 2);
    const auto material = static_cast<uint32_t>(scene.materials.size() - 1);
    if (made == Made::OneMesh) {
        scene.objects.push_back({"", MeshShape{flatGrid(600, kCell, corner)}, material, std::nullopt});
    } else {
        constexpr uint32_t kTiles = 12;
        const auto tile = flatGrid(600 / kTiles, kCell, dvec3(0));
        for (uint32_t i = 0; i < kTiles * kTiles; ++i) {
            Affine place;
            place.offset = corner + kSize / kTiles * dvec3(i % kTiles, 0, static_cast<double>(i / kTiles));
            scene.objects.push_back({"", MeshShape{tile}, material, place});
        }
    }
    return makeCase(std::move(scene), 400, 300);
}

class FlatMeshTest : public RenderTest {
  protected:
    static verify::Report verifiedBy(const Case& c, const KernelCode& code = embeddedKernels()) {
        verify::Options options;
        options.plainToo = false;
        return verified(c, optionsWith(code), options);
    }
};

TEST_F(FlatMeshTest, FacesDoNotMeetTheirNeighbours) {
    for (const Made made : {Made::OneMesh, Made::Tiles}) {
        for (const double height : {0.0, 1e-3}) {
            const Case c = floorCase(made, height);
            ASSERT_EQ(c.packed.instances.empty(), made == Made::OneMesh);
            ASSERT_EQ(c.packed.origin, dvec3(0));
            const Picture picture = draw(device(), c);
            const float alone = picture.color.at(200, 200, 0);
            size_t floor = 0, others = 0;
            for (int y = 0; y < c.height; ++y) {
                for (int x = 0; x < c.width; ++x) {
                    const float color = picture.color.at(x, y, 0);
                    floor += color > 0;
                    others += color > 0 && std::abs(color - alone) > 1e-5f;
                }
            }
            EXPECT_GT(floor, 70'000u);
            EXPECT_EQ(others, 0u) << "of " << floor << ", height " << height;
        }
    }
}

// A strip of 20 by 0.005 of two needles that share its diagonal, which crosses the picture, lit at 0.9
// degrees. Rays that leave one needle beside the diagonal hit the other one within rounding, at a t that is
// wrong by thousands of times the distance.
TEST_F(FlatMeshTest, NeedlesDoNotShadeTheirNeighbours) {
    Scene scene = emptyScene();
    scene.background = Color(0);
    const dvec3 u = glm::normalize(dvec3(0.38, -0.46, -0.8)),
                v = glm::normalize(glm::cross(u, dvec3(1, 2, 0.3))), w = glm::cross(u, v), middle(7, -9, 5);
    const dvec3 along = 10.0 * u, across = 0.0025 * w;
    addTriangle(scene, middle - along - across, middle + along - across, middle + along + across);
    addTriangle(scene, middle - along - across, middle + along + across, middle - along + across);
    aim(scene.camera, middle + 0.3 * u + 0.3 * v, middle + 0.3 * u, w);
    scene.camera.fovY = 0.9;
    scene.lights.push_back(DirectionalLight{-u - 0.0175 * v - 0.5 * w, Color(1)});
    const Case c = makeCase(std::move(scene), 160, 120);
    ASSERT_TRUE(c.packed.features.slivers);
    const Picture picture = draw(device(), c);
    size_t dark = 0;
    for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; ++x) dark += picture.color.at(x, y, 0) <= 0;
    EXPECT_EQ(dark, 0u);
    EXPECT_EQ(verifiedBy(c).unexplained, 0u);
}

// verify must not excuse it by rounding: the mutant counts hits whose interval reaches behind the origin, so
// that rays hit the faces around their start.
TEST_F(FlatMeshTest, NeighboursThatAreMetAreUnexplained) {
    const Case c = floorCase(Made::OneMesh, 0);
    const verify::Report sound = verifiedBy(c);
    EXPECT_TRUE(sound.passed()) << sound.unexplained << " unexplained";
    const verify::Report broken = verifiedBy(c, mutantKernels("near_faces"));
    EXPECT_GT(broken.unexplained, 5u);
    EXPECT_FALSE(broken.passed());
}

}  // namespace glint::render::test::flat_mesh_test
