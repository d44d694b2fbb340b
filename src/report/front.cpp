#include "report/front.h"

#include "report/write.h"
#include "scene/sampling.h"

namespace glint::report {

namespace {

bool clearlyQuicker(const Measured& a, const Measured& b) {
    return a.wall.high < b.wall.low;
}

bool clearlyMoreExact(const Measured& a, const Measured& b) {
    return a.total.rmse + a.total.rmseError < b.total.rmse - b.total.rmseError;
}

const Measured* championAgainst(const SceneReport& scene, const Measured& m) {
    const Measured* best = nullptr;
    for (const Measured& other : scene.measured) {
        if (contestOf(other) != contestOf(m) || !beats(other, m)) continue;
        // More samples are not what sets one method before another.
        if (contestOf(m) == Contest::Methods && other.spp != m.spp) continue;
        const auto cost = [](const Measured& x) { return x.wall.median * x.total.rmse; };
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

// "1.02 x the time, 0.74 x the error".
std::string factors(const Measured& better, const Measured& m) {
    const auto ratio = [](double a, double b) { return b > 0 ? shortNumber(a / b) : std::string("?"); };
    return ratio(better.wall.median, m.wall.median) + " x the time, " +
           ratio(better.total.rmse, m.total.rmse) + " x the error";
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

Contest contestOf(const Measured& m) {
    if (m.family == "depth" || m.family == "cut") return Contest::None;
    const auto sampler = named<Sampler>(m.family);
    return sampler && *sampler != Sampler::Auto ? Contest::Samplers : Contest::Methods;
}

bool beats(const Measured& a, const Measured& b) {
    if (clearlyQuicker(a, b)) return !clearlyMoreExact(b, a);
    return clearlyMoreExact(a, b) && !clearlyQuicker(b, a);
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
        {"fp64 tests", "needs double precision, which many devices lack or have at a fraction of the speed"},
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
    if (!on.empty()) on = "on the front, within the scatter of times and errors, at " + on + " spp";
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
