#include "support.h"

#include <algorithm>
#include <cstring>
#include <sstream>

#include "import/load.h"
#include "reference/tracer.h"
#include "render/path_limits.h"
#include "support/support.h"

namespace glint::render::test {
namespace {

const std::filesystem::path& sceneFolder() {
    static const std::filesystem::path folder = glint::test::sourcePath("scenes");
    return folder;
}

// Compares the bytes of values without padding.
template <typename T>
bool differ(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) != 0;
}

// The first member of a pixel's data that differs, or nullptr.
const char* difference(const PixelData& a, const PixelData& b) {
    if (differ(a.position, b.position)) return "position";
    if (differ(a.depth, b.depth)) return "depth";
    if (differ(a.normal, b.normal)) return "normal";
    if (differ(a.geometricNormal, b.geometricNormal)) return "geometric normal";
    if (differ(a.u, b.u) || differ(a.v, b.v)) return "uv";
    if (differ(a.clearance, b.clearance)) return "clearance";
    if (a.object != b.object) return "object";
    if (a.primitive != b.primitive) return "primitive";
    if (a.material != b.material) return "material";
    if (a.bounces != b.bounces) return "bounces";
    if (a.cost != b.cost) return "cost";
    if (a.pathHash != b.pathHash) return "path hash";
    if (a.shadowBits != b.shadowBits) return "shadow bits";
    return nullptr;
}

}  // namespace

reference::Ray exactRay(const RayInput& ray) {
    reference::Ray exact{glm::dvec3(ray.origin), glm::dvec3(ray.direction)};
    exact.tMin = ray.tMin;
    exact.tMax = ray.tMax;
    return exact;
}

std::unique_ptr<gpu::Device> RenderTest::device_;

void RenderTest::SetUpTestSuite() {
    device_ = std::make_unique<gpu::Device>();
}
void RenderTest::TearDownTestSuite() {
    device_.reset();
}

std::vector<RayHit> RenderTest::hitsOf(const PackedScene& scene, const std::vector<RayInput>& rays,
                                       const Options& options) {
    return RayTracer(device(), scene, options).trace(rays, false);
}

std::vector<RayHit> RenderTest::hitsOfBoth(const PackedScene& scene, const std::vector<RayInput>& rays) {
    RayTracer kernels(device(), scene);
    const std::vector<RayHit> hits = kernels.trace(rays, false), any = kernels.trace(rays, true);
    const reference::Tracer tracer(scene);
    for (size_t i = 0; i < rays.size(); ++i) {
        SCOPED_TRACE(text(rays[i]));
        EXPECT_EQ(any[i].hit, hits[i].hit) << "any hit";
        const reference::Ray ray = exactRay(rays[i]);
        const auto found = tracer.closest(ray);
        EXPECT_EQ(found.has_value(), hits[i].hit) << "reference";
        EXPECT_EQ(closestOfAll(tracer, ray), found);
        EXPECT_EQ(tracer.occluded(ray), found.has_value());
        if (!found || !hits[i].hit) continue;
        EXPECT_NEAR(found->t, hits[i].t, 1e-5 * found->t);
        const reference::Surface surface = tracer.surfaceAt(ray, *found);
        EXPECT_EQ(surface.object, hits[i].data.object);
        EXPECT_LT(glm::distance(surface.geometricNormal, glm::dvec3(hits[i].data.geometricNormal)), 1e-6);
        EXPECT_LT(glm::distance(surface.uv, glm::dvec2(hits[i].data.u, hits[i].data.v)), 1e-5);
    }
    return hits;
}

RayHit RenderTest::hitOf(const PackedScene& scene, const RayInput& ray) {
    return hitsOfBoth(scene, {ray})[0];
}

RayHit RenderTest::hitOf(const Scene& scene, const RayInput& ray) {
    const PackedScene packed = packScene(scene);
    EXPECT_EQ(packed.origin, glm::dvec3(0));
    return hitOf(packed, ray);
}

size_t RenderTest::missesOf(const PackedScene& scene, const std::vector<RayInput>& rays) {
    RayTracer kernels(device(), scene);
    const size_t count = misses(kernels.trace(rays, false));
    EXPECT_EQ(misses(kernels.trace(rays, true)), count);
    const reference::Tracer tracer(scene);
    EXPECT_EQ(std::count_if(rays.begin(), rays.end(),
                            [&](const RayInput& r) { return !tracer.closest(exactRay(r)); }),
              count);
    return count;
}

PackedScene withOpenBoxes(PackedScene scene) {
    constexpr float kFar = 3e38f;
    for (shared::Node& node : scene.nodes) {
        if (node.child0 != shared::kNone) {
            node.lo0 = glm::vec3(-kFar);
            node.hi0 = glm::vec3(kFar);
        }
        if (node.child1 != shared::kNone) {
            node.lo1 = glm::vec3(-kFar);
            node.hi1 = glm::vec3(kFar);
        }
    }
    return scene;
}

RenderTest::Drawn RenderTest::drawn(const Case& c, const Request& request, WholePaths whole,
                                    Options options) {
    options.wholePaths = whole;
    Renderer renderer(device(), c.packed, options);
    Picture picture = renderer.render(request);
    return {std::move(picture), renderer.times(), renderer.rays()};
}

verify::Report RenderTest::verified(const Case& c, const Options& rendering, const verify::Options& options) {
    Renderer renderer(device(), c.packed, rendering);
    return verified(renderer, c, options);
}

verify::Report RenderTest::verified(Renderer& renderer, const Case& c, verify::Options options,
                                    const Scene* read) {
    options.camera = c.camera;
    options.width = c.width;
    options.height = c.height;
    return verify::verify(renderer, c.packed, options, read);
}

verify::Report RenderTest::verifiedAsRead(const Case& c) {
    Renderer renderer(device(), c.packed);
    return verified(renderer, c, {}, &c.scene);
}

std::vector<Traversal> RenderTest::traversals() {
    if (!runsPackets(device().info())) return {Traversal::Lane};
    return {Traversal::Lane, Traversal::Packet};
}

Case makeCase(Scene scene, int width, int height, BuildQuality quality) {
    Case c;
    c.scene = std::move(scene);
    c.packed = packScene(c.scene, {quality});
    c.camera = c.scene.camera;
    c.width = width;
    c.height = height;
    return c;
}

Case fileCase(const std::string& name, int width, int height) {
    return makeCase(loadScene(sceneFolder() / (name + ".json")), width, height);
}

Case textCase(const std::string& text, int width, int height) {
    return makeCase(parseScene(text, "test", sceneFolder()), width, height);
}

std::vector<std::string> sceneNames(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(sceneFolder() / folder)) {
        const std::string file = entry.path().filename().string();
        if (entry.path().extension() == ".json" && !file.ends_with(".schema.json"))
            names.push_back(entry.path().stem().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

PackedScene packedBy(const SceneMaker& maker) {
    PackedScene scene = maker.finish();
    scene.features = allFeatures();
    return scene;
}

Options optionsWith(const KernelCode& code, Traversal traversal) {
    Options options;
    options.access = gpu::Access::TexelBuffer;
    options.kernels = &code;
    options.traversal = traversal;
    return options;
}

RayTracer::RayTracer(const gpu::Device& device, const PackedScene& scene, const Options& options)
    : options_(options), scene_(device, scene, imageFeatures(scene, options), options), engine_(scene_) {
    scene_.upload();
}

// Writes what generate.comp would have written. Paths beyond the last ray have none.
void RayTracer::writeRays(const TraceModes& modes, const std::vector<RayInput>& rays) {
    const auto paths = static_cast<uint32_t>((rays.size() + shared::kWorkgroupSize - 1) /
                                             shared::kWorkgroupSize * shared::kWorkgroupSize);
    const SceneFeatures& features = scene_.features;
    engine_.reserve(paths, pathRows(features, modes, scene_.scene.environment));
    const PathState& state = engine_.paths();
    const RowEntry zero = {{0, 0, 0, 0}};
    const std::vector<RowEntry> zeros(state.capacity(), zero);
    std::vector<RowEntry> origin = zeros, direction = zeros, hit = zeros, walk = zeros;
    for (uint32_t i = 0; i < state.capacity(); ++i) {
        const RayInput ray = i < rays.size() ? rays[i] : RayInput{.tMin = shared::kInfinity};
        origin[i] = {{ray.origin.x, ray.origin.y, ray.origin.z, 0}};
        origin[i].u[3] = shared::kNone;
        direction[i] = {{ray.direction.x, ray.direction.y, ray.direction.z, ray.tMin}};
        hit[i].f[0] = ray.tMax;
        hit[i].u[3] = shared::kNone;
        walk[i].u[0] = shared::kNone;
    }
    state.writeRow(shared::kRowOrigin, origin);
    state.writeRow(shared::kRowDirection, direction);
    state.writeRow(shared::kRowHit, hit);
    state.writeRow(shared::kRowWalk, walk);
    state.writeRow(shared::kRowThroughput, zeros);
    state.writeRow(shared::kRowRadiance, zeros);
    if (features.instances) {
        RowEntry none;
        std::fill_n(none.u, 4, shared::kNone);
        state.writeRow(commonRows(modes), std::vector<RowEntry>(state.capacity(), none));
    }
    if (features.transmission) {
        const uint32_t tree = firstTreeRow(features, modes);
        state.writeRow(tree + shared::kTreeRowMedia, zeros);
        state.writeRow(tree + shared::kTreeRowBranch, zeros);
    }
}

std::vector<RayHit> RayTracer::readHits(size_t count) const {
    const std::vector<RowEntry> found = engine_.paths().readRow(shared::kRowHit, count);
    std::vector<RayHit> hits(count);
    for (size_t i = 0; i < count; ++i)
        hits[i] = {found[i].u[3] != shared::kNone, found[i].f[0], found[i].u[3], {}};
    return hits;
}

std::vector<RayHit> RayTracer::trace(const std::vector<RayInput>& rays, bool any, const Methods& methods) {
    if (rays.empty()) return {};
    TraceModes modes = {.aovs = !any, .methods = methods};
    writeRays(modes, rays);
    const auto groups =
        static_cast<uint32_t>((rays.size() + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize);
    const KernelId id = any ? KernelId::IntersectAny : KernelId::Intersect;
    const bool packets =
        options_.traversal == Traversal::Packet &&
        chooseTraversal(Traversal::Packet, scene_.device.info(), scene_.scene, methods).packets;
    const shared::Dispatch dispatch = engine_.dispatchOf({.region = {0, 0, 1, 1}, .tileCount = groups});
    resumes_ += engine_.trace(id, modes, dispatch, groups, packets, [&] { engine_.submit(); });
    std::vector<RayHit> hits = readHits(rays.size());
    if (any) return hits;
    engine_.record(KernelId::Shade, modes, dispatch, groups);
    engine_.submit();
    const AovRows rows(engine_.paths(), static_cast<uint32_t>(rays.size()));
    for (uint32_t i = 0; i < rays.size(); ++i) hits[i].data = rows.at(i, scene_.scene.origin);
    return hits;
}

Request wholeWithData(const Case& c) {
    auto request = sized<Request>(c);
    request.data = request.exact = true;
    return request;
}

Picture draw(Renderer& renderer, const Case& c) {
    return renderer.render(wholeWithData(c));
}

Picture draw(const gpu::Device& device, const Case& c, const Options& options) {
    Renderer renderer(device, c.packed, options);
    return draw(renderer, c);
}

testing::AssertionResult sameLosses(const Picture& a, const Picture& b) {
    static_assert(sizeof(TreeLosses) == 10 * sizeof(uint64_t));
    if (!differ(a.losses, b.losses)) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "other branches are lost";
}

testing::AssertionResult sameBits(const Picture& a, const Picture& b) {
    if (a.complete != b.complete || a.done != b.done || a.notFinite != b.notFinite ||
        a.firstNotFinite != b.firstNotFinite)
        return testing::AssertionFailure() << "not the same pixels are done or finite";
    if (a.color.width != b.color.width || a.color.height != b.color.height || a.data.size() != b.data.size())
        return testing::AssertionFailure() << "sizes differ";
    for (int y = 0; y < a.color.height; ++y) {
        for (int x = 0; x < a.color.width; ++x) {
            for (int c = 0; c < 4; ++c) {
                if (!differ(a.color.at(x, y, c), b.color.at(x, y, c))) continue;
                return testing::AssertionFailure() << "pixel " << x << "," << y << " channel " << c << ": "
                                                   << a.color.at(x, y, c) << " and " << b.color.at(x, y, c);
            }
            if (a.data.empty()) continue;
            const size_t i = static_cast<size_t>(y) * a.color.width + x;
            if (const char* member = difference(a.data[i], b.data[i]))
                return testing::AssertionFailure()
                       << "pixel " << x << "," << y << ": the " << member << " differs";
        }
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult sameBits(const RayHit& a, const RayHit& b) {
    if (a.hit != b.hit) return testing::AssertionFailure() << "one of them misses";
    if (differ(a.t, b.t)) return testing::AssertionFailure() << "t: " << a.t << " and " << b.t;
    if (a.kindAndIndex != b.kindAndIndex)
        return testing::AssertionFailure() << "primitive: " << a.kindAndIndex << " and " << b.kindAndIndex;
    if (const char* member = difference(a.data, b.data))
        return testing::AssertionFailure() << "the " << member << " differs";
    return testing::AssertionSuccess();
}

testing::AssertionResult sameBits(const std::vector<RayHit>& a, const std::vector<RayHit>& b,
                                  const std::vector<RayInput>& rays) {
    size_t differing = 0;
    std::string first;
    for (size_t i = 0; i < rays.size(); ++i) {
        const testing::AssertionResult same = sameBits(a[i], b[i]);
        if (same) continue;
        if (differing++ == 0) first = text(rays[i]) + ": " + same.message();
    }
    if (differing == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << differing << " of " << rays.size() << " rays differ, the first: " << first;
}

RayInput rayOf(const glm::vec3& origin, const glm::vec3& direction) {
    RayInput ray;
    ray.origin = origin;
    ray.direction = direction;
    return ray;
}

RayInput rayTowards(const glm::dvec3& origin, const glm::dvec3& target, bool unit) {
    const glm::vec3 o(origin);
    const glm::dvec3 d = target - glm::dvec3(o);
    return rayOf(o, glm::vec3(unit ? glm::normalize(d) : d));
}

size_t misses(const std::vector<RayHit>& hits) {
    return static_cast<size_t>(
        std::count_if(hits.begin(), hits.end(), [](const RayHit& h) { return !h.hit; }));
}

std::string text(const RayInput& ray) {
    std::ostringstream out;
    out << std::hexfloat << "origin " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z
        << " direction " << ray.direction.x << " " << ray.direction.y << " " << ray.direction.z << " tMin "
        << ray.tMin << " tMax " << ray.tMax;
    return out.str();
}

}  // namespace glint::render::test
