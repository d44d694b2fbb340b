#include "report/plan.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/image_diff.h"

namespace glint::report {

std::string keyOf(const Setting& s) {
    std::string key = s.family;
    if (s.limits.depth) key += format(" %u", *s.limits.depth);
    if (s.limits.minContribution > 0) key += format(" %g", s.limits.minContribution);
    return key + ", " + std::to_string(s.spp) + " spp";
}

bool hasArithmetic(const Setting& s) {
    constexpr int kMostSamples = 4;
    return !s.error && !s.contrast && !s.onReference && s.spp <= kMostSamples;
}

std::vector<Setting> planScene(const SceneFeatures& features, bool hasTree, int sceneDepth) {
    std::vector<Setting> plan;
    const auto add = [&](const std::string& family, int spp, const auto&... change) {
        Setting& setting = plan.emplace_back();
        setting.family = family;
        setting.spp = spp;
        (change(setting), ...);
    };
    const auto addSamplers = [&](std::initializer_list<int> counts) {
        for (const int spp : counts)
            for (const Sampler sampler : kSamplers)
                add(std::string(nameOf(sampler)), spp, [&](Setting& s) { s.sampler = sampler; });
    };
    const auto addMethods = [&]<typename Method>(const std::string& name, Method Methods::*member,
                                                 std::initializer_list<Method> values) {
        for (const Method value : values)
            add(name + ": " + std::string(nameOf(value)), 1, [&](Setting& s) { s.methods.*member = value; });
    };
    addSamplers({1, 4, 16, 64, 256});
    add(kDefaultMethods, 1);
    if (features.triangles)
        addMethods("triangles", &Methods::triangles,
                   {TriangleMethod::Barycentric, TriangleMethod::Projection, TriangleMethod::Planar3d});
    if (features.spheres)
        addMethods("spheres", &Methods::spheres, {SphereMethod::Geometric, SphereMethod::Algebraic});
    addMethods("offset", &Methods::offsets, {OriginOffset::Fixed, OriginOffset::None});
    if (hasTree) addMethods("slab pad", &Methods::slabs, {SlabPad::Gamma3, SlabPad::None});
    add("nothing left out", 1, [](Setting& s) { s.leaveOut = false; });
    if (features.mirrors || features.transmission) {
        // 0, 1, 2, ..., past 4 in steps of about a half, and the scene's own depth.
        for (int depth = 0;; depth = std::min(sceneDepth, depth < 4 ? depth + 1 : depth + depth / 2)) {
            add("depth", 4, [&](Setting& s) { s.limits.depth = static_cast<uint32_t>(depth); });
            if (depth >= sceneDepth) break;
        }
        for (const double cut : {1e-4, 1e-3, 1e-2})
            add("cut", 4, [&](Setting& s) { s.limits.minContribution = cut; });
    }
    for (const double contrast : {0.2, 0.05})
        add("adaptive " + format("%g", contrast), 4, [&](Setting& s) { s.contrast = contrast; });
    for (const double error : {0.03, 0.01})
        add("error " + format("%g", error), 1, [&](Setting& s) { s.error = error; });
    add("reference", 4, [](Setting& s) { s.onReference = true; });
    addSamplers({1024});
    return plan;
}

const std::vector<std::string>& familyStarts() {
    static const std::vector<std::string> starts = [] {
        std::vector<std::string> list;
        for (const Setting& s : planScene(allFeatures(), true, 1)) {
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
