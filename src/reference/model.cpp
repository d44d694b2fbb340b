#include "reference/model.h"

#include <bit>

#include "pack/packed_scene.h"
#include "reference/numbers.h"

namespace glint::reference {

namespace {

// Widens each array that both have. Other members are shared or are not arrays.
template <class From, class To>
void widenArrays(const From& from, To& to) {
#define GLINT_WIDEN(binding, array, Name, ROWS)                                        \
    if constexpr (requires { to.array.assign(from.array.begin(), from.array.end()); }) \
        to.array.assign(from.array.begin(), from.array.end());
    GLINT_SCENE_ARRAYS(GLINT_WIDEN)
#undef GLINT_WIDEN
}

// x (1 + units 2^-24 h) with h in [-1, 1) by the number's bits and the seed.
struct Disturbance {
    uint64_t seed;
    double step;
    bool isCopied = false;  // a number that fp32 holds stays: an index of 1 is that of air

    void operator()(double& x) const {
        if (isCopied && x == static_cast<double>(static_cast<float>(x))) return;
        uint64_t state = std::bit_cast<uint64_t>(x) + (seed - 1) * kUniformStride;
        x += x * step * uniform(state);
    }
    void operator()(glm::dvec3& v) const {
        for (int i = 0; i < 3; ++i) (*this)(v[i]);
    }
    template <class Row>
    void operator()(std::vector<Row>& array) const {
        for (Row& row : array) row.changeNumbers(*this);
    }
};

// The device's two equations of a cone with a tip near the eye (GLINT_QUADRIC_ROWS) as one equation, which
// double evaluates accurately at either end.
void asOneEquation(rows::Quadric& cone) {
    if (!(cone.caps & shared::kFromApex)) return;
    const glm::dvec3 a = cone.linear;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        cone.linear[i] = cone.squares[i] * a[i] + cone.products[k] * a[j] + cone.products[j] * a[k];
    }
    cone.constant = glm::dot(a, cone.linear);
}

}  // namespace

Model widened(const PackedScene& scene) {
    Model model;
    model.origin = scene.origin;
    model.nodes = std::make_shared<const std::vector<rows::Node>>(scene.nodes.begin(), scene.nodes.end());
    widenArrays(scene, model);
    for (rows::Quadric& quadric : model.quadrics) asOneEquation(quadric);
    model.environment = scene.environment;
    model.texels = std::shared_ptr<const std::vector<shared::Texel>>(std::shared_ptr<void>(), &scene.texels);
    model.alphaMask = scene.features.alphaMask;
    model.coloredShadows = scene.features.coloredShadows;
    model.instanceGain = scene.instanceGain;
    model.boundsLo = glm::dvec3(scene.boundsLo);
    model.boundsHi = glm::dvec3(scene.boundsHi);
    return model;
}

Model disturbed(const Model& model, uint64_t seed, double units) {
    Model moved = model;
    const Disturbance disturb{seed, units * 0x1p-24};
#define GLINT_DISTURB(number, Kind, KINDS, kinds, one, many) disturb(moved.kinds);
    GLINT_PRIMITIVES(GLINT_DISTURB, GLINT_DISTURB)
#undef GLINT_DISTURB
    disturb(moved.vertexNormals);
    disturb(moved.polygonVertices);
    // Packing copies these from the scene, and computes all others.
    const Disturbance disturbCopy{seed, units * 0x1p-24, true};
    disturbCopy(moved.materials);
    disturbCopy(moved.optics);
    disturb(moved.lights);
    disturbCopy(moved.textures);
    disturb(moved.vertexAttributes);
    disturb(moved.objectFrames);
    disturb(moved.environment.background);
    disturb(moved.environment.ambient);
    return moved;
}

rows::Camera disturbed(const rows::Camera& camera, uint64_t seed, double units) {
    rows::Camera moved = camera;
    const Disturbance disturb{seed, units * 0x1p-24};
    for (glm::dvec3* v : {&moved.eye, &moved.center, &moved.stepX, &moved.stepY, &moved.originStepX,
                          &moved.originStepY, &moved.lensX, &moved.lensY})
        disturb(*v);
    disturb(moved.inverseFocus);
    disturb(moved.nearT);
    disturb(moved.farT);
    return moved;
}

}  // namespace glint::reference
