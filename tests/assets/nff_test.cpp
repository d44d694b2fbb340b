// The four Standard Procedural Databases (E. Haines) as NFF: as many objects as their author's programs make.
#include <algorithm>
#include <cmath>

#include "import/load.h"
#include "support/support.h"

namespace glint::test::nff_test {
struct Database {
    const char* name;
    size_t objects, spheres, triangles, cylinders, polygons, lights;
};

// By the formulas of the programs that made them (E. Haines, Standard Procedural Databases, Readme 3.14):
// sphereflake of size 4: sum of 9^k to k = 4 spheres; mountain of size 6: 2 * 4^6 triangles and 4 spheres;
// tetrahedra of size 6: 4 * 4^5 triangles; rings of size 7: 140 objects of 6 rings of 5 cylinders and
// spheres.
const Database kDatabases[] = {{"balls", 7382, 1u + 9 + 81 + 729 + 6561, 0, 0, 1, 3},
                               {"mount", 8196, 4, 2u * 4096, 0, 0, 1},
                               {"tetra", 4096, 0, 4u * 1024, 0, 0, 1},
                               {"rings", 8401, 140u * 6 * 5, 0, 140u * 6 * 5, 1, 3}};

template <typename ShapeT>
size_t countOf(const Scene& scene) {
    return static_cast<size_t>(
        std::count_if(scene.objects.begin(), scene.objects.end(),
                      [](const Object& object) { return std::holds_alternative<ShapeT>(object.shape); }));
}

TEST(NffAssets, HaveTheObjectsOfTheirAuthor) {
    for (const Database& database : kDatabases) {
        SCOPED_TRACE(database.name);
        const Scene scene = loadScene(assetPath("spd/" + std::string(database.name) + ".nff"));
        EXPECT_EQ(scene.objects.size(), database.objects);
        EXPECT_EQ(countOf<SphereShape>(scene), database.spheres);
        EXPECT_EQ(countOf<TriangleShape>(scene), database.triangles);
        EXPECT_EQ(countOf<CylinderShape>(scene), database.cylinders);
        EXPECT_EQ(countOf<PolygonShape>(scene), database.polygons);
        ASSERT_EQ(scene.lights.size(), database.lights);
        const auto lights = static_cast<double>(database.lights);
        EXPECT_DOUBLE_EQ(std::get<PointLight>(scene.lights[0]).intensity.x, std::sqrt(lights) / (2 * lights));
        EXPECT_TRUE(scene.warnings.empty());
    }
}

}  // namespace glint::test::nff_test
