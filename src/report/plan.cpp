#include "report/plan.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/image_diff.h"

namespace glint::report {

namespace {

class Plan {
  public:
    void add(Setting setting, std::string family, int spp) {
        setting.family = std::move(family);
        setting.spp = spp;
        settings.push_back(std::move(setting));
    }

    void addSamplers(std::initializer_list<int> counts) {
        for (const int spp : counts)
            for (const Sampler sampler : kSamplers) {
                Setting s;
                s.sampler = sampler;
                add(s, std::string(nameOf(sampler)), spp);
            }
    }

    // One sampler for all, so that the curves differ only in time.
    void addDevices(std::initializer_list<int> counts, const std::vector<DeviceBeside>& devices) {
        for (const int spp : counts)
            for (const DeviceBeside& beside : devices) {
                Setting s;
                s.on = beside.label();
                s.onReference = beside.device == nullptr;
                add(s, kOnDevice + beside.name, spp);
            }
    }

    template <typename Method>
    void addMethods(const char* name, std::initializer_list<Method> values, Method Methods::*member) {
        for (const Method value : values) {
            Setting s;
            s.methods.*member = value;
            add(s, std::string(name) + ": " + std::string(nameOf(value)), 1);
        }
    }

    // 0, 1, 2, ..., past 4 in steps of about a half, and the scene's own depth.
    void addDepths(int sceneDepth) {
        for (int depth = 0;; depth = std::min(sceneDepth, depth < 4 ? depth + 1 : depth + depth / 2)) {
            Setting s;
            s.limits.depth = static_cast<uint32_t>(depth);
            add(s, "depth", 4);
            if (depth >= sceneDepth) break;
        }
        for (const double cut : {1e-4, 1e-3, 1e-2}) {
            Setting s;
            s.limits.minContribution = cut;
            add(s, "cut", 4);
        }
    }

    void addOtherWays() {
        for (const double contrast : {0.2, 0.05}) {
            Setting s;
            s.contrast = contrast;
            add(s, "adaptive " + format("%g", contrast), 4);
        }
        for (const double error : {0.03, 0.01}) {
            Setting s;
            s.error = error;
            add(s, "error " + format("%g", error), 1);
        }
        Setting reference;
        reference.onReference = true;
        add(reference, "reference", 4);
    }

    std::vector<Setting> settings;
};

}  // namespace

std::string keyOf(const Setting& s) {
    std::string key = s.on.empty() ? s.family : kOnDevice + s.on;
    if (s.limits.depth) key += format(" %u", *s.limits.depth);
    if (s.limits.minContribution > 0) key += format(" %g", s.limits.minContribution);
    return key + ", " + std::to_string(s.spp) + " spp";
}

bool hasArithmetic(const Setting& s) {
    constexpr int kMostSamples = 4;
    return !s.error && !s.contrast && !s.onReference && s.spp <= kMostSamples;
}

std::vector<Setting> planScene(const SceneFeatures& features, bool hasTree, int sceneDepth,
                               const std::vector<DeviceBeside>& devices) {
    Plan plan;
    plan.addSamplers({1, 4, 16});
    plan.addDevices({1, 4, 16}, devices);
    plan.addSamplers({64, 256});
    plan.add({}, kDefaultMethods, 1);
    if (features.triangles)
        plan.addMethods("triangles",
                        {TriangleMethod::Barycentric, TriangleMethod::Projection, TriangleMethod::Planar3d},
                        &Methods::triangles);
    if (features.spheres)
        plan.addMethods("spheres", {SphereMethod::Geometric, SphereMethod::Algebraic}, &Methods::spheres);
    plan.addMethods("offset", {OriginOffset::Fixed, OriginOffset::None}, &Methods::offsets);
    if (hasTree) plan.addMethods("slab pad", {SlabPad::Gamma3, SlabPad::None}, &Methods::slabs);
    Setting full;
    full.leaveOut = false;
    plan.add(full, "nothing left out", 1);
    if (features.mirrors || features.transmission) plan.addDepths(sceneDepth);
    plan.addOtherWays();
    plan.addSamplers({1024});
    return std::move(plan.settings);
}

const std::vector<std::string>& familyStarts() {
    static const std::vector<std::string> starts = [] {
        std::vector<std::string> list;
        for (const Setting& s : planScene(allFeatures(), true, 1, {{"cpu", "", nullptr}})) {
            const std::string start = s.family.substr(0, s.family.find_first_of(" :"));
            if (std::find(list.begin(), list.end(), start) == list.end()) list.push_back(start);
        }
        return list;
    }();
    return starts;
}

ErrorMeasures measureError(const Image& picture, std::span<const glm::dvec3> truth,
                           std::span<const uint8_t> counts) {
    ErrorMeasures m;
    uint64_t visible = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        if (!counts.empty() && counts[i] == 0) continue;
        const float* pixel = &picture.pixels[i * static_cast<size_t>(picture.channels)];
        const glm::dvec3 d = glm::dvec3(pixel[0], pixel[1], pixel[2]) - truth[i];
        if (!std::isfinite(d.x + d.y + d.z)) {
            ++m.notFinite;
            continue;
        }
        const glm::dvec3 size = glm::abs(d);
        const double largest = std::max({size.x, size.y, size.z});
        ++m.pixels;
        m.rmse += glm::dot(d, d);
        for (int c = 0; c < 3; ++c) m.relMse += d[c] * d[c] / (truth[i][c] * truth[i][c] + kRelativeFloor);
        m.bias += d.x + d.y + d.z;
        m.max = std::max(m.max, largest);
        visible += largest > 1.0 / 255 ? 1 : 0;
    }
    if (m.pixels == 0) return m;
    const double pixels = static_cast<double>(m.pixels);
    m.rmse = std::sqrt(m.rmse / (3 * pixels));
    m.relMse /= 3 * pixels;
    m.bias /= 3 * pixels;
    m.percentVisible = 100 * static_cast<double>(visible) / pixels;
    return m;
}

ArithmeticError measureArithmetic(const Image& picture, std::span<const uint32_t> paths,
                                  std::span<const glm::dvec3> truth, std::span<const uint32_t> truthPaths) {
    std::vector<uint8_t> same(truth.size()), other(truth.size());
    for (size_t i = 0; i < truth.size(); ++i) {
        same[i] = paths[i] == truthPaths[i] ? 1 : 0;
        other[i] = 1 - same[i];
    }
    return {measureError(picture, truth), measureError(picture, truth, same),
            measureError(picture, truth, other)};
}

}  // namespace glint::report
