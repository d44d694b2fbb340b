#include "tinybvh_rays.h"

#include <algorithm>

#define TINYBVH_IMPLEMENTATION
#include "core/parallel.h"
#include "rays.h"
#include "tiny_bvh.h"

namespace glint::bench {

struct TinyBvh::Tree {
    std::vector<tinybvh::bvhvec4> corners;
    tinybvh::BVH8_CPU bvh;
};

TinyBvh::TinyBvh(const std::vector<glm::vec3>& corners) : tree_(std::make_unique<Tree>()) {
    for (const glm::vec3& p : corners) tree_->corners.emplace_back(p.x, p.y, p.z, 0.0f);
    tree_->bvh.Build(tree_->corners.data(), static_cast<uint32_t>(corners.size() / 3));
}

TinyBvh::~TinyBvh() = default;

namespace {

// `meets`: of a tinybvh::Ray.
template <class Meets>
double cast(const std::vector<glm::vec3>& origins, const std::vector<glm::vec3>& directions,
            std::vector<uint8_t>& hit, const Meets& meets) {
    constexpr size_t kBlock = 1024;
    hit.resize(origins.size());
    const Timer timer;
    parallelFor(Context{}, (origins.size() + kBlock - 1) / kBlock, [&](size_t block) {
        for (size_t i = block * kBlock; i < std::min(origins.size(), (block + 1) * kBlock); ++i) {
            const glm::vec3 o = origins[i], d = directions[i];
            tinybvh::Ray ray(tinybvh::bvhvec3(o.x, o.y, o.z), tinybvh::bvhvec3(d.x, d.y, d.z));
            hit[i] = meets(ray);
        }
    });
    return timer.elapsed().cpu;
}

}  // namespace

double TinyBvh::closest(const std::vector<glm::vec3>& origins, const std::vector<glm::vec3>& directions,
                        std::vector<uint8_t>& hit) const {
    return cast(origins, directions, hit, [&](tinybvh::Ray& ray) {
        tree_->bvh.Intersect(ray);
        return ray.hit.t < 1e30f;
    });
}

double TinyBvh::any(const std::vector<glm::vec3>& origins, const std::vector<glm::vec3>& directions,
                    std::vector<uint8_t>& hit) const {
    return cast(origins, directions, hit, [&](tinybvh::Ray& ray) { return tree_->bvh.IsOccluded(ray); });
}

}  // namespace glint::bench
