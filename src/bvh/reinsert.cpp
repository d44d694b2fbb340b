#include "bvh/reinsert.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kChunk = 512;  // searches that one thread makes at a time
constexpr uint32_t kRoot = 0;

// Children stand side by side: 1 and 2, 3 and 4, ...
uint32_t siblingOf(uint32_t node) {
    return ((node - 1) ^ 1u) + 1;
}

Box joined(Box a, const Box& b) {
    a.include(b);
    return a;
}

struct Move {
    uint32_t from = 0;
    uint32_t to = kRoot;  // kRoot: stay
    double gain = 0;      // by which the sum of half areas falls
};

class Optimizer {
  public:
    Optimizer(Bvh& bvh, const ReinsertionOptions& options, const Context& context)
        : bvh_(bvh), options_(options), context_(context) {
        findParents();
    }

    void run();

  private:
    std::vector<BvhNode>& nodes() { return bvh_.nodes; }
    bool leaf(uint32_t node) const { return bvh_.nodes[node].count > 0; }
    double area(uint32_t node) const { return bvh_.nodes[node].box.halfArea(); }

    void findParents();
    std::vector<uint32_t> largest() const;
    Move bestMove(uint32_t from) const;
    void search(uint32_t start, double gained, const Box& box, double ownArea, Move& best) const;
    bool conflicts(const Move& move) const;
    bool below(uint32_t node, uint32_t ancestor) const;
    void mark(const Move& move);
    void visitTouched(const Move& move, uint32_t (&touched)[5]) const;
    void apply(const Move& move);
    void refit(uint32_t node);
    uint32_t depth() const;
    double areas() const;  // sum over inner nodes: the leaves' never changes

    Bvh& bvh_;
    const ReinsertionOptions& options_;
    const Context& context_;
    std::vector<uint32_t> parents_;
    std::vector<uint8_t> touched_;
};

void Optimizer::findParents() {
    parents_.assign(bvh_.nodes.size(), kRoot);
    for (uint32_t i = 0; i < bvh_.nodes.size(); ++i)
        if (!leaf(i)) parents_[bvh_.nodes[i].first] = parents_[bvh_.nodes[i].first + 1] = i;
}

// The nodes with the greatest areas; their place counts most. Not the root and its children, which have no
// other.
std::vector<uint32_t> Optimizer::largest() const {
    std::vector<uint32_t> candidates;
    for (uint32_t i = 1; i < bvh_.nodes.size(); ++i)
        if (parents_[i] != kRoot) candidates.push_back(i);
    std::vector<double> areas(bvh_.nodes.size());
    for (const uint32_t i : candidates) areas[i] = area(i);
    const auto wanted = static_cast<size_t>(options_.batch * static_cast<double>(bvh_.nodes.size()));
    const size_t count = std::min(candidates.size(), std::max<size_t>(wanted, 1));
    const auto larger = [&](uint32_t a, uint32_t b) {
        return areas[a] > areas[b] || (areas[a] == areas[b] && a < b);
    };
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                      candidates.end(), larger);
    candidates.resize(count);
    return candidates;
}

// Looks below `start` for the place where a new parent of that place's node and the moved box costs least.
// `gained`: what the sum has gained so far on the way there; every node that is descended through grows by
// the moved box.
void Optimizer::search(uint32_t start, double gained, const Box& box, double ownArea, Move& best) const {
    struct Entry {
        double gained;
        uint32_t node;
    };
    Entry stack[128];
    uint32_t top = 0;
    stack[top++] = {gained, start};
    while (top > 0) {
        const Entry entry = stack[--top];
        // A new parent is no smaller than the box that it gets.
        if (entry.gained - ownArea <= best.gain) continue;
        const BvhNode& node = bvh_.nodes[entry.node];
        const double merged = joined(node.box, box).halfArea();
        const double gain = entry.gained - merged;
        if (gain > best.gain) {
            best.to = entry.node;
            best.gain = gain;
        }
        if (node.count > 0 || top + 2 > std::size(stack)) continue;
        const double below = gain + node.box.halfArea();
        stack[top++] = {below, node.first};
        stack[top++] = {below, node.first + 1};
    }
}

Move Optimizer::bestMove(uint32_t from) const {
    Move best{from};
    const Box box = bvh_.nodes[from].box;
    const double ownArea = box.halfArea();
    const uint32_t parent = parents_[from];
    // Without the node its parent falls away; the ancestors above shrink to what is left.
    double gained = area(parent);
    uint32_t pivot = parent, sibling = siblingOf(from);
    Box rest = bvh_.nodes[sibling].box;
    while (true) {
        search(sibling, gained, box, ownArea, best);
        if (pivot != parent) {
            rest.include(bvh_.nodes[sibling].box);
            gained += area(pivot) - rest.halfArea();
        }
        if (pivot == kRoot) break;
        sibling = siblingOf(pivot);
        pivot = parents_[pivot];
    }
    // Beside its sibling, or beside its parent, is where it is.
    if (best.to == siblingOf(from) || best.to == parent) best = {from};
    return best;
}

void Optimizer::visitTouched(const Move& move, uint32_t (&touched)[5]) const {
    touched[0] = move.to;
    touched[1] = move.from;
    touched[2] = siblingOf(move.from);
    touched[3] = parents_[move.from];
    touched[4] = parents_[move.to];
}

bool Optimizer::conflicts(const Move& move) const {
    uint32_t touched[5];
    visitTouched(move, touched);
    return std::any_of(std::begin(touched), std::end(touched), [&](uint32_t n) { return touched_[n] != 0; });
}

// An earlier move of the batch may have brought the target into the moved subtree.
bool Optimizer::below(uint32_t node, uint32_t ancestor) const {
    while (node != kRoot && node != ancestor) node = parents_[node];
    return node == ancestor;
}

void Optimizer::mark(const Move& move) {
    uint32_t touched[5];
    visitTouched(move, touched);
    for (const uint32_t n : touched) touched_[n] = 1;
}

// The pair of places that held the moved node and its sibling comes to hold it and the node it joins.
void Optimizer::apply(const Move& move) {
    const uint32_t sibling = siblingOf(move.from), parent = parents_[move.from];
    const BvhNode siblingNode = nodes()[sibling], target = nodes()[move.to];
    nodes()[move.to].first = std::min(move.from, sibling);
    nodes()[move.to].count = 0;
    nodes()[sibling] = target;
    nodes()[parent] = siblingNode;
    if (target.count == 0) parents_[target.first] = parents_[target.first + 1] = sibling;
    if (siblingNode.count == 0) parents_[siblingNode.first] = parents_[siblingNode.first + 1] = parent;
    parents_[sibling] = parents_[move.from] = move.to;
    refit(move.to);
    refit(parent);
}

void Optimizer::refit(uint32_t node) {
    while (true) {
        BvhNode& n = nodes()[node];
        if (n.count == 0) n.box = joined(nodes()[n.first].box, nodes()[n.first + 1].box);
        if (node == kRoot) return;
        node = parents_[node];
    }
}

uint32_t Optimizer::depth() const {
    uint32_t deepest = 0;
    std::vector<std::pair<uint32_t, uint32_t>> pending{{kRoot, 0}};
    while (!pending.empty()) {
        const auto [node, level] = pending.back();
        pending.pop_back();
        deepest = std::max(deepest, level);
        if (leaf(node)) continue;
        pending.push_back({bvh_.nodes[node].first, level + 1});
        pending.push_back({bvh_.nodes[node].first + 1, level + 1});
    }
    return deepest;
}

double Optimizer::areas() const {
    double sum = 0;
    for (uint32_t i = 0; i < bvh_.nodes.size(); ++i) sum += leaf(i) ? 0 : area(i);
    return sum;
}

void Optimizer::run() {
    double cost = areas();
    for (uint32_t iteration = 0; iteration < options_.iterations; ++iteration) {
        const std::vector<BvhNode> before = bvh_.nodes;
        const std::vector<uint32_t> candidates = largest();
        std::vector<Move> moves(candidates.size());
        const auto find = [&](size_t chunk) {
            const size_t end = std::min(candidates.size(), (chunk + 1) * kChunk);
            for (size_t i = chunk * kChunk; i < end; ++i) moves[i] = bestMove(candidates[i]);
        };
        parallelFor(context_, (candidates.size() + kChunk - 1) / kChunk, find);
        std::erase_if(moves, [](const Move& m) { return m.to == kRoot; });
        std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
            return a.gain > b.gain || (a.gain == b.gain && a.from < b.from);
        });
        touched_.assign(bvh_.nodes.size(), 0);
        for (const Move& move : moves) {
            if (conflicts(move) || below(move.to, move.from)) continue;
            mark(move);
            apply(move);
        }
        // Moves were judged one by one, not together.
        const double newCost = areas();
        if (depth() > options_.maxLevels || !(newCost < cost)) {
            bvh_.nodes = before;
            return;
        }
        cost = newCost;
    }
}

// Nodes in depth-first order again, and the boxes' order that of the leaves.
void layOut(Bvh& bvh) {
    std::vector<BvhNode> nodes(1);
    nodes.reserve(bvh.nodes.size());
    std::vector<uint32_t> order;
    order.reserve(bvh.order.size());
    struct Pending {
        uint32_t from, to, level;
    };
    std::vector<Pending> pending{{kRoot, kRoot, 0}};
    bvh.depth = 0;
    while (!pending.empty()) {
        const Pending p = pending.back();
        pending.pop_back();
        BvhNode node = bvh.nodes[p.from];
        bvh.depth = std::max(bvh.depth, p.level);
        if (node.count > 0) {
            const auto begin = bvh.order.begin() + node.first;
            node.first = static_cast<uint32_t>(order.size());
            order.insert(order.end(), begin, begin + node.count);
        } else {
            const uint32_t first = static_cast<uint32_t>(nodes.size());
            nodes.resize(nodes.size() + 2);
            pending.push_back({node.first + 1, first + 1, p.level + 1});
            pending.push_back({node.first, first, p.level + 1});
            node.first = first;
        }
        nodes[p.to] = node;
    }
    bvh.nodes = std::move(nodes);
    bvh.order = std::move(order);
}

}  // namespace

void reinsertSubtrees(Bvh& bvh, const ReinsertionOptions& options, const Context& context) {
    if (bvh.nodes.size() < 5) return;  // no node has a grandparent
    Optimizer(bvh, options, context).run();
    layOut(bvh);
}

}  // namespace glint
