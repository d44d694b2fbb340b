// T81 for neighbours: rays that start on a face of a flat mesh do not meet the faces beside it. A point's
// rounding may take it over an edge, and in a plane through the origin of coordinates no error bound lifts it
// off.
#include <cmath>
#include <filesystem>

#include "mutant_kernels.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::flat_mesh_test {
namespace {

using glm::dvec3;

std::shared_ptr<const Mesh> flatGrid(uint32_t count, double cell, const dvec3& from) {
    auto mesh = std::make_shared<Mesh>();
    for (uint32_t i = 0; i <= count; ++i)
        for (uint32_t j = 0; j <= count; ++j) mesh->positions.push_back(from + dvec3(i * cell, 0, j * cell));
    for (uint32_t i = 0; i < count; ++i) {
        for (uint32_t j = 0; j < count; ++j) {
            const uint32_t a = i * (count + 1) + j, b = a + count + 1;
            mesh->corners.emplace_back(a, a + 1, b);
            mesh->corners.emplace_back(a + 1, b + 1, b);
        }
    }
    return mesh;
}

enum class Made { OneMesh, Tiles };

// A mirror floor of 60 x 60 at the given height, so far out that a coordinate's last place is a thousandth of
// a cell, seen from above, and from so far that coordinates are not counted from its middle; else there is
// nothing.
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
    static verify::Report verified(const Case& c, const KernelCode* code) {
        Options options;
        options.access = gpu::Access::TexelBuffer;
        options.kernels = code;
        options.traversal = Traversal::Lane;
        Renderer renderer(device(), c.packed, options);
        verify::Options verifyOptions;
        verifyOptions.width = c.width;
        verifyOptions.height = c.height;
        verifyOptions.plainToo = false;
        return verify::verify(renderer, c.packed, c.camera, verifyOptions);
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

// And verify knows that rounding is no excuse for it.
TEST_F(FlatMeshTest, NeighboursThatAreMetAreUnexplained) {
    const Case c = floorCase(Made::OneMesh, 0);
    const verify::Report sound = verified(c, nullptr);
    EXPECT_TRUE(sound.passed()) << sound.unexplained << " unexplained";
    const KernelCode code = mutantKernels("over_the_edge");
    const verify::Report broken = verified(c, &code);
    EXPECT_GT(broken.unexplained, 5u);
    EXPECT_FALSE(broken.passed());
}

}  // namespace
}  // namespace glint::render::test::flat_mesh_test
