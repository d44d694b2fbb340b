#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/vectors.h"
#include "pack/packed_scene.h"
#include "pack/primitives.h"
#include "pack/scene_arrays.h"

namespace glint {
namespace {

using glm::dvec3;

// Surfaces of a material around a point.
struct Enclosure : BoundingBox {
    double windings = 0;  // how often they go round it
    double size = 0;      // the diagonal of their box, infinite with a plane
};

class MediaFinder {
  public:
    MediaFinder(const PackedScene& scene, const dvec3& point)
        : scene_(scene), point_(point), enclosures_(scene.optics.size() + 1) {}

    glm::uvec4 find() {
        if (scene_.environment.root != shared::kNone) addTree(scene_.environment.root, {});
        addPlanes();
        std::vector<uint32_t> media;
        for (uint32_t medium = 1; medium < enclosures_.size(); ++medium) {
            Enclosure& e = enclosures_[medium];
            if (e.size == 0) e.size = glm::length(e.hi - e.lo);
            const auto times = static_cast<int>(std::lround(e.windings));
            for (int i = 0; i < times && i < static_cast<int>(shared::kMaxMedia); ++i)
                media.push_back(medium);
        }
        std::stable_sort(media.begin(), media.end(),
                         [&](uint32_t a, uint32_t b) { return enclosures_[a].size > enclosures_[b].size; });
        glm::uvec4 found(0);
        for (size_t i = 0; i < std::min<size_t>(media.size(), shared::kMaxMedia); ++i)
            found[static_cast<int>(i)] = media[i];
        return found;
    }

  private:
    uint32_t mediumOf(uint32_t material) const { return scene_.materials[material].medium; }

    // Space of a BVH: the world, or an instance.
    struct Place {
        const shared::Instance* instance = nullptr;

        dvec3 world(const dvec3& x) const {
            if (instance == nullptr) return x;
            return dvec3(instance->place) + dvec3(glm::dot(dvec3(instance->toWorldX), x),
                                                  glm::dot(dvec3(instance->toWorldY), x),
                                                  glm::dot(dvec3(instance->toWorldZ), x));
        }
        uint32_t material(uint32_t own) const {
            return instance == nullptr || instance->material == shared::kNone ? own : instance->material;
        }
    };

    void addTree(uint32_t root, const Place& place) {
        visitLeaves(scene_.nodes, root,
                    [&](shared::PrimitiveKind kind, uint32_t i) { addPrimitive(kind, i, place); });
    }

    uint32_t materialOf(shared::PrimitiveKind kind, uint32_t i) const {
        return visitPrimitive(scene_, kind, i, [&](const auto& primitive) {
            if constexpr (requires { primitive.material; })
                return primitive.material;
            else
                return scene_.triangleSurfaces[i].material;
        });
    }

    // Alone of all that encloses anything triangles may be an instance's. One that mirrors turns their
    // winding around.
    double windingOf(const shared::Triangle& t, const Place& place) const {
        const bool mirrored = place.instance != nullptr && place.instance->mirrored != 0;
        const dvec3 a = place.world(dvec3(t.v0)) - point_, b = place.world(dvec3(t.v1)) - point_,
                    c = place.world(dvec3(t.v2)) - point_;
        return mirrored ? glint::windingOf(a, c, b) : glint::windingOf(a, b, c);
    }

    void addPrimitive(shared::PrimitiveKind kind, uint32_t i, const Place& place) {
        if (kind == shared::PrimitiveKind::Instance)
            return addTree(scene_.instances[i].root, {&scene_.instances[i]});
        const uint32_t medium = mediumOf(place.material(materialOf(kind, i)));
        if (medium == 0) return;
        Enclosure& e = enclosures_[medium];
        e.windings += kind == shared::PrimitiveKind::Triangle ? windingOf(scene_.triangles[i], place)
                                                              : packerOf(kind).windings(scene_, i, point_);
        packerOf(kind).balls(scene_, i, [&](const dvec3& center, double radius) {
            e.include(place.world(center) - radius);
            e.include(place.world(center) + radius);
        });
    }

    void addPlanes() {
        for (uint32_t i = 0; i < scene_.planes.size(); ++i) {
            const uint32_t medium = mediumOf(scene_.planes[i].material);
            if (medium == 0) continue;
            enclosures_[medium].windings += packerOfPlane().windings(scene_, i, point_);
            enclosures_[medium].size = std::numeric_limits<double>::infinity();
        }
    }

    const PackedScene& scene_;
    dvec3 point_;
    std::vector<Enclosure> enclosures_;  // by medium; 0 is unused
};

}  // namespace

double windingOf(const dvec3& a, const dvec3& b, const dvec3& c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double volume = glm::dot(a, glm::cross(b, c));
    const double cosines = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2 * std::atan2(volume, cosines) / (4 * std::numbers::pi);
}

glm::uvec4 mediaAt(const PackedScene& scene, const glm::dvec3& point) {
    return scene.optics.empty() ? glm::uvec4(0) : MediaFinder(scene, point).find();
}

}  // namespace glint
