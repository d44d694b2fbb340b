#include "view/view_scene.h"

#include <algorithm>
#include <limits>

#include "pack/kind_packer.h"
#include "pack/scene_arrays.h"

namespace glint::view {

namespace {

struct Box {
    glm::dvec3 lo{std::numeric_limits<double>::infinity()};
    glm::dvec3 hi{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    bool empty() const { return lo.x > hi.x; }
    Ball ball(const glm::dvec3& origin) const {
        // A single point still needs a distance to be seen from.
        return {origin + 0.5 * (lo + hi), std::max(0.5 * glm::length(hi - lo), 1e-6)};
    }
};

bool reflects(const shared::Material& m) {
    return m.mirror.x > 0 || m.mirror.y > 0 || m.mirror.z > 0;
}

// Calls ball(centre, radius) for what `object` is made of. Of an instance there is nothing here.
void visitBalls(const PackedScene& p, uint32_t object, const KindPacker::VisitBall& ball) {
    visitPrimitiveArrays(p, [&](shared::PrimitiveKind kind, const auto& array) {
        for (uint32_t i = 0; i < array.size(); ++i) {
            if constexpr (requires { array[i].anchorNormal; })
                if (array[i].anchorNormal != glm::vec3(0)) continue;  // as good as endless
            uint32_t owner;
            if constexpr (requires { array[i].object; })
                owner = array[i].object;
            else
                owner = p.triangleSurfaces[i].object;
            if (owner == object) packerOf(kind).balls(p, i, ball);
        }
    });
}

}  // namespace

Scene withOverrides(Scene scene, const Loading& loading) {
    if (loading.maxDepth) scene.maxDepth = *loading.maxDepth;
    if (loading.samplesPerPixel) scene.image.samplesPerPixel = *loading.samplesPerPixel;
    return scene;
}

std::shared_ptr<const ViewScene> packViewScene(const std::filesystem::path& path, Scene scene,
                                               BuildQuality quality, TreeMemory* memory) {
    auto loaded = std::make_shared<ViewScene>();
    loaded->path = path;
    loaded->scene = std::move(scene);
    loaded->packed = packScene(loaded->scene, 0, quality, true, memory);
    const auto& materials = loaded->packed.materials;
    loaded->also.mirrors = std::any_of(materials.begin(), materials.end(), reflects);
    loaded->also.parallelCamera = loaded->also.thinLens = true;  // the panel may ask for them
    return loaded;
}

Ball boundsOf(const ViewScene& scene) {
    const PackedScene& p = scene.packed;
    if (p.environment.root != shared::kNone) {
        Box box;
        box.add(p.boundsLo);
        box.add(p.boundsHi);
        return box.ball(p.origin);
    }
    const Camera& c = scene.scene.camera;
    return {c.target, 0.5 * glm::length(c.eye - c.target)};
}

Ball boundsOf(const ViewScene& scene, uint32_t object, const glm::dvec3& hit, double distance) {
    const PackedScene& p = scene.packed;
    Box box;
    visitBalls(p, object, [&](const glm::dvec3& point, double radius) {
        box.add(point - radius);
        box.add(point + radius);
    });
    if (box.empty()) return {hit, std::max(0.1 * distance, 1e-6)};
    const glm::dvec3 center = 0.5 * (box.lo + box.hi);
    double reach = 1e-6;
    visitBalls(p, object, [&](const glm::dvec3& point, double radius) {
        reach = std::max(reach, glm::length(point - center) + radius);
    });
    return {p.origin + center, reach};
}

}  // namespace glint::view
