// Whitted's tree of rays over Embree's single rays, in single precision: what a user of Embree would write
// (docs/reference/shading.md says what it draws).
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/image.h"
#include "pack/packed_scene.h"
#include "peer/geometry.h"
#include "trace/request.h"

namespace glint::bench::peer {

class Tracer {
  public:
    // Keeps a reference to `scene`. Throws std::invalid_argument for a scene that Embree's primitives cannot
    // express.
    explicit Tracer(const Scene& scene);

    // On two threads, which take tiles of 16 x 16 pixels from a common counter.
    Image render() const;
    double buildSeconds() const { return geometry_.buildSeconds(); }

  private:
    struct Light {
        glm::vec3 position{0}, intensity{1}, axis{0};  // the way to a directional light in `position`
        bool directional = false, fades = false, spot = false;
        float full = 0, none = 0;  // cosines
    };
    static Light lightOf(const glint::Light& light, const glm::dvec3& origin);

    glm::vec3 pixel(int x, int y) const;
    Ray cameraRay(float x, float y, const glm::vec2& lens) const;
    glm::vec3 radiance(const Ray& ray, int depth, const Media& media) const;
    glm::vec3 shade(const Material& m, const Surface& s, const glm::vec3& d, const glm::vec3& n,
                    const glm::vec3& normal, const Media& media) const;
    // What an opaque mirror and what a dielectric add.
    glm::vec3 mirrored(const Material& m, const Surface& s, const Ray& ray, const glm::vec3& n,
                       const glm::vec3& normal, int depth, const Media& media) const;
    glm::vec3 split(const Material& m, const Surface& s, const Ray& ray, const glm::vec3& n,
                    const glm::vec3& normal, int depth, const Media& before, const Media& after) const;
    // The one that counts of several, or null: air.
    const Material* ruling(const Media& media) const;
    Media mediaAtEye() const;
    // From a surface towards the side of `n`.
    static Ray leave(const Surface& s, const glm::vec3& n, const glm::vec3& direction);

    const Scene& scene_;
    glm::dvec3 origin_;
    Materials materials_;
    Geometry geometry_;
    std::vector<Light> lights_;
    glm::vec3 ambient_;
    shared::Camera camera_;
    PackedSamples samples_;
    Media eye_;
};

}  // namespace glint::bench::peer
