#include "bvh/sah.h"

#include <algorithm>
#include <cmath>

namespace glint::sah {

Binning::Binning(const LaneBox& centroids, uint32_t bins) : lo_(centroids.lo.withoutW()), bins_(bins) {
    const glm::vec3 lo = toVec3(centroids.lo), hi = toVec3(centroids.hi);
    for (int axis = 0; axis < 3; ++axis) {
        // 1 - 2^-20: three roundings (here and in bin()) are below 2^-22, so that the greatest centroid stays
        // below `bins`.
        const float scale = static_cast<float>(bins) * (1.0f - 0x1p-20f) / (hi[axis] - lo[axis]);
        scale_[axis] = std::isfinite(scale) ? scale : 0.0f;
    }
}

void BinSet::clear(uint32_t bins) {
    for (int axis = 0; axis < 3; ++axis) {
        std::fill_n(box[axis], bins, LaneBox{});
        std::fill_n(count[axis], bins, 0u);
    }
}

void BinSet::add(const Item* begin, const Item* end, const Binning& binning) {
    alignas(16) int32_t bin[4];
    for (const Item* item = begin; item != end; ++item) {
        binning.bin(item->centroid(), bin);
        const Lanes lo = item->lower(), hi = item->upper();
        for (int axis = 0; axis < 3; ++axis) {
            box[axis][bin[axis]].include(lo, hi);
            ++count[axis][bin[axis]];
        }
    }
}

void BinSet::add(const BinSet& other, uint32_t bins) {
    for (int axis = 0; axis < 3; ++axis) {
        for (uint32_t i = 0; i < bins; ++i) {
            box[axis][i].include(other.box[axis][i]);
            count[axis][i] += other.count[axis][i];
        }
    }
}

Split bestBinnedSplit(const BinSet& set, const Binning& binning, uint32_t count, uint32_t limit) {
    Split best;
    double rightCost[kMaxBins];
    for (int axis = 0; axis < 3; ++axis) {
        if (!binning.usable(axis)) continue;
        const LaneBox* boxes = set.box[axis];
        const uint32_t* counts = set.count[axis];
        LaneBox box;
        uint32_t n = 0;
        for (uint32_t i = binning.bins() - 1; i > 0; --i) {
            box.include(boxes[i]);
            n += counts[i];
            rightCost[i] = n > 0 ? box.halfArea() * n : 0.0;
        }
        box = {};
        n = 0;
        for (uint32_t i = 1; i < binning.bins(); ++i) {
            box.include(boxes[i - 1]);
            n += counts[i - 1];
            if (n == 0 || n == count || n > limit || count - n > limit) continue;
            const double cost = box.halfArea() * n + rightCost[i];
            if (cost < best.cost) best = {cost, axis, i};
        }
    }
    return best;
}

Split bestSortedSplit(const Item* items, uint32_t count, uint32_t limit, const LaneBox& centroids) {
    Split best;
    const glm::vec3 lo = toVec3(centroids.lo), hi = toVec3(centroids.hi);
    for (int axis = 0; axis < 3; ++axis) {
        if (!(hi[axis] > lo[axis])) continue;
        float key[kMaxSorted];
        const Item* sorted[kMaxSorted];
        for (uint32_t i = 0; i < count; ++i) {
            const float k = items[i].centroid(axis);
            uint32_t j = i;
            for (; j > 0 && (key[j - 1] > k || (key[j - 1] == k && sorted[j - 1]->index > items[i].index));
                 --j) {
                key[j] = key[j - 1];
                sorted[j] = sorted[j - 1];
            }
            key[j] = k;
            sorted[j] = &items[i];
        }
        double rightCost[kMaxSorted];
        LaneBox box;
        for (uint32_t i = count - 1; i > 0; --i) {
            box.include(sorted[i]->lower(), sorted[i]->upper());
            rightCost[i] = box.halfArea() * (count - i);
        }
        box = {};
        for (uint32_t i = 1; i < count; ++i) {
            box.include(sorted[i - 1]->lower(), sorted[i - 1]->upper());
            if (i > limit || count - i > limit) continue;
            const double cost = box.halfArea() * i + rightCost[i];
            if (cost < best.cost) best = {cost, axis, i};
        }
    }
    return best;
}

}  // namespace glint::sah
