#include "bvh/wide_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "bvh/collapse.h"

namespace glint {
namespace {

constexpr uint32_t kEight = 8;
constexpr double kLastStep = 255;
// Exponents of float, biased. No product of a step and a byte is denormal, which a device may take for 0.
constexpr int kExponentBias = 127;
constexpr int kLeastExponent = 1, kGreatestExponent = 254;

uint32_t bitsOf(float x) {
    return std::bit_cast<uint32_t>(x);
}

// Wide nodes that are still to be written, depth first, so that a subtree lies together.
template <uint32_t kWidth>
class Layout {
  public:
    Layout(const std::vector<shared::Node>& nodes, std::span<const shared::Instance> instances,
           WideTree& tree)
        : collapse_(nodes) {
        std::unordered_map<uint32_t, uint32_t> placed;
        const auto place = [&](uint32_t root) {
            const auto [entry, isNew] = placed.try_emplace(root, places_);
            if (isNew) pending_.push_back({root, places_++});
            return entry->second;
        };
        place(0);
        for (const shared::Instance& instance : instances) tree.roots.push_back(place(instance.root));
    }

    using Wide = typename Collapse<kWidth>::Wide;
    // Calls write(place, children) for each node. `arrange` may reorder children and leave gaps, of kNone;
    // inner ones are numbered in a row.
    template <typename Arrange, typename Write>
    void forEach(const Arrange& arrange, const Write& write) {
        while (!pending_.empty()) {
            const auto [node, place] = pending_.back();
            pending_.pop_back();
            Wide wide = arrange(collapse_.childrenOf(node));
            for (auto& child : wide.children) {
                if (child.child == shared::kNone || !isInnerChild(child.child)) continue;
                pending_.push_back({child.child, places_});
                child.child = places_++;
            }
            write(place, wide);
        }
    }
    uint32_t places() const { return places_; }

  private:
    Collapse<kWidth> collapse_;
    std::vector<std::pair<uint32_t, uint32_t>> pending_;  // node of the binary tree, place
    uint32_t places_ = 0;
};

shared::WideRow& rowOf(WideTree& tree, size_t rowsOfNode, uint32_t place, size_t row) {
    const size_t index = rowsOfNode * place + row;
    if (tree.rows.size() <= index) tree.rows.resize(rowsOfNode * (place + 1));
    return tree.rows[index];
}

using Eight = Layout<kEight>::Wide;

template <typename Wide>
Box around(const Wide& wide) {
    Box box;
    for (const auto& c : wide.children) {
        if (c.child != shared::kNone) box.include(c.box);
    }
    return box;
}

// Children to slots so that the sum, over children, of how far each lies towards its slot's corner is large:
// by exchanges of two slots as long as one pays. The paper finds the largest sum, by an auction.
Eight arranged(const Eight& wide) {
    constexpr int kMostPasses = 8;
    const Box box = around(wide);
    const glm::dvec3 twiceCenter = glm::dvec3(box.lo) + glm::dvec3(box.hi);
    std::array<std::array<double, kEight>, kEight> gain{};  // of child and slot
    for (uint32_t c = 0; c < wide.count; ++c) {
        const glm::dvec3 away =
            glm::dvec3(wide.children[c].box.lo) + glm::dvec3(wide.children[c].box.hi) - twiceCenter;
        for (uint32_t s = 0; s < kEight; ++s)
            gain[c][s] = (s & 1 ? away.x : -away.x) + (s & 2 ? away.y : -away.y) + (s & 4 ? away.z : -away.z);
    }
    std::array<uint32_t, kEight> childOf = {0, 1, 2, 3,
                                            4, 5, 6, 7};  // from wide.count on: none, without gain
    bool better = true;
    for (int pass = 0; better && pass < kMostPasses; ++pass) {
        better = false;
        for (uint32_t s = 0; s < kEight; ++s) {
            for (uint32_t t = s + 1; t < kEight; ++t) {
                const auto &a = gain[childOf[s]], &b = gain[childOf[t]];
                if (!(a[t] + b[s] > a[s] + b[t])) continue;
                std::swap(childOf[s], childOf[t]);
                better = true;
            }
        }
    }
    Eight result;
    result.count = kEight;
    for (uint32_t s = 0; s < kEight; ++s) {
        if (childOf[s] < wide.count) result.children[s] = wide.children[childOf[s]];
    }
    return result;
}

// The grid of a node along one axis.
struct Grid {
    float origin = 0;
    int exponent = kLeastExponent;
    std::array<uint8_t, kEight> lo{}, hi{};

    float step() const { return std::ldexp(1.0f, exponent - kExponentBias); }
    // As planesOf in shaders/wide_nodes.glsl: the product is exact.
    float plane(double steps) const { return static_cast<float>(steps) * step() + origin; }
    double stepsTo(float x) const { return (double(x) - origin) / step(); }
    // The last plane not above x, and the first not below it; beyond 255 there is none.
    double below(float x) const {
        double steps = std::clamp(std::floor(stepsTo(x)), 0.0, kLastStep);
        while (steps > 0 && plane(steps) > x) --steps;
        return steps;
    }
    double above(float x) const {
        double steps = std::max(std::ceil(stepsTo(x)), 0.0);
        while (steps <= kLastStep && plane(steps) < x) ++steps;
        return steps;
    }
};

// False if the grid's planes do not enclose all children.
bool fill(Grid& grid, const Eight& wide, int axis) {
    for (uint32_t i = 0; i < kEight; ++i) {
        if (wide.children[i].child == shared::kNone) continue;
        const double hi = grid.above(wide.children[i].box.hi[axis]);
        if (hi > kLastStep) return false;
        grid.lo[i] = static_cast<uint8_t>(grid.below(wide.children[i].box.lo[axis]));
        grid.hi[i] = static_cast<uint8_t>(hi);
    }
    return true;
}

// The finest grid of powers of two that encloses the children.
Grid gridOf(const Eight& wide, int axis) {
    const Box box = around(wide);
    Grid grid;
    grid.origin = box.lo[axis];
    // What a device may take for 0 moves down, not up.
    if (std::abs(grid.origin) < std::numeric_limits<float>::min())
        grid.origin = grid.origin < 0 ? -std::numeric_limits<float>::min() : 0.0f;
    const double extent = double(box.hi[axis]) - grid.origin;
    const int exponent = extent > 0 ? static_cast<int>(std::ceil(std::log2(extent / kLastStep))) : 0;
    grid.exponent = std::clamp(exponent + kExponentBias, kLeastExponent, kGreatestExponent);
    while (!fill(grid, wide, axis) && grid.exponent < kGreatestExponent) ++grid.exponent;
    return grid;
}

uint32_t fourBytes(const uint8_t* bytes) {
    return bytes[0] | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
}

using Four = Layout<4>::Wide;

// The grid of a node of four along one axis. The device takes planes for off by up to 511 / 512 of `slack`,
// and else by as much as those that are floats (meetAxisOfFour in shaders/wide_nodes.glsl).
struct GridOfFour {
    float origin = 0;
    int exponent = 0;  // of 256 steps, biased
    std::array<uint8_t, 4> lo{}, hi{};

    double step() const { return std::ldexp(1.0, exponent - kExponentBias - 8); }
    double slack() const { return std::ldexp(step(), -15); }
    // Exact, since steps are not much finer than the origin (gridOfFour).
    double plane(double steps) const { return origin + (256 + steps) * step(); }
    double below(float x) const {
        double steps = std::min(std::ceil((x - plane(0)) / step()), kLastStep);
        while (steps >= 0 && plane(steps) + slack() > x) --steps;
        return steps;
    }
    double above(float x) const {
        double steps = std::max(std::floor((x - plane(0)) / step()), 0.0);
        while (steps <= kLastStep && plane(steps) - slack() < x) ++steps;
        return steps;
    }
};

bool fill(GridOfFour& grid, const Four& wide, int axis) {
    for (size_t i = 0; i < wide.children.size(); ++i) {
        if (wide.children[i].child == shared::kNone) continue;
        const double lo = grid.below(wide.children[i].box.lo[axis]);
        const double hi = grid.above(wide.children[i].box.hi[axis]);
        if (lo < 0 || hi > kLastStep) return false;
        grid.lo[i] = static_cast<uint8_t>(lo);
        grid.hi[i] = static_cast<uint8_t>(hi);
    }
    return true;
}

// The finest that encloses the children, of steps of at least 2^-100, so that what a device may take for 0 is
// far less than the slack, and of 2^-30 of the coordinates.
GridOfFour gridOfFour(const Four& wide, int axis) {
    const Box box = around(wide);
    const double size = std::max(std::abs(double(box.lo[axis])), std::abs(double(box.hi[axis])));
    const double step = std::max(
        {(double(box.hi[axis]) - box.lo[axis]) / kLastStep, std::ldexp(size, -30), std::ldexp(1.0, -100)});
    GridOfFour grid;
    grid.exponent = static_cast<int>(std::ceil(std::log2(step))) + 8 + kExponentBias;
    for (;; ++grid.exponent) {
        grid.origin = static_cast<float>(box.lo[axis] - grid.slack() - 256 * grid.step());
        if (std::abs(grid.origin) < std::numeric_limits<float>::min())
            grid.origin = -std::numeric_limits<float>::min();
        while (grid.plane(0) + grid.slack() > box.lo[axis])
            grid.origin = std::nextafter(grid.origin, -std::numeric_limits<float>::infinity());
        if (fill(grid, wide, axis) || grid.exponent >= kGreatestExponent) return grid;
    }
}

// Inner ones first, whose numbers follow each other.
Four innerFirst(Four wide) {
    std::stable_partition(wide.children.begin(), wide.children.begin() + wide.count,
                          [](const auto& child) { return isInnerChild(child.child); });
    return wide;
}

// Children come first, so at most places 1 to 3 are empty.
void writeFour(WideTree& tree, uint32_t place, const Four& wide) {
    const std::array<GridOfFour, 3> grids = {gridOfFour(wide, 0), gridOfFour(wide, 1), gridOfFour(wide, 2)};
    const auto& c = wide.children;
    const auto absent = [&](size_t i) { return c[i].child == shared::kNone ? ~0u : 0u; };
    uint32_t head = absent(1) << 31;
    uint32_t links = absent(3) << 31;
    for (size_t i = 0; i < c.size(); ++i)
        if (c[i].child != shared::kNone && isInnerChild(c[i].child))
            links |= 1u << (shared::kFourInnerShift + i) | c[0].child;
    std::array<uint32_t, 3> lo{}, hi{};
    for (size_t axis = 0; axis < 3; ++axis) {
        head |= static_cast<uint32_t>(grids[axis].exponent) << 8 * axis;
        lo[axis] = fourBytes(grids[axis].lo.data());
        hi[axis] = fourBytes(grids[axis].hi.data());
    }
    const auto row = [&](size_t i) -> shared::WideRow& { return rowOf(tree, shared::kFourRows, place, i); };
    row(0) = {bitsOf(grids[0].origin), bitsOf(grids[1].origin), bitsOf(grids[2].origin), head};
    row(1) = {lo[0], hi[0], lo[1], hi[1]};
    row(2) = {lo[2], hi[2], absent(2), links};
    row(3) = {c[0].child, c[1].child, c[2].child, c[3].child};
}

WideTree fourTree(const std::vector<shared::Node>& nodes, std::span<const shared::Instance> instances) {
    WideTree tree;
    Layout<4> layout(nodes, instances, tree);
    layout.forEach(innerFirst, [&](uint32_t place, const Four& wide) { writeFour(tree, place, wide); });
    return tree;
}

void writeCompressed(WideTree& tree, uint32_t place, const Eight& wide, std::vector<uint32_t>& leaves) {
    uint32_t nodeSlots = 0, leafSlots = 0, firstNode = 0;
    const auto firstLeaf = static_cast<uint32_t>(leaves.size());
    for (uint32_t i = kEight; i-- > 0;) {
        const uint32_t child = wide.children[i].child;
        if (child == shared::kNone) continue;
        (isInnerChild(child) ? nodeSlots : leafSlots) |= 1u << i;
        if (isInnerChild(child)) firstNode = child;
    }
    for (const auto& c : wide.children) {
        if (c.child != shared::kNone && !isInnerChild(c.child)) leaves.push_back(c.child);
    }
    const std::array<Grid, 3> grids = {gridOf(wide, 0), gridOf(wide, 1), gridOf(wide, 2)};
    uint32_t head = nodeSlots << 24;
    for (size_t axis = 0; axis < 3; ++axis) {
        const Grid& grid = grids[axis];
        head |= static_cast<uint32_t>(grid.exponent) << 8 * axis;
        rowOf(tree, shared::kCompressedRows, place, 2 + axis) = {
            fourBytes(grid.lo.data()), fourBytes(&grid.lo[4]), fourBytes(grid.hi.data()),
            fourBytes(&grid.hi[4])};
    }
    rowOf(tree, shared::kCompressedRows, place, 0) = {bitsOf(grids[0].origin), bitsOf(grids[1].origin),
                                                      bitsOf(grids[2].origin), head};
    rowOf(tree, shared::kCompressedRows, place, 1) = {firstNode, firstLeaf, leafSlots, 0};
}

WideTree compressedTree(const std::vector<shared::Node>& nodes, std::span<const shared::Instance> instances) {
    WideTree tree;
    std::vector<uint32_t> leaves;
    Layout<kEight> layout(nodes, instances, tree);
    layout.forEach(arranged,
                   [&](uint32_t place, const Eight& wide) { writeCompressed(tree, place, wide, leaves); });
    const size_t nodeRows = size_t{layout.places()} * shared::kCompressedRows;
    tree.rows.resize(nodeRows + (leaves.size() + 3) / 4);
    for (uint32_t place = 0; place < layout.places(); ++place)
        rowOf(tree, shared::kCompressedRows, place, 1).y += static_cast<uint32_t>(4 * nodeRows);
    for (size_t i = 0; i < leaves.size(); ++i) {
        shared::WideRow& row = tree.rows[nodeRows + i / 4];
        (i % 4 == 0 ? row.x : i % 4 == 1 ? row.y : i % 4 == 2 ? row.z : row.w) = leaves[i];
    }
    return tree;
}

}  // namespace

WideTree wideTree(const std::vector<shared::Node>& nodes, NodeFormat format,
                  std::span<const shared::Instance> instances) {
    if (nodes.empty() || format == NodeFormat::Two) return {};
    return format == NodeFormat::Four ? fourTree(nodes, instances) : compressedTree(nodes, instances);
}

}  // namespace glint
