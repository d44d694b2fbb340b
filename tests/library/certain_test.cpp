// Certified nearest hits, against rational arithmetic: rays aimed at corners, edges and along planes, and
// what cannot be decided.
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "closed_meshes.h"
#include "core/parallel.h"
#include "dyadic.h"
#include "oracle.h"
#include "support.h"

namespace glint::library::test {
namespace {

using oracle::Dyadic;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const size_t kCertifiedRays = kOnDevice ? 2'000 : 200;  // rays of each aim at each mesh

// Rays, what is asked of them, and what was answered.
struct Asked : Found, RayList {
    std::vector<double> tMin, tMax;  // or none

    void ask(const glint_scene* scene) {
        glint_rays given = rays();
        if (!tMin.empty()) given.t_min = viewOf(tMin);
        if (!tMax.empty()) given.t_max = viewOf(tMax);
        const glint_hits hits = outputs(size(), true);
        ASSERT_OK(glint_query_closest(scene, &given, &hits, nullptr));
    }
};

// The triangles of a scene as the oracle sees them.
class Judge {
  public:
    void add(uint32_t geometry, const std::vector<D3>& vertices, const std::vector<U3>& corners) {
        for (uint32_t i = 0; i < corners.size(); ++i) {
            Known known{geometry, i, {}, glm::dvec3(0), 0};
            for (int k = 0; k < 3; ++k) known.corners[k] = vertices[corners[i][k]];
            known.center = (known.corners[0] + known.corners[1] + known.corners[2]) / 3.0;
            for (const glm::dvec3& c : known.corners)
                known.radius = std::max(known.radius, glm::length(c - known.center));
            known.radius = 1.001 * known.radius + 1e-9 * glm::length(known.center);
            known_.push_back(known);
        }
    }

    // What is wrong about the answer for ray i; empty if nothing is. Of triangles met at the same t the first
    // one is right.
    std::string wrong(const Asked& asked, size_t i) const {
        const oracle::Ray ray{asked.origins[i], asked.directions[i]};
        const glm::dvec3 unit = glm::normalize(ray.direction);
        std::optional<At> best;
        const Known* first = nullptr;
        for (const Known& known : known_) {
            const auto& [a, b, c] = known.corners;
            if (isFar(known, ray.origin, unit) || !oracle::hitsTriangle(a, b, c, ray)) continue;
            const At at = planeOf(known, ray);
            if (best && !(at.over * best->under < best->over * at.under)) continue;
            best = at;
            first = &known;
        }
        if (asked.sure[i] != 1) return "not sure";
        if ((asked.hit[i] == 1) != (first != nullptr)) return asked.hit[i] ? "a hit" : "a miss";
        if (first == nullptr)
            return asked.lower[i] == kInfinity && asked.upper[i] == kInfinity ? "" : "bounds of a miss";
        if (asked.geometry[i] != first->geometry || asked.primitive[i] != first->primitive)
            return "not triangle " + std::to_string(first->primitive);
        if (best->over < Dyadic(asked.lower[i]) * best->under ||
            Dyadic(asked.upper[i]) * best->under < best->over)
            return "t beside its bounds";
        if (!(asked.lower[i] <= asked.t[i] && asked.t[i] <= asked.upper[i]))
            return "t not between its bounds";
        return "";
    }
    // How many are wrong; the first ones are told.
    size_t wrongs(const Asked& asked) const {
        std::vector<std::string> told(asked.size());
        parallelFor(Context{}, told.size(), [&](size_t i) { told[i] = wrong(asked, i); });
        size_t count = 0;
        for (size_t i = 0; i < told.size(); ++i) {
            if (told[i].empty() || ++count > 5) continue;
            ADD_FAILURE() << "ray " << i << ": " << told[i] << "; geometry " << asked.geometry[i]
                          << ", primitive " << asked.primitive[i] << ", t " << asked.t[i] << " in "
                          << asked.lower[i] << " to " << asked.upper[i];
        }
        return count;
    }

  private:
    struct Known {
        uint32_t geometry, primitive;
        std::array<glm::dvec3, 3> corners;
        glm::dvec3 center;
        double radius;
    };
    // t = over / under, under > 0, of the ray's point in the triangle's plane.
    struct At {
        Dyadic over, under;
    };
    static At planeOf(const Known& known, const oracle::Ray& ray) {
        std::array<Dyadic, 3> ab, ac, n;
        for (int k = 0; k < 3; ++k) {
            ab[k] = Dyadic(known.corners[1][k]) - Dyadic(known.corners[0][k]);
            ac[k] = Dyadic(known.corners[2][k]) - Dyadic(known.corners[0][k]);
        }
        At at{0.0, 0.0};
        for (int k = 0; k < 3; ++k) {
            n[k] = ab[(k + 1) % 3] * ac[(k + 2) % 3] - ab[(k + 2) % 3] * ac[(k + 1) % 3];
            at.over = at.over + n[k] * (Dyadic(known.corners[0][k]) - Dyadic(ray.origin[k]));
            at.under = at.under + n[k] * Dyadic(ray.direction[k]);
        }
        return at.under.sign() < 0 ? At{-at.over, -at.under} : at;
    }
    static bool isFar(const Known& known, const glm::dvec3& origin, const glm::dvec3& unit) {
        const glm::dvec3 away = known.center - origin;
        const glm::dvec3 beside = away - glm::dot(away, unit) * unit;
        return glm::dot(beside, beside) > known.radius * known.radius;
    }

    std::vector<Known> known_;
};

Asked aimedAt(const Closed& mesh, double offset, Aim aim, size_t count, uint64_t seed) {
    Random random(seed);
    Asked asked;
    for (size_t i = 0; i < count; ++i) {
        const auto [from, to] = random.aimed(mesh, aim, i % 2 == 1);
        asked.add(from + offset, to - from);
    }
    return asked;
}

class LibraryCertain : public LibraryTest {};

TEST_F(LibraryCertain, AimedRaysAreDecidedAsRationalsDo) {
    size_t asked = 0, wrong = 0;
    for (const Closed& mesh : {bumpy(), gridCube(16)}) {
        for (const double offset : {0.0, 1e3, 1e6}) {
            useScene(nullptr);
            Judge judge;
            const std::vector<D3> vertices = mesh.movedBy(offset);
            judge.add(addMesh(vertices, mesh.corners), vertices, mesh.corners);
            commit();
            for (const Aim aim : {Aim::Corners, Aim::Edges, Aim::Planes}) {
                Asked rays =
                    aimedAt(mesh, offset, aim, aimedRays(kCertifiedRays), 17 + static_cast<uint64_t>(aim));
                rays.ask(scene());
                wrong += judge.wrongs(rays);
                asked += rays.size();
            }
        }
    }
    EXPECT_EQ(wrong, 0u) << "of " << asked;
    RecordProperty("rays", static_cast<int>(asked));
}

// Two balls of triangles in one another, and the same once more, a triangle's own copy: of equals the one
// that was added first. Rays end at what they hit, exactly.
TEST_F(LibraryCertain, EndsAndEqualsAreExact) {
    const std::vector<D3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {1, 0, -1}, {0, 1, -1}};
    const std::vector<U3> faces = {{3, 4, 5}, {0, 1, 2}, {0, 2, 1}};
    addMesh(corners, faces);
    commit();
    Asked rays;
    const D3 from = {0.25, 0.25, 3}, down = {0, 0, -1};
    const double next = std::nextafter(3.0, 4.0), before = std::nextafter(3.0, 2.0);
    for (const auto& [least, most] : std::vector<std::pair<double, double>>{{0, kInfinity},
                                                                            {0, 3},
                                                                            {0, before},
                                                                            {before, 3},
                                                                            {3, 4},
                                                                            {3, kInfinity},
                                                                            {next, kInfinity},
                                                                            {4, 9}}) {
        rays.add(from, down);
        rays.tMin.push_back(least);
        rays.tMax.push_back(most);
    }
    rays.ask(scene());
    EXPECT_EQ(rays.sure, std::vector<uint8_t>(8, 1));
    EXPECT_EQ(rays.hit, (std::vector<uint8_t>{1, 1, 0, 1, 1, 1, 1, 0}));
    EXPECT_EQ(rays.primitive, (std::vector<uint32_t>{1, 1, GLINT_NONE, 1, 0, 0, 0, GLINT_NONE}));
    EXPECT_EQ(rays.lower, (std::vector<double>{3, 3, kInfinity, 3, 4, 4, 4, kInfinity}));
    EXPECT_EQ(rays.upper, rays.lower);
}

// Through shears whose numbers leave nothing to round, so that the oracle's corners are the scene's.
TEST_F(LibraryCertain, InstancesToo) {
    const Closed mesh = gridCube(64);  // enough to be stored once
    const uint32_t geometry = addMesh(mesh.vertices, mesh.corners);
    Judge judge;
    judge.add(geometry, mesh.vertices, mesh.corners);
    const std::vector<std::array<double, 12>> places = {{0, -1, 0.5, 8, 1, 0, 0, -3, 0.25, 0, 2, 1},
                                                        {1, 0, 0, -4096, 0, 1, 0, 0, 0, 0, -0.125, 5}};
    std::vector<Closed> meshes = {mesh};
    for (const auto& m : places) {
        uint32_t instance = GLINT_NONE;
        ASSERT_OK(glint_scene_add_instance(scene(), geometry, m.data(), &instance));
        Closed other = mesh;
        for (D3& v : other.vertices) v = moved(m.data(), v);
        judge.add(instance, other.vertices, other.corners);
        meshes.push_back(other);
    }
    commit();
    Random random(5);
    Asked rays;
    for (size_t i = 0; i < aimedRays(kCertifiedRays); ++i) {
        const Closed& at = meshes[i % meshes.size()];
        const D3 to = targetOf(at, i % 2 == 0 ? Aim::Edges : Aim::Corners, random);
        const D3 from = to + 20.0 * random.direction();
        rays.add(from, to - from);
    }
    rays.ask(scene());
    EXPECT_EQ(judge.wrongs(rays), 0u);
}

// On an ordinary picture all is decided, and agrees with the ordinary answer but where rounding shows.
TEST_F(LibraryCertain, OrdinaryRaysAgreeWithOrdinaryAnswers) {
    load("knot.json");
    Random random(3);
    Asked rays;
    for (size_t i = 0; i < 20 * aimedRays(kCertifiedRays); ++i) {
        const D3 from = 6.0 * random.direction(), to = random.direction();
        rays.add(from, to - from);
    }
    rays.ask(scene());
    EXPECT_EQ(std::accumulate(rays.sure.begin(), rays.sure.end(), size_t{0}), rays.sure.size());
    const std::vector<double> t = closest(rays.rays()).t;
    size_t far = 0, hit = 0;
    for (size_t i = 0; i < t.size(); ++i) {
        hit += rays.hit[i];
        far += rays.hit[i] != 0 && !(std::abs(t[i] - rays.t[i]) <= 1e-4 * t[i]) ? 1u : 0u;
    }
    EXPECT_GT(hit, t.size() / 10);
    EXPECT_LE(far, t.size() / 1000);
}

// A plane, a sphere and a disc: what is not decided says between what the hit is.
TEST_F(LibraryCertain, OtherSurfaces) {
    const char* text = R"({"objects": [
        {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0]},
        {"type": "sphere", "center": [0, 0, 0], "radius": 0.5},
        {"type": "disc", "center": [4, 0, 0], "normal": [0, 1, 0], "radius": 1}]})";
    addJson(scene(), text);
    commit();
    Asked rays;
    const D3 down = {0, -2, 0};
    for (const double x : {0.0, 0.5, 2.0, 4.0, 5.0}) rays.add({x, 3, 0}, down);
    rays.add({0, 3, 0}, {1, 0, 0});
    rays.ask(scene());
    // The second one touches the sphere, exactly; the two last but one may meet the disc.
    EXPECT_EQ(rays.sure, (std::vector<uint8_t>{1, 0, 1, 0, 0, 1}));
    EXPECT_EQ(rays.geometry[0], 1u);
    EXPECT_EQ(rays.geometry[2], 0u);
    EXPECT_EQ(rays.geometry[3], 2u);
    EXPECT_EQ(rays.hit[5], 0);
    EXPECT_LE(rays.lower[0], 1.25);
    EXPECT_GE(rays.upper[0], 1.25);
    EXPECT_LE(rays.upper[0] - rays.lower[0], 1e-12);
    EXPECT_LE(rays.lower[1], 1.5);
    EXPECT_GE(rays.upper[1], 2);
    EXPECT_LE(rays.upper[1], 2 + 1e-12);  // the plane is met at the latest
    EXPECT_LE(rays.lower[3], 1.5);
}

// A ball whose size rounding to fp32 changes by more than the coordinates of the rays that graze it: boxes
// are of what it was rounded to.
TEST_F(LibraryCertain, LargeSpheresAreNotMissed) {
    const double radius = 1e6, height = 999999.97;
    addSpheres(scene(), {{0, height, 0}}, {radius});
    commit();
    Asked rays;
    for (int i = -500; i <= 500; ++i) rays.add({0, i * 1e-3, 0}, {0, 0, 1});
    rays.ask(scene());
    size_t sure = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const double lowest = height - radius, y = rays.origins[i][1];
        sure += rays.sure[i];
        if (rays.sure[i]) {
            EXPECT_EQ(rays.hit[i] == 1, y > lowest) << "y " << y;
        }
    }
    EXPECT_GE(sure, rays.size() - 2);
}

// Rays at the limbs of balls, from outside and from inside, as far beside them as rounding decides about.
Asked raysAtLimbs(const std::vector<D3>& centers, const std::vector<double>& radii, size_t count) {
    Random random(7);
    Asked asked;
    for (size_t i = 0; i < count; ++i) {
        const size_t target = random.index(centers.size());
        const double radius = radii[target];
        const glm::dvec3 to = centers[target];
        const double away = random.uniform() < 0.2 ? 0.5 : 1 + 4 * random.uniform();
        const glm::dvec3 from = to + away * radius * random.direction();
        const glm::dvec3 side = glm::normalize(glm::cross(to - from, random.direction()));
        const double beside = radius * (1 + (2 * random.uniform() - 1) * std::pow(10, -9 * random.uniform()));
        const glm::dvec3 way = to - from;
        const double sine = std::min(beside / glm::length(way), 1.0);
        const glm::dvec3 d = std::sqrt(1 - sine * sine) * glm::normalize(way) + sine * side;
        asked.add(from, d);
    }
    return asked;
}

TEST_F(LibraryCertain, LimbsOfSpheresAreExact) {
    for (const double offset : {0.0, 1e3, 1e6}) {
        useScene(nullptr);
        Random random(3);
        std::vector<D3> centers;
        std::vector<double> radii;
        for (int i = 0; i < 64; ++i) {
            const D3 out = random.direction();
            centers.push_back({offset + 10 * out[0], offset + 10 * out[1], offset + 10 * random.uniform()});
            radii.push_back(0.1 + random.uniform());
        }
        addSpheres(scene(), centers, radii);
        commit();
        Asked rays = raysAtLimbs(centers, radii, 2 * aimedRays(kCertifiedRays));
        rays.ask(scene());
        size_t sure = 0, wrong = 0, hit = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            double nearest = kInfinity;
            size_t first = 0;
            for (size_t k = 0; k < centers.size(); ++k) {
                const oracle::Truth truth =
                    oracle::sphere(centers[k], radii[k], {rays.origins[i], rays.directions[i]});
                if (!truth.hit || truth.t >= nearest) continue;
                nearest = truth.t;
                first = k;
            }
            if (rays.sure[i] == 0) continue;
            ++sure;
            hit += rays.hit[i];
            const bool right = rays.hit[i] == 0
                                   ? nearest == kInfinity && rays.lower[i] == kInfinity
                                   : rays.geometry[i] == first && rays.lower[i] <= nearest &&
                                         nearest <= rays.upper[i] && rays.lower[i] <= rays.t[i] &&
                                         rays.t[i] <= rays.upper[i];
            if (!right && ++wrong < 5)
                ADD_FAILURE() << "offset " << offset << ", ray " << i << ": geometry " << rays.geometry[i]
                              << ", t " << rays.t[i] << " in " << rays.lower[i] << " to " << rays.upper[i]
                              << "; truth " << first << " at " << nearest;
        }
        EXPECT_EQ(wrong, 0u);
        // Not decided is what passes a limb by less than double rounds.
        EXPECT_GT(sure, rays.size() * 9 / 10);
        EXPECT_GT(hit, rays.size() / 4);
    }
}

// fp32 outputs are rounded outwards; what nobody wants is not needed; lists have none of it.
TEST_F(LibraryCertain, Outputs) {
    addMesh(std::vector<D3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    commit();
    const std::vector<D3> origins = {{0.25, 0.25, 1.0 / 3}}, directions = {{0, 0, -1}};
    glint_rays rays = raysFrom(origins, directions);
    std::vector<float> lower(1), upper(1);
    std::vector<uint8_t> sure(1);
    GLINT_INIT(glint_hits, hits);
    hits.t_lower = outOf(lower);
    hits.t_upper = outOf(upper);
    ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
    EXPECT_LT(static_cast<double>(lower[0]), 1.0 / 3);
    EXPECT_GT(static_cast<double>(upper[0]), 1.0 / 3);
    EXPECT_EQ(std::nextafter(lower[0], 1.0f), upper[0]);
    hits.t_lower = hits.t_upper = {};
    hits.sure = outOf(sure);
    ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
    EXPECT_EQ(sure[0], 1);
    refused(glint_query_all(scene(), &rays, nullptr, &hits, nullptr, nullptr), "closest hits");
    // A caller of an older header, whose struct ends before them.
    hits.size = offsetof(glint_hits, sure);
    sure[0] = 7;
    ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
    EXPECT_EQ(sure[0], 7);
}

}  // namespace
}  // namespace glint::library::test
