#include "limbs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <iostream>
#include <random>

#include "../render/support.h"
#include "verify/verify.h"

namespace glint::stability {
namespace {

using glm::dvec3;

// The mirror, last, shows all others at (x, y, -16 - z).
constexpr double kMirrorPlane = -8;
const char* const kLimbs = R"({
  "camera": {"eye": [0, 0.3, 9], "target": [0, 0, 0]}, "ambient": 0.2, "background": 0.3, "maxDepth": 3,
  "materials": {"mirror": {"diffuse": 0.1, "mirror": 0.8}, "shiny": {"diffuse": 0.6, "specular": 0.5, "shininess": 80, "mirror": 0.2}},
  "lights": [{"type": "directional", "direction": [-0.5, -1, -0.4]}, {"type": "point", "position": [3, 5, 4]}],
  "objects": [{"type": "sphere", "center": [0, 0.2, 0], "radius": 1},
              {"type": "sphere", "center": [-1.4, 1.6, 1], "radius": 0.01},
              {"type": "sphere", "center": [0, -1000001, 0], "radius": 1000000},
              {"type": "cylinder", "base": [2, -0.9, 0], "top": [2.2, 1, 0.3], "radius": 0.5, "material": "shiny"},
              {"type": "cone", "base": [-2, -0.9, 1], "apex": [-2, 0.4, 1.2], "radius": 0.5},
              {"type": "ellipsoid", "center": [1.2, 2, -1], "radii": [0.7, 0.3, 0.5], "material": "shiny"},
              {"type": "disc", "center": [-3, 0.3, 0], "normal": [0.2, 0.1, 1], "radius": 0.7},
              {"type": "plane", "point": [0, 0, -8], "normal": [0, 0, 1], "material": "mirror"}]
})";
constexpr uint32_t kTargets = 7;
const dvec3 kMiddles[kTargets] = {{0, 0.2, 0},     {-1.4, 1.6, 1}, {0, -1, -3}, {2.1, 0, 0.15},
                                  {-2, -0.4, 1.1}, {1.2, 2, -1},   {-3, 0.3, 0}};

// Towards the edge of what is seen of an object, straight or in the mirror, as well as double can say.
class Aim {
  public:
    explicit Aim(const render::test::Case& c) : case_(c), tracer_(c.packed) {}

    // False where the object's middle is not seen.
    bool at(uint32_t object, bool mirrored, double turn, dvec3& direction) const {
        const dvec3 eye = case_.scene.camera.eye;
        dvec3 middle = kMiddles[object];
        if (mirrored) middle.z = 2 * kMirrorPlane - middle.z;
        dvec3 inside = glm::normalize(middle - eye);
        const dvec3 side = glm::normalize(glm::cross(inside, dvec3(0.3, 1, 0.2)));
        const dvec3 aside = std::cos(turn) * side + std::sin(turn) * glm::cross(inside, side);
        dvec3 outside = glm::normalize(inside + 0.7 * aside);
        if (!sees(object, mirrored, inside) || sees(object, mirrored, outside)) return false;
        for (int i = 0; i < 50; ++i) {
            const dvec3 between = glm::normalize(inside + outside);
            (sees(object, mirrored, between) ? inside : outside) = between;
        }
        direction = inside;
        return true;
    }

  private:
    bool sees(uint32_t object, bool mirrored, const dvec3& direction) const {
        reference::Ray ray;
        ray.origin = dvec3(case_.camera.eye);
        ray.direction = direction;
        const reference::PixelRecord seen = tracer_.trace(ray, {}, true);
        const size_t at = mirrored ? 1 : 0;
        return seen.path.size() > at && seen.path[at].surface && seen.path[at].surface->object == object &&
               (!mirrored || seen.path[0].surface->object == kTargets);
    }

    const render::test::Case& case_;
    reference::Tracer tracer_;
};

}  // namespace

void expectLimbsExplained(const gpu::Device& device, uint64_t rays) {
    const int width = rays > 10000000 ? 320 : 96, height = 3 * width / 4;
    const render::test::Case c = render::test::textCase(kLimbs, width, height);
    render::Renderer renderer(device, c.packed);
    const Aim aim(c);
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    uint64_t cast = 0, explained = 0;
    for (uint32_t turn = 0; cast < rays; ++turn) {
        Camera camera = c.scene.camera;
        dvec3 direction;
        const bool mirrored = turn % 3 == 2, lens = turn % 5 == 4;
        if (!aim.at(turn % kTargets, mirrored, glm::two_pi<double>() * uniform(engine), direction)) continue;
        camera.target = camera.eye + 9.0 * direction;
        camera.up = dvec3(0.1, 0.9, 0.4);
        camera.fovY = 0.2 * std::pow(10, -5 * uniform(engine));
        if (lens) camera.lensRadius = 1e-4;
        verify::Options options;
        options.width = width;
        options.height = height;
        const verify::Report report =
            verify::verify(renderer, c.packed, packCamera(camera, width, height, c.packed.origin), options);
        ASSERT_EQ(report.unexplained, 0u) << "turn " << turn << ", " << camera.fovY << " degrees";
        cast += report.pixels;
        explained += report.explained();
    }
    std::cout << "[ measured ] " << cast << " rays at limbs, " << explained << " explained\n";
}

}  // namespace glint::stability
