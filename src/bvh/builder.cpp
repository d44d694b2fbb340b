#include "bvh/bvh.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <bitset>
#include <stdexcept>

#include "bvh/sah.h"
#include "core/device_layout.h"
#include "core/parallel.h"

namespace glint {

double Box::halfArea() const {
    if (empty()) return 0.0;
    const glm::dvec3 d = glm::dvec3(hi) - glm::dvec3(lo);
    return d.x * d.y + (d.x + d.y) * d.z;
}

namespace {

using sah::Bounds;
using sah::Item;

// Boxes are read in chunks of this size when many threads treat one range.
constexpr uint32_t kChunk = 65536;
// A range of at most this many boxes, or of a 64th of them all, is built by one thread; none of this depends
// on the number of threads, so neither does the tree.
constexpr uint32_t kMinSubtree = 16384;
// Part of a large tree's build time that the levels above these ranges take.
constexpr double kTopPart = 0.3;

struct Range {
    uint32_t begin = 0, end = 0;
    uint32_t node = 0;   // where its node stands
    uint32_t depth = 0;  // of that node
    Bounds bounds;
    uint32_t count() const { return end - begin; }
};

struct Plan {
    enum class How { Leaf, Bins, Sort, Median, Groups } how = How::Leaf;
    int axis = 0;
    uint32_t position = 0;
};

class Builder {
  public:
    Builder(const std::vector<Box>& boxes, const BvhOptions& options, const Context& context);
    Bvh build();

  private:
    struct Subtree {
        Range root;
        std::vector<BvhNode> nodes;  // nodes[0] is the root
        uint32_t depth = 0;
    };

    void checkOptions(const std::vector<Box>& boxes);
    void readBoxes(const std::vector<Box>& boxes);
    void buildTop(const Range& root, uint32_t subtreeSize, std::vector<Subtree>& subtrees);
    std::vector<Range> splitLevel(const std::vector<Range>& level);
    void buildSubtree(Subtree& subtree);
    void join(std::vector<Subtree>& subtrees);

    uint32_t binsFor(uint32_t count) const;
    // The most boxes of a range that `levels` levels of halving turn into leaves, with the reserve for groups
    // left over.
    uint32_t capacity(uint32_t levels) const;
    bool mixed(const Range& range) const;
    // True if the boxes of the range must not share a leaf, even if they are few.
    bool apart(const Range& range) const;
    Plan plan(const Range& range, const sah::Binning& binning, const sah::BinSet& bins) const;
    void split(const Range& range, const Plan& plan, const sah::Binning& binning, Range& left, Range& right);
    uint32_t partitionBins(const Range& range, const Plan& plan, const sah::Binning& binning, Bounds& left,
                           Bounds& right);
    uint32_t partitionGroups(const Range& range);
    void makeLeaf(const Range& range, BvhNode& node);
    Bounds boundsOf(uint32_t begin, uint32_t end) const;

    BvhOptions options_;
    const Context& context_;
    uint32_t leafCapacity_ = 1;  // boxes that any leaf may hold
    uint32_t groupLevels_ = 0;   // levels that splitting a small range by group may take
    std::vector<Item> items_;
    Range root_;
    Bvh bvh_;
};

Builder::Builder(const std::vector<Box>& boxes, const BvhOptions& options, const Context& context)
    : options_(options), context_(context) {
    checkOptions(boxes);
    readBoxes(boxes);
    bvh_.order.resize(boxes.size());
}

void Builder::checkOptions(const std::vector<Box>& boxes) {
    if (options_.maxLeafSize < 1 || options_.maxLeafSize > shared::kMaxLeafSize)
        throw std::invalid_argument("buildBvh: maxLeafSize must be in [1, 8]");
    if (options_.groups != nullptr && !options_.groups->empty()) {
        if (options_.groups->size() != boxes.size())
            throw std::invalid_argument("buildBvh: there must be one group per box");
        std::bitset<256> present;
        for (const uint8_t g : *options_.groups) present.set(g);
        if (options_.soloGroup >= 256 || !present.test(options_.soloGroup))
            leafCapacity_ = options_.maxLeafSize;
        groupLevels_ = static_cast<uint32_t>(std::bit_width(present.count() - 1));
    } else {
        options_.groups = nullptr;
        leafCapacity_ = options_.maxLeafSize;
    }
    if (boxes.size() > (size_t{1} << 31) || options_.maxLevels < groupLevels_ ||
        capacity(options_.maxLevels) < boxes.size())
        throw std::invalid_argument("buildBvh: too many boxes for maxLevels and maxLeafSize");
}

void Builder::readBoxes(const std::vector<Box>& boxes) {
    items_.resize(boxes.size());
    const size_t chunks = (boxes.size() + kChunk - 1) / kChunk;
    std::vector<Bounds> bounds(chunks);
    parallelFor(context_, chunks, [&](size_t chunk) {
        const size_t end = std::min(boxes.size(), (chunk + 1) * kChunk);
        for (size_t i = chunk * kChunk; i < end; ++i) {
            const Box& b = boxes[i];
            items_[i] = {{b.lo.x, b.lo.y, b.lo.z},
                         static_cast<uint32_t>(i),
                         {b.hi.x, b.hi.y, b.hi.z},
                         options_.groups != nullptr ? (*options_.groups)[i] : 0u};
            bounds[chunk].include(items_[i]);
        }
    });
    root_.end = static_cast<uint32_t>(boxes.size());
    for (const Bounds& b : bounds) root_.bounds.include(b);
}

Bvh Builder::build() {
    std::vector<Subtree> subtrees;
    buildTop(root_, std::max(kMinSubtree, root_.count() / 64), subtrees);
    std::atomic<size_t> done{0};
    const auto build = [&](size_t i) {
        buildSubtree(subtrees[i]);
        context_.report(kTopPart +
                        (1 - kTopPart) * static_cast<double>(++done) / static_cast<double>(subtrees.size()));
    };
    parallelFor(context_, subtrees.size(), build);
    join(subtrees);
    return std::move(bvh_);
}

// Splits level by level until every range is small enough for one thread.
void Builder::buildTop(const Range& root, uint32_t subtreeSize, std::vector<Subtree>& subtrees) {
    bvh_.nodes.resize(1);
    std::vector<Range> level{root};
    while (!level.empty()) {
        const auto small = [&](const Range& r) { return r.count() <= subtreeSize; };
        for (const Range& r : level)
            if (small(r)) subtrees.push_back({r, {}, 0});
        std::erase_if(level, small);
        std::vector<Range> children = splitLevel(level);
        for (size_t i = 0; i < children.size(); ++i) {
            children[i].node = static_cast<uint32_t>(bvh_.nodes.size() + i);
            if (i % 2 == 0)
                bvh_.nodes[level[i / 2].node] = {level[i / 2].bounds.box.box(), children[i].node, 0};
        }
        bvh_.nodes.resize(bvh_.nodes.size() + children.size());
        level = std::move(children);
    }
}

// Splits each of the ranges, all larger than a leaf: child 2i and 2i + 1 are those of range i.
std::vector<Range> Builder::splitLevel(const std::vector<Range>& level) {
    struct Chunk {
        uint32_t range, begin, end;
    };
    std::vector<Chunk> chunks;
    std::vector<sah::Binning> binnings;
    for (uint32_t r = 0; r < level.size(); ++r) {
        binnings.emplace_back(level[r].bounds.centroids, sah::kMaxBins);
        for (uint32_t begin = level[r].begin; begin < level[r].end; begin += kChunk)
            chunks.push_back({r, begin, std::min(level[r].end, begin + kChunk)});
    }
    std::vector<sah::BinSet> sets(chunks.size());
    const auto fill = [&](size_t i) {
        sets[i].clear(sah::kMaxBins);
        sets[i].add(&items_[chunks[i].begin], &items_[chunks[i].end - 1] + 1, binnings[chunks[i].range]);
    };
    parallelFor(context_, chunks.size(), fill);

    std::vector<Range> children(2 * level.size());
    const auto splitOne = [&](size_t r) {
        const auto first = std::lower_bound(chunks.begin(), chunks.end(), r,
                                            [](const Chunk& c, size_t range) { return c.range < range; });
        sah::BinSet& set = sets[static_cast<size_t>(first - chunks.begin())];
        for (auto c = first + 1; c != chunks.end() && c->range == r; ++c)
            set.add(sets[static_cast<size_t>(c - chunks.begin())], sah::kMaxBins);
        split(level[r], plan(level[r], binnings[r], set), binnings[r], children[2 * r], children[2 * r + 1]);
    };
    parallelFor(context_, level.size(), splitOne);
    return children;
}

void Builder::buildSubtree(Subtree& subtree) {
    std::vector<BvhNode>& nodes = subtree.nodes;
    nodes.reserve(subtree.root.count());
    nodes.resize(1);
    std::vector<Range> pending{subtree.root};
    pending.back().node = 0;
    sah::BinSet bins;
    while (!pending.empty()) {
        const Range range = pending.back();
        pending.pop_back();
        subtree.depth = std::max(subtree.depth, range.depth);
        const sah::Binning binning(range.bounds.centroids, binsFor(range.count()));
        if (range.count() > sah::kMaxSorted) {
            bins.clear(binning.bins());
            bins.add(&items_[range.begin], &items_[range.end - 1] + 1, binning);
        }
        const Plan next = plan(range, binning, bins);
        if (next.how == Plan::How::Leaf) {
            makeLeaf(range, nodes[range.node]);
            continue;
        }
        const uint32_t first = static_cast<uint32_t>(nodes.size());
        nodes[range.node] = {range.bounds.box.box(), first, 0};
        nodes.resize(nodes.size() + 2);
        Range left, right;
        split(range, next, binning, left, right);
        left.node = first;
        right.node = first + 1;
        pending.push_back(right);
        pending.push_back(left);
    }
}

// Puts the subtrees' nodes behind those of the top.
void Builder::join(std::vector<Subtree>& subtrees) {
    std::vector<size_t> base(subtrees.size());
    size_t total = bvh_.nodes.size();
    for (size_t i = 0; i < subtrees.size(); ++i) {
        base[i] = total;
        total += subtrees[i].nodes.size() - 1;
        bvh_.depth = std::max(bvh_.depth, subtrees[i].depth);
    }
    bvh_.nodes.resize(total);
    const auto copy = [&](size_t s) {
        std::vector<BvhNode>& nodes = subtrees[s].nodes;
        for (size_t i = 0; i < nodes.size(); ++i) {
            // Nodes 1.. of the subtree stand at base.., its root where its parent expects it.
            if (nodes[i].count == 0) nodes[i].first += static_cast<uint32_t>(base[s] - 1);
            bvh_.nodes[i == 0 ? subtrees[s].root.node : base[s] + i - 1] = nodes[i];
        }
        nodes = {};
    };
    parallelFor(context_, subtrees.size(), copy);
}

// Fewer bins for few boxes: measured like kMaxSorted, trees that cost 0.1 % more in 10 % less time.
uint32_t Builder::binsFor(uint32_t count) const {
    return std::min(sah::kMaxBins, std::max(4u, count / 2));
}

uint32_t Builder::capacity(uint32_t levels) const {
    const uint32_t halvings = levels > groupLevels_ ? levels - groupLevels_ : 0;
    return halvings >= 28 ? 0x80000000u : leafCapacity_ << halvings;
}

bool Builder::mixed(const Range& range) const {
    for (uint32_t i = range.begin + 1; i < range.end; ++i)
        if (items_[i].group != items_[range.begin].group) return true;
    return false;
}

bool Builder::apart(const Range& range) const {
    if (leafCapacity_ == options_.maxLeafSize || range.count() == 1) return false;
    return std::any_of(items_.begin() + range.begin, items_.begin() + range.end,
                       [&](const Item& item) { return item.group == options_.soloGroup; });
}

// Keeps count <= capacity(levels left), so that a median split always leads to leaves in time: half of a
// range that capacity(n) admits is admitted by capacity(n - 1). A mixed range of a leaf's size has
// groupLevels_ levels left, enough to halve its groups.
Plan Builder::plan(const Range& range, const sah::Binning& binning, const sah::BinSet& bins) const {
    const uint32_t count = range.count();
    const bool small = count <= options_.maxLeafSize && !apart(range);
    if (small && mixed(range)) return {Plan::How::Groups};
    const uint32_t levels = options_.maxLevels - range.depth;
    if (count == 1 || (small && levels == 0)) return {Plan::How::Leaf};

    const glm::vec3 extent = toVec3(range.bounds.centroids.hi - range.bounds.centroids.lo);
    const int widest = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    const Plan fallback{small ? Plan::How::Leaf : Plan::How::Median, widest};
    // Boxes on one line have no area, so the heuristic cannot compare splits.
    const double area = range.bounds.box.halfArea();
    if (!(area > 0)) return fallback;

    const uint32_t limit = capacity(levels - 1);
    const bool sorted = count <= sah::kMaxSorted;
    const sah::Split best =
        sorted ? sah::bestSortedSplit(&items_[range.begin], count, limit, range.bounds.centroids)
               : sah::bestBinnedSplit(bins, binning, count, limit);
    // The leaf costs `count` tests, the node one traversal and the tests of each child by its chance of being
    // hit.
    if (best.axis < 0 || (small && area * count <= area * options_.traversalCost + best.cost))
        return fallback;
    return {sorted ? Plan::How::Sort : Plan::How::Bins, best.axis, best.position};
}

void Builder::split(const Range& range, const Plan& plan, const sah::Binning& binning, Range& left,
                    Range& right) {
    left.depth = right.depth = range.depth + 1;
    left.begin = range.begin;
    right.end = range.end;
    const auto begin = items_.begin() + range.begin, end = items_.begin() + range.end;
    // Ties by index make this a total order, so that the two parts do not depend on the items' order so far.
    const auto before = [axis = plan.axis](const Item& a, const Item& b) {
        const float ca = a.centroid(axis), cb = b.centroid(axis);
        return ca < cb || (ca == cb && a.index < b.index);
    };
    uint32_t middle = range.begin + range.count() / 2;
    switch (plan.how) {
        case Plan::How::Bins:
            middle = partitionBins(range, plan, binning, left.bounds, right.bounds);
            break;
        case Plan::How::Sort:
            std::sort(begin, end, before);
            middle = range.begin + plan.position;
            break;
        case Plan::How::Groups:
            middle = partitionGroups(range);
            break;
        case Plan::How::Median:
            std::nth_element(begin, items_.begin() + middle, end, before);
            break;
        case Plan::How::Leaf:
            break;
    }
    left.end = right.begin = middle;
    if (plan.how != Plan::How::Bins) {
        left.bounds = boundsOf(left.begin, left.end);
        right.bounds = boundsOf(right.begin, right.end);
    }
}

uint32_t Builder::partitionBins(const Range& range, const Plan& plan, const sah::Binning& binning,
                                Bounds& left, Bounds& right) {
    alignas(16) int32_t bin[4];
    const int32_t firstRight = static_cast<int32_t>(plan.position);
    uint32_t i = range.begin, j = range.end;
    while (true) {
        for (; i < j; ++i) {
            const Lanes centroid = items_[i].centroid();
            binning.bin(centroid, bin);
            if (bin[plan.axis] >= firstRight) break;
            left.include(items_[i], centroid);
        }
        for (; i < j; --j) {
            const Lanes centroid = items_[j - 1].centroid();
            binning.bin(centroid, bin);
            if (bin[plan.axis] < firstRight) break;
            right.include(items_[j - 1], centroid);
        }
        if (i == j) return i;
        std::swap(items_[i], items_[j - 1]);
        left.include(items_[i++]);
        right.include(items_[--j]);
    }
}

// Half of the groups to the left; a leaf's worth of items.
uint32_t Builder::partitionGroups(const Range& range) {
    const auto begin = items_.begin() + range.begin, end = items_.begin() + range.end;
    std::bitset<256> present;
    for (auto i = begin; i != end; ++i) present.set(i->group);
    size_t keep = present.count() / 2;
    uint32_t firstRight = 0;
    for (; keep > 0 || !present.test(firstRight); ++firstRight)
        if (present.test(firstRight)) --keep;
    const auto middle = std::partition(begin, end, [&](const Item& item) { return item.group < firstRight; });
    return static_cast<uint32_t>(middle - items_.begin());
}

void Builder::makeLeaf(const Range& range, BvhNode& node) {
    node = {range.bounds.box.box(), range.begin, range.count()};
    const auto order = bvh_.order.begin();
    for (uint32_t i = range.begin; i < range.end; ++i) order[i] = items_[i].index;
    std::sort(order + range.begin, order + range.end);
}

Bounds Builder::boundsOf(uint32_t begin, uint32_t end) const {
    Bounds bounds;
    for (uint32_t i = begin; i < end; ++i) bounds.include(items_[i]);
    return bounds;
}

}  // namespace

Bvh buildBvh(const std::vector<Box>& boxes, const BvhOptions& options, const Context& context) {
    if (boxes.empty()) return {};
    return Builder(boxes, options, context).build();
}

}  // namespace glint
