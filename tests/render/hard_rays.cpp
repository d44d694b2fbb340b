#include "hard_rays.h"

#include <cmath>

namespace glint::render::test {

using glm::dvec3;
using glm::vec3;

RayCase crowdedCase(uint32_t triangles, size_t rays, uint32_t seed) {
    Scene scene = emptyScene();
    Random random(7);
    for (uint32_t i = 0; i < triangles; ++i) {
        const dvec3 at = random.box(2);
        addTriangle(scene, at, at + random.box(0.5), at + random.box(0.5));
        if (i % 4 == 0) addSphere(scene, random.box(2), random.uniform(0.02, 0.3));
    }
    addPlane(scene, {0, -2, 0}, {0.1, 1, 0.2});
    RayCase result{makeCase(scene, 8, 8), {}};
    Random directions(seed);
    while (result.rays.size() < rays) result.rays.push_back(rayTowards(directions.box(3), directions.box(2)));
    return result;
}

RayCase axisCase() {
    Scene scene = emptyScene();
    addGrid(scene, 24);
    addGrid(scene, 24, {0, 0, -0.25});
    addSphere(scene, {0.5, 0.5, 0.25}, 0.25);
    RayCase result{makeCase(scene, 8, 8), {}};
    std::vector<RayInput>& rays = result.rays;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                for (int i = 0; i < 49; ++i) {
                    const vec3 from(static_cast<float>(i % 7) / 6.0f, static_cast<float>(i / 7) / 6.0f, 0.5f);
                    rays.push_back(rayOf(from - vec3(x, y, z), vec3(x, y, z)));
                    rays.push_back(rayOf(from, vec3(x, y, -0.0f)));
                    if (i % 5 == 0) rays.back().tMax = 0;
                    if (i % 9 == 0) rays.back().tMin = 0.75f;
                }
            }
        }
    }
    return result;
}

RayCase nestedCase() {
    Scene scene = emptyScene();
    for (uint32_t i = 0; i < kNestedCount; ++i) {
        const double s = std::ldexp(1.0, -static_cast<int>(i));
        if (i % 2 == 0)
            addTriangle(scene, {s, -s, -s}, {s, s, -s}, {s, 0, s});
        else
            addSphere(scene, {s, 0, 0}, 0.3 * s);
    }
    RayCase result{makeCase(scene, 8, 8), {}};
    for (int i = 0; i < 64; ++i)
        result.rays.push_back(
            rayOf(vec3(0), {1, 0.01f * static_cast<float>(i % 8), 0.01f * static_cast<float>(i / 8)}));
    return result;
}

RayCase outwardCase(int clusters) {
    Scene scene = emptyScene();
    Random random(23);
    for (int k = 0; k < clusters; ++k) {
        const double s = std::pow(0.8, k);
        for (int i = 0; i < 8; ++i) addSphere(scene, dvec3(s) + random.box(0.04 * s), 1e-4 * s);
    }
    RayCase result{makeCase(scene, 8, 8), {}};
    while (result.rays.size() < 256) result.rays.push_back(rayOf(vec3(0), vec3(1) + vec3(random.box(0.01))));
    return result;
}

RayCase concentricCase() {
    Scene scene = emptyScene();
    for (int i = 0; i < 40; ++i) addSphere(scene, {0.5, 0.25, -0.5}, 0.75);
    RayCase result{makeCase(scene, 8, 8), {}};
    Random random(37);
    while (result.rays.size() < 512) {
        const dvec3 from = dvec3(0.5, 0.25, -0.5) + random.box(0.2);
        result.rays.push_back(rayTowards(from, from + random.box(1)));
    }
    return result;
}

RayCase tiedCase() {
    Scene scene = emptyScene();
    for (int i = 0; i < 5; ++i) addGrid(scene, 16);
    RayCase result{makeCase(scene, 8, 8), {}};
    for (int i = 0; i < 1024; ++i) {
        const vec3 at((static_cast<float>(i % 32) + 0.5f) / 32.0f,
                      (static_cast<float>(i / 32) + 0.37f) / 32.0f, 1);
        result.rays.push_back(rayOf(at, {0, 0, -1}));
    }
    return result;
}

}  // namespace glint::render::test
