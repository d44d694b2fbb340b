#include "reference/scatter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/device_layout.h"
#include "reference/rounding.h"

namespace glint::reference {

using glm::dvec3;

// ---- Media

Media mediaAtEye(const rows::Environment& e) {
    Media media;
    for (uint32_t medium : {e.eyeMedium0, e.eyeMedium1, e.eyeMedium2, e.eyeMedium3})
        if (medium != 0) media.push_back(medium);
    return media;
}

uint32_t rulingMedium(const Model& scene, const Media& media) {
    const auto rank = [&](uint32_t medium) { return scene.optics[medium - 1].rank; };
    // The last of the greatest: max_element finds the first, so it looks from the back.
    const auto found = std::max_element(media.rbegin(), media.rend(),
                                        [&](uint32_t a, uint32_t b) { return rank(a) < rank(b); });
    return found == media.rend() ? 0 : *found;
}

dvec3 attenuationOf(const Model& scene, uint32_t medium) {
    return medium == 0 ? dvec3(0) : scene.optics[medium - 1].attenuation;
}

dvec3 transmittance(const Model& scene, uint32_t medium, double length) {
    const dvec3 sigma = attenuationOf(scene, medium);
    dvec3 left(1);
    for (int i = 0; i < 3; ++i)
        if (sigma[i] > 0) left[i] = std::exp(-sigma[i] * length);
    return left;
}

Crossing crossingAt(const Model& scene, const Media& media, uint32_t medium, bool entering) {
    Crossing crossing;
    crossing.before = media;
    crossing.after = media;
    const auto put = [&](Media& list) {
        if (list.size() < shared::kMaxMedia)
            list.push_back(medium);
        else
            crossing.crowded = true;
    };
    if (medium != 0 && entering) {
        put(crossing.after);
    } else if (medium != 0) {
        if (std::find(media.begin(), media.end(), medium) == media.end()) put(crossing.before);
        crossing.after = crossing.before;
        const auto last = std::find(crossing.after.rbegin(), crossing.after.rend(), medium);
        if (last != crossing.after.rend()) crossing.after.erase(std::next(last).base());
    }
    crossing.mediumBefore = rulingMedium(scene, crossing.before);
    crossing.mediumAfter = rulingMedium(scene, crossing.after);
    crossing.counts = medium == 0 || crossing.mediumBefore != crossing.mediumAfter;
    return crossing;
}

// ---- Dielectric surfaces

namespace {

// Fresnel's equations in angles (Born & Wolf, Principles of Optics, 7th ed., sec. 1.5.2, eq. 21a squared):
// sin^2(a - b) / sin^2(a + b) and tan^2(a - b) / tan^2(a + b); their limit at normal incidence.
double fresnel(double incidence, double refraction, double ratio) {
    if (incidence < 1e-9) {
        const double r = (ratio - 1) / (ratio + 1);
        return r * r;
    }
    const double difference = incidence - refraction, sum = incidence + refraction;
    const double across = std::sin(difference) / std::sin(sum), along = std::tan(difference) / std::tan(sum);
    return (across * across + along * along) / 2;
}

// fp32 takes sin^2 of the refracted angle as e^2 (1 - c) (1 + c), which rounds seven times, and errs by 2 c
// e^2 times the error of the cosine c. This decides where total reflection begins.
Split splitAbout(const dvec3& d, const dvec3& m, double ratio, double noise, double turn) {
    const double depth = -glm::dot(d, m);
    const dvec3 across = d + depth * m;  // the part of d in the surface
    const double sine = glm::length(across);
    Split result;
    result.reflected = glm::normalize(across + depth * m);
    const double square = ratio * ratio * sine * sine;
    const double error = 7 * square + 2 * ratio * ratio * std::abs(depth) * turn;
    const double sineAfter = std::sqrt(std::max(square + noise * error, 0.0));
    result.total = sineAfter >= 1;
    if (result.total) {
        result.reflectance = 1;
        return result;
    }
    const double incidence = std::atan2(sineAfter / ratio, depth), refraction = std::asin(sineAfter);
    result.reflectance = fresnel(incidence, refraction, ratio);
    result.refracted = glm::normalize(ratio * across - std::cos(refraction) * m);
    return result;
}

}  // namespace

Split splitAt(const dvec3& d, const dvec3& n, const dvec3& s, double ratio, double noise, double turn) {
    Split result = splitAbout(d, s, ratio, noise, turn);
    const bool sound = glm::dot(d, s) < 0 && glm::dot(result.reflected, n) > 0 &&
                       (result.total || glm::dot(result.refracted, n) < 0);
    return sound ? result : splitAbout(d, n, ratio, noise, turn);
}

// ---- Lights

LightSample sampleLight(const rows::Light& light, const dvec3& position) {
    const bool directional = light.kind == shared::kLightDirectional;
    LightSample s;
    s.toLight = directional ? light.position : light.position - position;
    const double length = glm::length(s.toLight);
    s.direction = s.toLight / length;
    s.distance = directional ? std::numeric_limits<double>::infinity() : length;
    s.valid = directional || length >= static_cast<double>(shared::kNearestLight);
    return s;
}

bool isSpot(const rows::Light& light) {
    return (light.kind & shared::kLightKindMask) == shared::kLightSpot;
}

// smoothstep(cos(angle + penumbra), cos(angle), c), c the cosine at the light between its axis and the way to
// the surface; without a penumbra a step.
double spotFactor(const rows::Light& light, const dvec3& toLight) {
    if (!isSpot(light)) return 1;
    const double c = -glm::dot(glm::normalize(light.axis), glm::normalize(toLight));
    const double full = 1 - light.inner, none = 1 - light.outer;
    if (c >= full || full <= -1) return 1;  // a cone of 180 degrees is everything
    if (c <= none) return 0;
    const double x = (c - none) / (full - none);
    return (3 - 2 * x) * x * x;
}

dvec3 intensityAt(const rows::Light& light, double distance, double part) {
    const bool fades = (light.kind & shared::kLightFades) != 0;
    return part / (fades ? distance * distance : 1) * light.intensity;
}

// 1 - cos of an angle a errs by a times what the directions are off, the smoothstep by 3/2 of that over the
// width of the penumbra.
double spotError(const rows::Light& light, const dvec3& toLight, double part, double turn) {
    if (part >= 1) return 0;
    const double cone = 1 + glm::dot(glm::normalize(light.axis), toLight);
    const double width = std::max(light.outer - light.inner, 1e-30);
    const double blur = 1.5 * (std::sqrt(2 * cone) * (turn + 4) + 4 * cone) / width;
    return std::min(blur, 0x1p24) / part;
}

// ---- Surfaces: T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980; J. Blinn,
// "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977.

dvec3 offsetOrigin(const Interaction& at, const dvec3& direction) {
    return at.position + (glm::dot(direction, at.n) < 0 ? -at.offset : at.offset) * at.n;
}

Reflection evaluate(const Interaction& at, const dvec3& l, double turn) {
    const double cosine = glm::dot(at.s, l), slip = cosineError(turn, at.normalError);
    const double least = std::min(cosine, glm::dot(at.n, l)) - static_cast<double>(shared::kLeastCosine);
    Reflection result;
    if (least <= -slip * kFloatUnit) return result;
    const dvec3 middle = l + at.view;
    const double length = glm::length(middle);
    const double highlight = length > 0 ? glm::dot(at.s, middle) / length : 0;
    dvec3 specular(0);
    if (highlight > 0) {
        const double n = at.material.shininess, power = std::pow(highlight, n);
        specular = power * at.material.specular;
        result.error = powerError(highlight, n, power, length, turn, at.normalError) * at.material.specular;
    }
    result.faces = least > 0;
    result.highlight = highlight > 0;
    if (result.faces) result.value = cosine * at.material.diffuse + specular;
    if (!result.faces) result.error = dvec3(0);
    if (least < slip * kFloatUnit)
        result.error += 0x1p24 * (specular + static_cast<double>(shared::kLeastCosine) * at.material.diffuse);
    result.error += slip * at.material.diffuse;
    return result;
}

Scattering scatteringAt(const Model& scene, const Interaction& at, double noise) {
    const bool dielectric = at.material.medium != 0;
    const auto iorOf = [&](uint32_t medium) { return medium == 0 ? 1.0 : scene.optics[medium - 1].ior; };
    const double ratio = iorOf(at.crossing.mediumBefore) / iorOf(at.crossing.mediumAfter);
    const bool splits = dielectric && at.crossing.counts && ratio != 1;
    const dvec3 d = -at.view;
    Split split;
    split.refracted = d;
    // About the shading normal, or about the geometric one where that would lead below the surface.
    split.reflected = glm::reflect(d, at.s);
    if (glm::dot(split.reflected, at.n) <= 0) split.reflected = glm::reflect(d, at.n);
    if (splits) split = splitAt(d, at.n, at.s, ratio, noise, cosineError(0, at.normalError));
    const double error = splits && !split.total ? kReflectanceError : 0;
    const auto weigh = [&](const dvec3& weight) -> RoundedColor {
        return {weight, kProductRoundings * weight + error};
    };
    Scattering s;
    s.reflects = at.crossing.counts && (splits || at.material.mirror != glm::dvec3(0));
    s.reflected = glm::normalize(split.reflected);
    s.reflectedWeight = weigh(glm::min(at.material.mirror + split.reflectance, dvec3(1)));
    s.refracts = dielectric && !split.total;
    s.refracted = split.refracted;
    s.refractedWeight = weigh((1 - split.reflectance) * (at.crossing.counts ? at.transmission : dvec3(1)));
    return s;
}

}  // namespace glint::reference
