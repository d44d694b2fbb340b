#include "reference/optics.h"

#include <algorithm>
#include <cmath>

namespace glint::reference {

using glm::dvec3;

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

Split splitAbout(const dvec3& d, const dvec3& m, double ratio) {
    const double depth = -glm::dot(d, m);
    const dvec3 across = d + depth * m;  // the part of d in the surface
    const double sine = glm::length(across);
    Split result;
    result.reflected = glm::normalize(across + depth * m);
    const double sineAfter = ratio * sine;
    result.total = sineAfter >= 1;
    if (result.total) {
        result.reflectance = 1;
        return result;
    }
    const double incidence = std::atan2(sine, depth), refraction = std::asin(sineAfter);
    result.reflectance = fresnel(incidence, refraction, ratio);
    result.refracted = glm::normalize(ratio * across - std::cos(refraction) * m);
    return result;
}

}  // namespace

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

double iorOf(const Model& scene, uint32_t medium) {
    return medium == 0 ? 1.0 : static_cast<double>(scene.optics[medium - 1].ior);
}

dvec3 attenuationOf(const Model& scene, uint32_t medium) {
    return medium == 0 ? dvec3(0) : dvec3(scene.optics[medium - 1].attenuation);
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

Split splitAt(const dvec3& d, const dvec3& n, const dvec3& s, double ratio) {
    Split result = splitAbout(d, s, ratio);
    const bool sound = glm::dot(d, s) < 0 && glm::dot(result.reflected, n) > 0 &&
                       (result.total || glm::dot(result.refracted, n) < 0);
    return sound ? result : splitAbout(d, n, ratio);
}

}  // namespace glint::reference
