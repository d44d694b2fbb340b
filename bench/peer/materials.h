// Materials and textures of the peer, in single precision (docs/reference/shading.md).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"

namespace glint::bench::peer {

struct Material {
    glm::vec3 ambient, diffuse, specular, mirror, transmission, attenuation;
    float shininess, ior, alphaCutoff;
    int priority;
    bool mirrors, dielectric, attenuates;
    bool wantsUv;     // an image or a checker lies on it
    bool wantsPlace;  // a solid checker
    uint32_t ambientTexture, diffuseTexture, specularTexture, mirrorTexture, transmissionTexture;
};

// A point on a surface, as far as textures and shading want it.
struct Surface {
    float t = 0;
    float reach = 0;  // of the numbers that the point comes from: what its rounding is a part of
    glm::vec3 point{0};
    glm::vec3 outward{0, 0, 1};  // unit, geometric
    glm::vec3 normal{0, 0, 1};   // unit, for shading, on the outward side
    glm::vec2 uv{0};
    glm::vec3 place{0};  // in the object's own coordinates
    glm::vec3 color{1};  // of the vertices
    uint32_t material = 0;
};

class Materials {
  public:
    explicit Materials(const Scene& scene);

    const Material& operator[](uint32_t i) const { return materials_[i]; }
    // `color` times what the texture shows there.
    glm::vec3 textured(const glm::vec3& color, uint32_t texture, const Surface& s) const;
    // An alpha mask has a hole there.
    bool hole(const Material& m, const Surface& s) const;
    // What comes from infinitely far away.
    glm::vec3 background(const glm::vec3& direction) const;

  private:
    struct Texture {
        const Image* image = nullptr;  // null: a checker
        Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
        bool nearest = false, solid = false;
        glm::vec3 a{1}, b{0}, corner{0};
        glm::vec2 scale{1}, offset{0};
    };
    static glm::vec4 lookUp(const Texture& texture, const glm::vec2& uv);

    std::vector<Material> materials_;
    std::vector<Texture> textures_;
    glm::vec3 background_{0};
    Texture environment_;
    float turned_ = 0;
};

}  // namespace glint::bench::peer
