// The four Standard Procedural Databases (E. Haines) as NFF: as many objects as their author's programs make.
#include <algorithm>
#include <cmath>

#include "import/load.h"
#include "support/support.h"

namespace glint::test::nff_test {
namespace {

template <typename ShapeT>
size_t countOf(const Scene& scene) {
    return static_cast<size_t>(
        std::count_if(scene.objects.begin(), scene.objects.end(),
                      [](const Object& object) { return std::holds_alternative<ShapeT>(object.shape); }));
}

// By the formulas of the programs that made them (E. Haines, Standard Procedural Databases, Readme 3.14):
// sphereflake of size 4: sum of 9^k to k = 4 spheres; mountain of size 6: 2 * 4^6 triangles and 4 spheres;
// tetrahedra of size 6: 4 * 4^5 triangles; rings of size 7: 140 objects of 6 rings of 5 cylinders and
// spheres.
TEST(NffAssets, Balls) {
    const auto path = assetPath("spd/balls.nff");
    const Scene scene = loadScene(path);
    EXPECT_EQ(countOf<SphereShape>(scene), 1u + 9 + 81 + 729 + 6561);
    EXPECT_EQ(countOf<PolygonShape>(scene), 1u);
    EXPECT_EQ(scene.objects.size(), 7382u);
    EXPECT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.materials.size(), 2u);
    EXPECT_DOUBLE_EQ(std::get<PointLight>(scene.lights[0]).intensity.x, std::sqrt(3.0) / 6);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(NffAssets, Mount) {
    const auto path = assetPath("spd/mount.nff");
    const Scene scene = loadScene(path);
    EXPECT_EQ(countOf<SphereShape>(scene), 4u);
    EXPECT_EQ(countOf<TriangleShape>(scene), 2u * 4096);
    EXPECT_EQ(scene.objects.size(), 8196u);
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(NffAssets, Tetra) {
    const auto path = assetPath("spd/tetra.nff");
    const Scene scene = loadScene(path);
    EXPECT_EQ(countOf<TriangleShape>(scene), 4u * 1024);
    EXPECT_EQ(scene.objects.size(), 4096u);
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(NffAssets, Rings) {
    const auto path = assetPath("spd/rings.nff");
    const Scene scene = loadScene(path);
    EXPECT_EQ(countOf<SphereShape>(scene), 140u * 6 * 5);
    EXPECT_EQ(countOf<CylinderShape>(scene), 140u * 6 * 5);
    EXPECT_EQ(countOf<PolygonShape>(scene), 1u);
    EXPECT_EQ(scene.objects.size(), 8401u);  // SPD, Readme: "total prim."
    EXPECT_EQ(scene.lights.size(), 3u);
    EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace glint::test::nff_test
