// The tree must not change what a ray hits: the same scene with boxes that hold everything, so that each ray
// is tested against each primitive, gives the same hits, bit by bit.
#include <cmath>
#include <iostream>

#include "oracle.h"
#include "reference/tracer.h"
#include "support.h"

namespace glint::render::test::traversal_test {
using glm::dvec3;
using glm::vec3;

double logUniform(Random& random, double lo, double hi) {
    return std::exp(random.uniform(std::log(lo), std::log(hi)));
}

void addRandomTriangles(Scene& scene, Random& random, int count) {
    for (int i = 0; i < count; ++i) {
        const dvec3 at = random.box(4);
        const double size = logUniform(random, 1e-3, 5);
        addTriangle(scene, at, at + random.box(size), at + random.box(size));
    }
}
void addRandomSpheres(Scene& scene, Random& random, int count) {
    for (int i = 0; i < count; ++i) addSphere(scene, random.box(4), logUniform(random, 1e-3, 2));
}

// Grids along the axes, so that boxes have no thickness, and one that is turned.
void addGrids(Scene& scene) {
    addGrid(scene, 20, {-2, -2, 0.5}, 4);
    addGrid(scene, 16, {-2, -2, -0.75}, 4);
    const auto turned = glint::test::gridMesh(12);
    for (dvec3& p : turned->positions)
        p = dvec3(-1, -2, -2) + p.x / 4 * dvec3(0.6, 0.8, 0) + p.y / 4 * dvec3(0.3, -0.2, 1);
    addMesh(scene, turned->positions, turned->corners);
}

Scene sceneOf(const std::string& kind) {
    Scene scene = emptyScene();
    Random random(7);
    if (kind == "triangles") addRandomTriangles(scene, random, 1200);
    if (kind == "grids") addGrids(scene);
    if (kind == "spheres") addRandomSpheres(scene, random, 700);
    if (kind == "mixed") {
        addRandomTriangles(scene, random, 300);
        addRandomSpheres(scene, random, 200);
        addGrid(scene, 10, {-2, -2, 0.25}, 4);
        addPlane(scene, {0, -3, 0}, {0, 1, 0});
        addPlane(scene, {0, 0, -6}, {0.2, 0.1, 1});
        addSphere(scene, {0, -1e4, 0}, 1e4 - 3.5);  // anchored
    }
    return scene;
}

struct Subject {
    std::string scene;
    BuildQuality quality;
};

class TraversalTest : public RenderTest, public testing::WithParamInterface<Subject> {
  protected:
    // A vertex, a point on an edge, a sphere's side, a corner of a box: where rounding decides.
    dvec3 criticalPoint() {
        const PackedScene& s = packed_;
        const uint32_t choice = random_.below(4);
        if (choice == 0) return boxCorner();
        const bool useTriangle = !s.triangles.empty() && (s.spheres.empty() || random_.below(2));
        if (useTriangle) {
            const shared::Triangle& t = s.triangles[random_.below(static_cast<uint32_t>(s.triangles.size()))];
            return choice == 1 ? dvec3(t.v0) : glm::mix(dvec3(t.v1), dvec3(t.v2), random_.uniform(0, 1));
        }
        const shared::Sphere& sphere = s.spheres[random_.below(static_cast<uint32_t>(s.spheres.size()))];
        return dvec3(sphere.point) +
               double(sphere.radius) * (choice == 1 ? random_.direction() : dvec3(0, 1, 0));
    }
    dvec3 boxCorner() {
        const shared::Node& node = packed_.nodes[random_.below(static_cast<uint32_t>(packed_.nodes.size()))];
        dvec3 corner;
        for (int i = 0; i < 3; ++i) corner[i] = random_.below(2) ? node.lo0[i] : node.hi0[i];
        return corner;
    }
    RayInput randomRay() {
        RayInput ray = rayTowards(random_.box(6), random_.box(4), true);
        ray.direction *= static_cast<float>(logUniform(random_, 0.01, 100));
        if (random_.below(4) == 0) ray.tMin = static_cast<float>(random_.uniform(0, 5));
        if (random_.below(4) == 0) ray.tMax = ray.tMin + static_cast<float>(random_.uniform(0, 5));
        return ray;
    }
    // Along an axis, with zeros of either sign across it, through a critical point.
    RayInput axisRay() {
        const vec3 at(criticalPoint());
        const int axis = static_cast<int>(random_.below(3));
        RayInput ray;
        for (int i = 0; i < 3; ++i) ray.direction[i] = random_.below(2) ? 0.0f : -0.0f;
        ray.direction[axis] = random_.below(2) ? 1.0f : -2.0f;
        ray.origin = at;
        ray.origin[axis] -= ray.direction[axis] * static_cast<float>(random_.below(8));
        return ray;
    }
    // In a plane of a box, in two directions of space.
    RayInput slabRay() {
        RayInput ray = rayTowards(random_.box(5), criticalPoint());
        const int axis = static_cast<int>(random_.below(3));
        ray.origin[axis] = vec3(boxCorner())[axis];
        ray.direction[axis] = random_.below(2) ? 0.0f : -0.0f;
        return ray;
    }
    std::vector<RayInput> makeRays(int count) {
        std::vector<RayInput> rays;
        for (int i = 0; i < count; ++i) {
            rays.push_back(randomRay());
            rays.push_back(rayTowards(random_.box(6), criticalPoint(), i % 2));
            rays.push_back(rayTowards(boxCorner(), criticalPoint()));
            rays.push_back(axisRay());
            rays.push_back(slabRay());
        }
        return rays;
    }

    oracle::Truth truthOf(uint32_t triangle, const RayInput& ray) const {
        const shared::Triangle& t = packed_.triangles[triangle];
        return oracle::triangle(dvec3(t.v0), dvec3(t.v1), dvec3(t.v2),
                                {dvec3(ray.origin), dvec3(ray.direction)});
    }
    // Sine of the angle between the ray and the triangle's plane.
    double slope(uint32_t triangle, const RayInput& ray) const {
        const shared::Triangle& t = packed_.triangles[triangle];
        const dvec3 normal = glm::cross(dvec3(t.v1) - dvec3(t.v0), dvec3(t.v2) - dvec3(t.v0));
        return std::abs(glm::dot(glm::normalize(normal), glm::normalize(dvec3(ray.direction))));
    }
    // How far t of a triangle may be off: the rule of docs/design/numerics.md.
    double slip(uint32_t triangle, double t, const RayInput& ray) const {
        const dvec3 anchor(packed_.triangles[triangle].v0), normal(packed_.triangleSurfaces[triangle].normal);
        const dvec3 reach = glm::abs(anchor - dvec3(ray.origin)) + glm::abs(t * dvec3(ray.direction));
        const double height = 0x1p-24 * glm::dot(glm::abs(normal), 2.0 * glm::abs(anchor) + 6.0 * reach);
        return height / std::abs(glm::dot(normal, dvec3(ray.direction)));
    }
    // True if t +- slip of the triangle overlaps that of the hit: the rule lets either of them be hit.
    bool isInOnePlace(uint32_t triangle, double t, const RayHit& hit, const RayInput& ray) const {
        if (!hit.hit || hit.kindAndIndex >> shared::kPrimitiveKindShift != shared::kKindTriangle)
            return false;
        const uint32_t other = hit.kindAndIndex & shared::kPrimitiveIndexMask;
        return std::abs(t - double(hit.t)) <= slip(triangle, t, ray) + slip(other, double(hit.t), ray);
    }
    // A ray in a triangle's plane, within rounding: there fp32 cannot tell where along its line the triangle
    // ends, and may report a false hit anywhere on it. Boxes reject some of these. So trees may differ in
    // such false hits, and in the triangle hit among several whose intervals of t overlap, and in nothing
    // else.
    void expectPhantom(const RayInput& ray, const RayHit& byTree, const RayHit& byAll) const {
        ASSERT_TRUE(byAll.hit) << text(ray);
        ASSERT_EQ(byAll.kindAndIndex >> shared::kPrimitiveKindShift, shared::kKindTriangle) << text(ray);
        const uint32_t found = byAll.kindAndIndex & shared::kPrimitiveIndexMask;
        EXPECT_LT(slope(found, ray), 1e-4) << text(ray);
        if (!isInOnePlace(found, double(byAll.t), byTree, ray)) {
            const oracle::Truth phantom = truthOf(found, ray);
            EXPECT_FALSE(phantom.hit) << text(ray);
            EXPECT_LT(phantom.margin, 16 * 0x1p-24) << text(ray);
            EXPECT_FALSE(byTree.hit && byTree.t < byAll.t) << text(ray);
        }
        // The tree finds every certain hit, or a hit before it or in its place.
        for (uint32_t i = 0; i < packed_.triangles.size(); ++i) {
            const oracle::Truth truth = truthOf(i, ray);
            if (!truth.hit || truth.margin < 64 * 0x1p-24 || truth.t <= ray.tMin || truth.t > ray.tMax)
                continue;
            ASSERT_TRUE(byTree.hit) << text(ray);
            EXPECT_TRUE(byTree.t <= truth.t * (1 + 1e-5) || isInOnePlace(i, truth.t, byTree, ray))
                << text(ray) << " " << byTree.t << " " << truth.t;
        }
    }

    PackedScene packed_ = packScene(sceneOf(GetParam().scene), {GetParam().quality});
    Random random_{70};
};

TEST_P(TraversalTest, TreeAndBruteForceHitTheSame) {
    const std::vector<RayInput> rays = makeRays(4000);
    const PackedScene open = withOpenBoxes(packed_);
    const std::vector<RayHit> all = hitsOf(open, rays, {.traversal = Traversal::Lane});
    for (const uint32_t tripBudget : {0u, 1u}) {  // with the stack, without
        RayTracer tree(device(), packed_, {.tripBudget = tripBudget, .traversal = Traversal::Lane});
        SCOPED_TRACE(tripBudget);
        const std::vector<RayHit> hits = tree.trace(rays, false);
        size_t phantoms = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            if (sameBits(hits[i], all[i])) continue;
            expectPhantom(rays[i], hits[i], all[i]);
            ++phantoms;
        }
        std::cout << "[ measured ] "
                  << "trips " << tripBudget << ": " << phantoms << " of " << rays.size()
                  << " rays hit another triangle\n";
        const size_t hitCount = rays.size() - misses(hits);
        EXPECT_GT(hitCount, rays.size() / 4);
        EXPECT_GT(misses(hits), rays.size() / 100);

        const std::vector<RayHit> any = tree.trace(rays, true);
        size_t differing = 0;
        for (size_t i = 0; i < rays.size(); ++i) differing += any[i].hit != hits[i].hit;
        EXPECT_EQ(differing, 0u);
    }
}

// ---- surfaces in one place by their bounds alone ----

// A fence in the plane z = 0 on a floor at y = 1 that begins behind it, nearer than the floor's slip. Rays
// that pass the fence less than the bound above the floor's plane may hit either, by the order of traversal.
struct Fence {
    double slope = 0;  // of the rays
    double bound = 0;  // of heights above the floor: h of docs/design/numerics.md
    Case scene;
};

Fence fenceCase(Random& random) {
    Fence fence;
    fence.slope = logUniform(random, 1e-4, 0.1);
    fence.bound = 0x1p-24 * (2 + 12 * fence.slope);
    const double begin = -fence.bound / fence.slope * random.uniform(0.1, 0.9);
    Scene scene = emptyScene();
    const auto addRectangle = [&](const dvec3& corner, const dvec3& u, const dvec3& v) {
        addTriangle(scene, corner, corner + u, corner + u + v);
        addTriangle(scene, corner, corner + u + v, corner + v);
    };
    addRectangle({-1, 1, begin}, {2, 0, 0}, {0, 0, -2});
    addRectangle({-1, 0.5, 0}, {2, 0, 0}, {0, 1, 0});
    for (uint32_t i = random.below(12) + 6; i > 0; --i) {  // so that trees differ
        const dvec3 at(random.uniform(-3, 3), random.uniform(2, 3), random.uniform(-3, 3));
        addTriangle(scene, at, at + dvec3(0.2, 0, 0), at + dvec3(0, 0.2, 0.1));
    }
    scene.camera.eye = {0, 1 + fence.slope, 1};
    scene.camera.target = {0, 1, 0};
    scene.camera.fovY = 1e-4;
    fence.scene = makeCase(scene, 16, 48);
    return fence;
}

TEST_F(RenderTest, TheOrderOfTraversalMattersWithinTheBoundAlone) {
    Random random(3);
    size_t byOrder = 0, open = 0;
    for (int i = 0; i < 6; ++i) {
        const Fence fence = fenceCase(random);
        const Case& c = fence.scene;
        const reference::Tracer tracer(c.packed);
        std::vector<Picture> pictures;
        for (const auto& [traversal, budget] :
             {std::pair{Traversal::Lane, 0u}, {Traversal::Lane, 1u}, {Traversal::Packet, 0u}}) {
            Renderer renderer(device(), c.packed, {.tripBudget = budget, .traversal = traversal});
            EXPECT_TRUE(verified(renderer, c).passed()) << i;
            pictures.push_back(renderer.render(wholeWithData(c)));
        }
        for (int y = 0; y < c.height; ++y) {
            const reference::Ray ray = tracer.cameraRay(filmOf(c), 8.5, y + 0.5);
            const double height = ray.origin.y - ray.origin.z / ray.direction.z * ray.direction.y +
                                  c.packed.origin.y - c.packed.origin.z / ray.direction.z * ray.direction.y -
                                  1;
            uint32_t least = ~0u, greatest = 0;
            for (const Picture& picture : pictures) {
                least = std::min(least, picture.at(8, y).object);
                greatest = std::max(greatest, picture.at(8, y).object);
            }
            ASSERT_LE(greatest, 3u);
            if (height < 0 || height > 2 * fence.bound) {
                EXPECT_GE(least, 2u) << i << " " << y << " " << height;
            }
            byOrder += least < 2 && greatest >= 2;
            open += reference::isOpen(tracer, ray, tracer.trace(ray));
        }
    }
    std::cout << "[ measured ] " << byOrder << " pixels hit another surface by another kernel, " << open
              << " are open\n";
    EXPECT_GE(open, byOrder) << "the reference predicts what the order decides";
}

// Two objects of one surface, from numbers that round differently: an ulp of the coordinates is 16 times the
// roundings of t. Balls near 0 keep the origin of coordinates there.
TEST_F(RenderTest, RoundSurfacesInOnePlaceAreOneWhateverTheirNumbers) {
    const std::pair<std::string, std::string> pairs[] = {
        {R"("sphere", "center": [100.1, 60.3, -80.7], "radius": 0.7)",
         R"("sphere", "center": [100.100005, 60.299998, -80.700004], "radius": 0.7)"},
        {R"("sphere", "center": [100.1, 60.3, -80.7], "radius": 0.7)",
         R"("ellipsoid", "center": [0, 0, 0], "radii": [2, 1, 0.5], "transform":
            [0.21, -0.56, 0, 100.1, 0.28, 0.42, 0, 60.3, 0, 0, 1.4, -80.7, 0, 0, 0, 1])"},
        {R"("ellipsoid", "center": [100.1, 60.3, -80.7], "radii": [0.56, 0.7, 0.63])",
         R"("sphere", "center": [143, 43.07142857142857, -89.66666666666667], "radius": 0.5, "transform":
            [1.12, 0, 0, -60.06, 0, 1.4, 0, 0, 0, 0, 1.26, 32.28, 0, 0, 0, 1])"},
        {R"("cylinder", "base": [96.5, 59.1, -79.7], "top": [101.4, 61.2, -81.45], "radius": 0.6)",
         R"("cylinder", "base": [99.3, 60.3, -80.7], "top": [100.7, 60.9, -81.2], "radius": 0.6)"},
        {R"("cone", "base": [99.3, 60.3, -80.7], "apex": [101.3, 60.9, -81.2], "radius": 0.8)",
         R"("cone", "base": [99.3, 60.3, -80.7], "apex": [100.9, 60.78, -81.1], "radius": 0.8,
            "topRadius": 0.16)"}};
    std::string balls;
    for (int i = 0; i < 8; ++i)
        balls += R"(, {"type": "sphere", "center": [0, 0, 0], "radius": 0.001, "material": "red"})";
    for (const auto& [first, second] : pairs) {
        const std::string objects = R"({"material": "white", "type": )" + first +
                                    R"(}, {"material": "red", "type": )" + second + "}" + balls;
        const Case c = textCase(R"({"camera": {"eye": [100.7, 61, -80], "target": [100.1, 60.3, -80.7]},
            "lights": [{"type": "point", "position": [103, 66, -78]}],
            "materials": {"white": {"diffuse": 0.7}, "red": {"diffuse": [0.7, 0, 0]}},
            "objects": [)" + objects +
                                    "]}",
                                32, 24);
        ASSERT_EQ(c.packed.origin, dvec3(0));
        EXPECT_TRUE(verified(c).passed()) << second;
        const Picture picture = draw(device(), c);
        size_t hits = 0;
        for (int i = 0; i < 32 * 24; ++i) {
            EXPECT_NE(picture.at(i % 32, i / 32).object, 1u) << second;
            hits += picture.at(i % 32, i / 32).object == 0;
        }
        EXPECT_GT(hits, 150u) << second;
    }
}

std::vector<Subject> subjects() {
    std::vector<Subject> all;
    for (const char* scene : {"triangles", "grids", "spheres", "mixed"})
        for (const BuildQuality quality : {BuildQuality::Fast, BuildQuality::Default, BuildQuality::High})
            all.push_back({scene, quality});
    return all;
}

std::string nameOf(const testing::TestParamInfo<Subject>& info) {
    const char* const names[] = {"Fast", "Default", "High"};
    return info.param.scene + names[static_cast<int>(info.param.quality)];
}

INSTANTIATE_TEST_SUITE_P(All, TraversalTest, testing::ValuesIn(subjects()), nameOf);

}  // namespace glint::render::test::traversal_test
