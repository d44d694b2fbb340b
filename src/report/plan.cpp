#include "report/plan.h"

#include <algorithm>
#include <cstdio>

#include "scene/sampling.h"

namespace glint::report {

namespace {

constexpr int kSweepSamples = 4;
constexpr int kTwins = 9;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%g", value);
    return text;
}

void add(Configuration c, std::string family, int spp, Batch& batch) {
    c.family = std::move(family);
    c.spp = spp;
    batch.configurations.push_back(std::move(c));
}

void addMethods(const SceneFeatures& features, bool hasTree, std::optional<gpu::Access> otherAccess, int spp,
                Batch& batch) {
    for (const TriangleMethod method :
         {TriangleMethod::Barycentric, TriangleMethod::Projection, TriangleMethod::Planar3d}) {
        Configuration c;
        c.methods.triangles = method;
        if (features.triangles) add(c, "triangles: " + std::string(nameOf(method)), spp, batch);
    }
    for (const SphereMethod method : {SphereMethod::Geometric, SphereMethod::Algebraic}) {
        Configuration c;
        c.methods.spheres = method;
        if (features.spheres) add(c, "spheres: " + std::string(nameOf(method)), spp, batch);
    }
    for (const OriginOffset offset : {OriginOffset::Fixed, OriginOffset::None}) {
        Configuration c;
        c.methods.offsets = offset;
        add(c, "offset: " + std::string(nameOf(offset)), spp, batch);
    }
    for (const SlabPad pad : {SlabPad::Gamma3, SlabPad::None}) {
        Configuration c;
        c.methods.slabs = pad;
        if (hasTree) add(c, "slab pad: " + std::string(nameOf(pad)), spp, batch);
    }
    Configuration full;
    full.leaveOut = false;
    add(full, "nothing left out", spp, batch);
    if (!otherAccess) return;
    Configuration other;
    other.access = otherAccess;
    add(other, *otherAccess == gpu::Access::StorageBuffer ? "storage buffers" : "texel buffers", spp, batch);
}

// 0, 1, 2, ..., past 4 in steps of about a half, and the whole.
std::vector<int> depthsUpTo(int maxDepth) {
    std::vector<int> depths;
    for (int depth = 0; depth < maxDepth; depth = depth < 4 ? depth + 1 : depth + depth / 2)
        depths.push_back(depth);
    depths.push_back(maxDepth);
    return depths;
}

Batch samplersAt(std::initializer_list<int> counts) {
    Batch batch;
    for (const int spp : counts) {
        batch.name += (batch.name.empty() ? "samplers at " : ", ") + std::to_string(spp);
        for (const Sampler sampler : kSamplers) {
            Configuration c;
            c.sampler = sampler;
            add(c, std::string(nameOf(sampler)), spp, batch);
        }
    }
    batch.name += " samples";
    return batch;
}

// The same picture in other ways: by contrast, to an error, by the reference.
Batch otherWays() {
    Batch batch{"adaptive, --error, reference", {}};
    for (const double contrast : {0.2, 0.05}) {
        Configuration c;
        c.contrast = contrast;
        add(c, "adaptive " + number(contrast), 4, batch);
    }
    for (const double error : {0.03, 0.01}) {
        Configuration c;
        c.error = error;
        add(c, "error " + number(error), 1, batch);
    }
    Configuration reference;
    reference.onReference = true;
    add(reference, "reference", 4, batch);
    return batch;
}

// As a user takes them, at their own radius.
Batch filters() {
    Batch batch{"filters", {}};
    for (const Filter filter : {Filter::Tent, Filter::Gaussian, Filter::Mitchell}) {
        Configuration c;
        c.filter = filter;
        add(c, "filter " + std::string(nameOf(filter)), 16, batch);
    }
    return batch;
}

Batch depthsAndCuts(int maxDepth) {
    Batch batch{"depths and cuts", {}};
    for (const int depth : depthsUpTo(maxDepth)) {
        Configuration c;
        c.maxDepth = depth;
        add(c, "depth", kSweepSamples, batch);
    }
    for (const double cut : {1e-4, 1e-3, 1e-2}) {
        Configuration c;
        c.minContribution = cut;
        add(c, "cut", kSweepSamples, batch);
    }
    return batch;
}

// By a sampler whose error falls the same way at all counts, so that the curves differ by their times alone.
Batch devicesAt(std::initializer_list<int> counts, const std::vector<DeviceBeside>& devices) {
    Batch batch{"devices side by side", {}};
    for (const int spp : counts) {
        batch.name += (spp == *counts.begin() ? " at " : ", ") + std::to_string(spp);
        for (const DeviceBeside& beside : devices) {
            Configuration c;
            c.on = beside.label();
            c.onReference = beside.device == nullptr;
            add(c, kOnDevice + beside.name, spp, batch);
        }
    }
    batch.name += " samples";
    return batch;
}

Batch twins() {
    Batch batch{"the default against itself", {}};
    for (int twin = 1; twin <= kTwins + 1; ++twin) {
        Configuration c;
        c.twin = twin;
        add(c, twin > kTwins ? kDefaultAmongMethods : "again " + std::to_string(twin), 1, batch);
    }
    return batch;
}

}  // namespace

std::string keyOf(const Configuration& c) {
    std::string key = std::string(nameOf(c.sampler)) + ' ' + std::to_string(c.spp) + ' ';
    key += std::string(nameOf(c.methods.triangles)) + ' ' + std::string(nameOf(c.methods.spheres)) + ' ';
    key += std::string(nameOf(c.methods.slabs)) + ' ' + std::string(nameOf(c.methods.offsets));
    key += " depth=" + (c.maxDepth ? std::to_string(*c.maxDepth) : std::string("scene"));
    key += " cut=" + number(c.minContribution) + (c.leaveOut ? " pruned" : " full");
    if (c.family == kDefaultAmongMethods) key += " among methods";
    if (c.rayByRay) key += " lane";
    if (c.error) key += " error=" + number(*c.error);
    if (c.contrast) key += " contrast=" + number(*c.contrast);
    if (c.filter) key += " filter=" + std::string(nameOf(*c.filter));
    if (c.onReference) key += " reference";
    if (!c.on.empty()) key += " on " + c.on;
    if (c.twin > 0) key += " again=" + std::to_string(c.twin);
    if (!c.access) return key + " auto";
    return key + (*c.access == gpu::Access::StorageBuffer ? " storage" : " texel");
}

Configuration machineKind(Configuration c) {
    c.family.clear();
    c.sampler = Sampler::Grid;
    c.spp = 1;
    c.maxDepth.reset();
    c.methods = {};
    c.minContribution = 0;
    c.error.reset();
    c.contrast.reset();
    c.filter.reset();
    c.twin = 0;
    return c;
}

bool isJudgedAlone(const Configuration& c) {
    constexpr int kMostSamples = 4;
    return !c.error && !c.contrast && !c.filter && !c.onReference && c.spp <= kMostSamples;
}

std::vector<Batch> planScene(const SceneFeatures& features, bool hasTree, int maxDepth,
                             std::optional<gpu::Access> otherAccess, bool packets,
                             const std::vector<DeviceBeside>& devices) {
    const auto methodsAt = [&](int spp) {
        Batch batch{"methods at " + std::to_string(spp) + (spp == 1 ? " sample" : " samples"), {}};
        add({}, kDefaultAmongMethods, spp, batch);
        addMethods(features, hasTree, otherAccess, spp, batch);
        Configuration single;
        single.rayByRay = true;
        if (packets) add(single, "ray by ray", spp, batch);
        return batch;
    };
    std::vector<Batch> batches{samplersAt({1, 4, 16})};
    if (!devices.empty()) {
        batches.push_back(devicesAt({1, 4}, devices));
        batches.push_back(devicesAt({16}, devices));
    }
    batches.push_back(methodsAt(1));
    if (features.mirrors || features.transmission) batches.push_back(depthsAndCuts(maxDepth));
    batches.push_back(otherWays());
    batches.push_back(filters());
    batches.push_back(samplersAt({64}));
    batches.push_back(methodsAt(4));
    batches.push_back(methodsAt(16));
    batches.push_back(samplersAt({256}));
    batches.push_back(samplersAt({1024}));
    batches.push_back(twins());
    return batches;
}

const std::vector<std::string>& familyStarts() {
    static const std::vector<std::string> starts = [] {
        std::vector<std::string> list;
        for (const gpu::Access other : {gpu::Access::StorageBuffer, gpu::Access::TexelBuffer}) {
            for (const Batch& batch : planScene(allFeatures(), true, 1, other, true, {{"cpu", "", nullptr}})) {
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
