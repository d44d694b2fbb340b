#include "report/plan.h"

#include <algorithm>
#include <cstdio>

#include "scene/sampling.h"

namespace glint::report {

namespace {

// Samples at which methods are compared: one, where a pixel is one path, and few.
constexpr int kMethodSamples[] = {1, 4};
constexpr int kSweepSamples = 4;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%g", value);
    return text;
}

void addBoth(Configuration c, std::string family, Batch& batch) {
    c.family = std::move(family);
    for (const int spp : kMethodSamples) {
        c.spp = spp;
        batch.configurations.push_back(c);
    }
}

void addMethods(const SceneFeatures& features, bool hasTree, std::optional<gpu::Access> otherAccess,
                Batch& batch) {
    for (const TriangleMethod method :
         {TriangleMethod::Barycentric, TriangleMethod::Projection, TriangleMethod::Planar3d}) {
        Configuration c;
        c.methods.triangles = method;
        if (features.triangles) addBoth(c, "triangles: " + std::string(nameOf(method)), batch);
    }
    for (const SphereMethod method : {SphereMethod::Geometric, SphereMethod::Algebraic}) {
        Configuration c;
        c.methods.spheres = method;
        if (features.spheres) addBoth(c, "spheres: " + std::string(nameOf(method)), batch);
    }
    for (const OriginOffset offset : {OriginOffset::Fixed, OriginOffset::None}) {
        Configuration c;
        c.methods.offsets = offset;
        addBoth(c, "offset: " + std::string(nameOf(offset)), batch);
    }
    for (const SlabPad pad : {SlabPad::Gamma3, SlabPad::None}) {
        Configuration c;
        c.methods.slabs = pad;
        if (hasTree) addBoth(c, "slab pad: " + std::string(nameOf(pad)), batch);
    }
    Configuration full;
    full.leaveOut = false;
    addBoth(full, "nothing left out", batch);
    if (!otherAccess) return;
    Configuration other;
    other.access = otherAccess;
    addBoth(other, *otherAccess == gpu::Access::StorageBuffer ? "storage buffers" : "texel buffers", batch);
}

// 0, 1, 2, ..., past 4 in steps of about a half, and the whole.
std::vector<int> depthsUpTo(int maxDepth) {
    std::vector<int> depths;
    for (int depth = 0; depth < maxDepth; depth = depth < 4 ? depth + 1 : depth + depth / 2)
        depths.push_back(depth);
    depths.push_back(maxDepth);
    return depths;
}

void addSamplers(Batch& batch) {
    for (const int spp : {1, 4, 16, 64}) {
        for (const Sampler sampler : kSamplers) {
            Configuration c;
            c.family = nameOf(sampler);
            c.sampler = sampler;
            c.spp = spp;
            batch.configurations.push_back(c);
        }
    }
}

}  // namespace

std::string keyOf(const Configuration& c) {
    std::string key = std::string(nameOf(c.sampler)) + ' ' + std::to_string(c.spp) + ' ';
    key += std::string(nameOf(c.methods.triangles)) + ' ' + std::string(nameOf(c.methods.spheres)) + ' ';
    key += std::string(nameOf(c.methods.slabs)) + ' ' + std::string(nameOf(c.methods.offsets));
    key += " depth=" + (c.maxDepth ? std::to_string(*c.maxDepth) : std::string("scene"));
    key += " cut=" + number(c.minContribution) + (c.leaveOut ? " pruned" : " full");
    if (c.family == kDefaultAmongMethods) key += " among methods";
    if (c.doublePrecision) key += " fp64";
    if (c.rayByRay) key += " lane";
    if (!c.access) return key + " auto";
    return key + (*c.access == gpu::Access::StorageBuffer ? " storage" : " texel");
}

std::vector<Batch> planScene(const SceneFeatures& features, bool hasTree, int maxDepth,
                             std::optional<gpu::Access> otherAccess, bool float64, bool packets) {
    std::vector<Batch> batches(3);
    addSamplers(batches[0]);
    addBoth({}, kDefaultAmongMethods, batches[1]);
    addMethods(features, hasTree, otherAccess, batches[1]);
    Configuration single;
    single.rayByRay = true;
    if (packets) addBoth(single, "ray by ray", batches[1]);
    Configuration wide;
    wide.doublePrecision = true;
    if (float64 && (features.triangles || features.spheres || features.planes))
        addBoth(wide, "fp64 tests", batches[1]);
    if (!features.mirrors && !features.transmission) return batches;
    for (const int depth : depthsUpTo(maxDepth)) {
        Configuration c;
        c.family = "depth";
        c.spp = kSweepSamples;
        c.maxDepth = depth;
        batches[2].configurations.push_back(c);
    }
    for (const double cut : {1e-4, 1e-3, 1e-2}) {
        Configuration c;
        c.family = "cut";
        c.spp = kSweepSamples;
        c.minContribution = cut;
        batches[2].configurations.push_back(c);
    }
    return batches;
}

const std::vector<std::string>& familyStarts() {
    static const std::vector<std::string> starts = [] {
        std::vector<std::string> list;
        for (const gpu::Access other : {gpu::Access::StorageBuffer, gpu::Access::TexelBuffer}) {
            for (const Batch& batch : planScene(allFeatures(), true, 1, other, true, true)) {
                for (const Configuration& c : batch.configurations) {
                    const std::string start = c.family.substr(0, c.family.find_first_of(" :"));
                    if (std::find(list.begin(), list.end(), start) == list.end()) list.push_back(start);
                }
            }
        }
        return list;
    }();
    return starts;
}

const Measured* SceneReport::find(const std::string& key) const {
    const auto found =
        std::find_if(measured.begin(), measured.end(), [&](const Measured& m) { return m.key == key; });
    return found == measured.end() ? nullptr : &*found;
}

}  // namespace glint::report
