// T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980; J. Blinn, "Models of
// Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977.
#include "reference/scatter.h"

#include "reference/rounding.h"

namespace glint::reference {

using glm::dvec3;

dvec3 offsetOrigin(const Interaction& at, const dvec3& direction) {
    return at.position + (glm::dot(direction, at.n) < 0 ? -at.offset : at.offset) * at.n;
}

Reflection evaluate(const Interaction& at, const dvec3& l, double turn) {
    const double cosine = glm::dot(at.s, l), slip = cosineError(turn, at.normalError);
    const double least = std::min(cosine, glm::dot(at.n, l));
    Reflection result;
    if (least <= -slip * kFloatUnit) return result;
    const dvec3 middle = l + at.view;
    const double length = glm::length(middle);
    const double highlight = length > 0 ? glm::dot(at.s, middle) / length : 0;
    dvec3 specular(0);
    if (highlight > 0) {
        const double n = at.material.shininess, power = std::pow(highlight, n);
        specular = power * dvec3(at.material.specular);
        result.error =
            powerError(highlight, n, power, length, turn, at.normalError) * dvec3(at.material.specular);
    }
    result.faces = least > 0;
    result.highlight = highlight > 0;
    if (result.faces) result.part = cosine * dvec3(at.material.diffuse) + specular;
    if (!result.faces) result.error = dvec3(0);
    if (least < slip * kFloatUnit) result.error += 0x1p24 * specular;
    result.error += slip * dvec3(at.material.diffuse);
    return result;
}

dvec3 mirrored(const Interaction& at) {
    const dvec3 d = -at.view;
    dvec3 r = d - 2 * glm::dot(d, at.s) * at.s;
    if (glm::dot(r, at.n) <= 0) r = d - 2 * glm::dot(d, at.n) * at.n;
    return glm::normalize(r);
}

Scattering scatteringAt(const Model& scene, const Interaction& at) {
    const bool dielectric = at.material.medium != 0;
    const double ratio = iorOf(scene, at.crossing.mediumBefore) / iorOf(scene, at.crossing.mediumAfter);
    const bool splits = dielectric && at.crossing.counts && ratio != 1;
    const dvec3 d = -at.view;
    Split split;
    split.refracted = d;
    if (splits) split = splitAt(d, at.n, at.s, ratio);
    Scattering s;
    s.reflects = at.crossing.counts && (splits || at.material.mirror != glm::dvec3(0));
    s.reflected = splits ? split.reflected : mirrored(at);
    s.reflectedWeight = glm::min(dvec3(at.material.mirror) + split.reflectance, dvec3(1));
    s.refracts = dielectric && !split.total;
    s.refracted = split.refracted;
    s.refractedWeight = (1 - split.reflectance) * (at.crossing.counts ? at.transmission : dvec3(1));
    if (splits && !split.total) s.weightError = kReflectanceError;
    return s;
}

}  // namespace glint::reference
