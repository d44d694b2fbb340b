#include "report/front.h"

#include <algorithm>
#include <cmath>

#include "report/statistics.h"
#include "report/write.h"
#include "scene/sampling.h"

namespace glint::report {

namespace {

constexpr double kOfUse = 0.98;  // a ratio above is as good as one

bool clearlyLess(const std::vector<double>& a, const std::vector<double>& b, double tail) {
    return ratioInterval(a, b, tail).high < kOfUse;
}

// What the converged picture cannot tell is not more exact than anything.
bool clearlyMoreExact(const Measured& a, const Measured& b, double tail) {
    return !a.hidden && !b.hidden && clearlyLess(a.rmse, b.rmse, tail);
}

size_t rivalsOf(const SceneReport& scene, const Measured& m) {
    return static_cast<size_t>(std::count_if(
        scene.measured.begin(), scene.measured.end(),
        [&](const Measured& other) { return other.batch == m.batch && contestOf(other) == contestOf(m); }));
}

const Measured* championAgainst(const SceneReport& scene, const Measured& m) {
    const double n = static_cast<double>(rivalsOf(scene, m));
    const double tail = kMistake / std::max(n * (n - 1) / 2, 1.0);
    const Measured* best = nullptr;
    for (const Measured& other : scene.measured) {
        if (contestOf(other) != contestOf(m) || !beats(other, m, tail)) continue;
        const auto cost = [](const Measured& x) { return x.wall.median * x.error; };
        if (best == nullptr || cost(other) < cost(*best)) best = &other;
    }
    return best;
}

bool isDefaultOf(const SceneReport& scene, const Measured& m) {
    if (contestOf(m) == Contest::Methods) return m.family == kDefaultAmongMethods;
    if (contestOf(m) == Contest::None) return false;
    ImageSettings image;
    image.sampler = named<Sampler>(scene.defaultSampler).value_or(Sampler::Auto);
    image.samplesPerPixel = m.spp;
    return m.family == nameOf(samplerOf(image));
}

std::string nameWithSamples(const Measured& m) {
    return m.family + ", " + std::to_string(m.spp) + " spp";
}

// "0.75 (0.74 to 0.77) x the time, 1 (1 to 1) x the error".
std::string factors(const Measured& better, const Measured& m) {
    return ratio(better.seconds, m.seconds) + " x the time, " + ratio(better.rmse, m.rmse) + " x the error";
}

// "on" or "beaten" for each count, "1: on, 4: lowDiscrepancy".
std::string briefly(const SceneReport& scene, Contest contest) {
    std::string out;
    for (const Measured& m : scene.measured) {
        if (!m.isDefault || contestOf(m) != contest) continue;
        const Measured* by = scene.find(m.beatenBy);
        out += (out.empty() ? "" : ", ") + std::to_string(m.spp) + ": ";
        out += by == nullptr ? "yes" : "no (" + nameWithSamples(*by) + ")";
    }
    return out.empty() ? "not measured" : out;
}

}  // namespace

std::string ratio(const std::vector<double>& a, const std::vector<double>& b) {
    const Interval interval = ratioInterval(a, b, 0.05);
    const std::string middle = shortNumber(std::sqrt(interval.low * interval.high));
    return middle + " (" + shortNumber(interval.low) + " to " + shortNumber(interval.high) + ")";
}

Contest contestOf(const Measured& m) {
    for (const char* other : {"depth", "cut", "adaptive", "error", "filter", "reference", kOnDevice})
        if (m.family.starts_with(other)) return Contest::None;
    const auto sampler = named<Sampler>(m.family);
    return sampler && *sampler != Sampler::Auto ? Contest::Samplers : Contest::Methods;
}

bool beats(const Measured& a, const Measured& b, double tail) {
    if (a.batch != b.batch) return false;
    if (clearlyLess(a.seconds, b.seconds, tail)) return !clearlyMoreExact(b, a, tail);
    return clearlyMoreExact(a, b, tail) && !clearlyLess(b.seconds, a.seconds, tail);
}

void markFront(SceneReport& scene) {
    for (Measured& m : scene.measured) {
        m.isDefault = isDefaultOf(scene, m);
        const Measured* better = contestOf(m) == Contest::None ? nullptr : championAgainst(scene, m);
        m.beatenBy = better == nullptr ? "" : better->key;
    }
}

std::string weaknessOf(const std::string& family) {
    static const std::pair<const char*, const char*> reasons[] = {
        {"triangles: barycentric", "lets rays through at edges and vertices"},
        {"triangles: projection", "lets rays through at edges and vertices"},
        {"triangles: planar3d", "lets rays through at edges and vertices"},
        {"spheres: geometric",
         "takes hits for misses far from a sphere, and wrong points close to a huge one"},
        {"spheres: algebraic",
         "takes hits for misses far from a sphere, and wrong points close to a huge one"},
        {"offset: fixed",
         "lights what lies behind gaps narrower than 1e-4, shades itself far from the origin"},
        {"offset: none", "lets surfaces in one place shade each other"},
        {"slab pad: gamma3", "misses boxes where division is only as exact as Vulkan promises"},
        {"slab pad: none", "misses flat boxes at their edges"},
    };
    for (const auto& [name, reason] : reasons)
        if (family == name) return reason;
    return "";
}

std::string defaultInWords(const SceneReport& scene, Contest contest) {
    std::string on, beaten;
    for (const Measured& m : scene.measured) {
        if (!m.isDefault || contestOf(m) != contest) continue;
        const Measured* by = scene.find(m.beatenBy);
        if (by == nullptr) {
            on += (on.empty() ? "" : ", ") + std::to_string(m.spp);
            continue;
        }
        const std::string weakness = weaknessOf(by->family);
        beaten += (beaten.empty() ? "" : "; ") + ("beaten at " + std::to_string(m.spp)) + " spp by " +
                  nameWithSamples(*by) + " (" + factors(*by, m) + ")";
        if (!weakness.empty()) beaten += ", which is not the default because it " + weakness;
    }
    if (!on.empty()) on = "on the front at " + on + " spp";
    return on + (on.empty() || beaten.empty() ? "" : "; ") + beaten;
}

std::string defaultTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured) {
        if (!m.isDefault) continue;
        const Measured* by = scene.find(m.beatenBy);
        rows += "| " + m.family + " | " + std::to_string(m.spp) + " | " + (by == nullptr ? "yes" : "no");
        rows += " | " + (by == nullptr ? std::string("-") : nameWithSamples(*by)) + " | ";
        rows += (by == nullptr ? std::string("-") : factors(*by, m)) + " | ";
        const std::string weakness = by == nullptr ? "" : weaknessOf(by->family);
        rows += (weakness.empty() ? "-" : weakness) + " |\n";
    }
    if (rows.empty()) return "";
    return "| default | spp | on the front? | beaten by | which has | but |\n|---|---|---|---|---|---|\n" +
           rows;
}

std::string defaultSummary(const Report& data) {
    std::string out =
        "| scene | sampler, spp: on the front? | methods, spp: on the front? |\n|---|---|---|\n";
    for (const SceneReport& scene : data.scenes)
        out += "| " + scene.name + " | " + briefly(scene, Contest::Samplers) + " | " +
               briefly(scene, Contest::Methods) + " |\n";
    return out;
}

}  // namespace glint::report
