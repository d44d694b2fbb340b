#include "gpu/specialize.h"

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "gpu/spirv_code.h"

namespace glint::gpu {
namespace {

using namespace spirv;

// Known values of booleans and 32-bit numbers, by id.
using Known = std::unordered_map<uint32_t, uint32_t>;

std::optional<uint32_t> valueOf(const Known& known, uint32_t id) {
    const auto found = known.find(id);
    return found == known.end() ? std::nullopt : std::optional(found->second);
}

// Result of an operation. For two booleans one known operand may be enough.
std::optional<uint32_t> folded(uint32_t op, std::optional<uint32_t> a, std::optional<uint32_t> b) {
    switch (op) {
        case OpLogicalNot:
            return a ? std::optional<uint32_t>(*a == 0) : std::nullopt;
        case OpLogicalAnd:
            if ((a && *a == 0) || (b && *b == 0)) return 0;
            return a && b ? std::optional<uint32_t>(1) : std::nullopt;
        case OpLogicalOr:
            if ((a && *a != 0) || (b && *b != 0)) return 1;
            return a && b ? std::optional<uint32_t>(0) : std::nullopt;
        case OpLogicalEqual:
        case OpIEqual:
            return a && b ? std::optional<uint32_t>(*a == *b) : std::nullopt;
        case OpLogicalNotEqual:
        case OpINotEqual:
            return a && b ? std::optional<uint32_t>(*a != *b) : std::nullopt;
        default:
            return std::nullopt;
    }
}

bool isFoldable(uint32_t op) {
    return (op >= OpLogicalEqual && op <= OpLogicalNot) || op == OpIEqual || op == OpINotEqual;
}

using Labels = std::unordered_set<uint32_t>;

Labels reachable(const Function& function) {
    std::unordered_map<uint32_t, const Block*> byLabel;
    for (const Block& block : function.blocks) byLabel[block.label] = &block;
    Labels seen;
    std::vector<uint32_t> pending{function.blocks.front().label};
    while (!pending.empty()) {
        const uint32_t label = pending.back();
        pending.pop_back();
        if (!seen.insert(label).second) continue;
        for (const uint32_t next : byLabel.at(label)->successors()) pending.push_back(next);
    }
    return seen;
}

// Takes from the phis what comes along edges that are gone. A new edge, from a continue target that is never
// reached, may bring any value.
void trimPhis(Function& function) {
    std::unordered_map<uint32_t, std::set<uint32_t>> sources;
    for (const Block& block : function.blocks)
        for (const uint32_t next : block.successors()) sources[next].insert(block.label);
    for (Block& block : function.blocks) {
        for (Instruction& phi : block.body) {
            if (opOf(phi) != OpPhi) continue;
            Instruction kept(phi.begin(), phi.begin() + 3);
            std::set<uint32_t> missing = sources[block.label];
            for (size_t i = 3; i + 1 < phi.size(); i += 2) {
                if (missing.erase(phi[i + 1]) == 0) continue;
                kept.push_back(phi[i]);
                kept.push_back(phi[i + 1]);
            }
            for (const uint32_t label : missing) kept.insert(kept.end(), {phi[3], label});
            kept[0] = OpPhi | static_cast<uint32_t>(kept.size()) << 16;
            phi = std::move(kept);
        }
    }
}

// The value of a phi whose sources all have the same.
std::optional<uint32_t> valueOfPhi(const Known& known, const Instruction& phi) {
    std::optional<uint32_t> value;
    for (size_t i = 3; i + 1 < phi.size(); i += 2) {
        const std::optional<uint32_t> one = valueOf(known, phi[i]);
        if (!one || (value && *value != *one)) return std::nullopt;
        value = one;
    }
    return value;
}

// A branch whose condition is known becomes a jump. That of a loop's header stays, and so does a loop's only
// way back, to one of `headers`: the loop's structure needs them (SPIR-V 1.3, section 2.11).
bool foldBranch(Block& block, const Known& known, const Labels& headers) {
    const Instruction& last = block.terminator();
    if (opOf(last) != OpBranchConditional) return false;
    const Instruction* merge = block.merge();
    const std::optional<uint32_t> condition = valueOf(known, last[1]);
    if (!condition || (merge && opOf(*merge) == OpLoopMerge)) return false;
    const bool holds = *condition != 0;
    if (headers.contains(holds ? last[3] : last[2])) return false;
    const Instruction jump = make(OpBranch, {holds ? last[2] : last[3]});
    block.body.pop_back();
    if (merge) block.body.pop_back();
    block.body.push_back(jump);
    return true;
}

// Removes blocks that are not reached. What a loop or selection that stays names as its merge block or
// continue target must exist: without a body (SPIR-V 1.3, section 2.11).
void dropUnreached(Function& function) {
    const Labels reached = reachable(function);
    std::unordered_map<uint32_t, uint32_t> continues;  // target: header
    Labels merges;
    for (const Block& block : function.blocks) {
        const Instruction* merge = reached.contains(block.label) ? block.merge() : nullptr;
        if (!merge) continue;
        merges.insert((*merge)[1]);
        if (opOf(*merge) == OpLoopMerge) continues[(*merge)[2]] = block.label;
    }
    std::vector<Block> kept;
    for (Block& block : function.blocks) {
        if (reached.contains(block.label)) {
            kept.push_back(std::move(block));
        } else if (const auto header = continues.find(block.label); header != continues.end()) {
            kept.push_back({block.label, {block.body.front(), make(OpBranch, {header->second})}});
        } else if (merges.contains(block.label)) {
            kept.push_back({block.label, {block.body.front(), make(OpUnreachable, {})}});
        }
    }
    function.blocks = std::move(kept);
    trimPhis(function);
}

// Ids are the module's, so what is known of them is too.
void simplify(Function& function, Known& known) {
    for (bool changed = true; changed;) {
        changed = false;
        Labels headers;  // of the loops that have begun
        for (Block& block : function.blocks) {
            const Instruction* merge = block.merge();
            if (merge && opOf(*merge) == OpLoopMerge) headers.insert(block.label);
            for (const Instruction& i : block.body) {
                const uint32_t op = opOf(i);
                std::optional<uint32_t> value;
                if (op == OpPhi) {
                    value = valueOfPhi(known, i);
                } else if (isFoldable(op)) {
                    value =
                        folded(op, valueOf(known, i[3]), i.size() > 4 ? valueOf(known, i[4]) : std::nullopt);
                }
                if (value) known[i[2]] = *value;
            }
            changed |= foldBranch(block, known, headers);
        }
        if (changed) dropUnreached(function);
    }
}

class Module {
  public:
    Module(Words spirv, Words constants) : constants_(constants) {
        findSpecIds(spirv);
        code_ = Code::read(spirv);
        for (Instruction& i : std::exchange(code_.globals, {})) readGlobal(i);
    }

    std::vector<uint32_t> written() {
        for (Function& function : code_.functions) simplify(function, known_);
        code_.keepCalledFunctions();
        keepUsedVariables();
        keepUsedCapabilities();
        collectIds();
        std::erase_if(code_.globals,
                      [&](const Instruction& i) { return opOf(i) == OpDecorate && !ids_.contains(i[1]); });
        return code_.written();
    }

  private:
    // Decorations come before the constants, but for this a module is read twice.
    void findSpecIds(Words spirv) {
        eachInstruction(spirv, [&](Words i) {
            if (opOf(i) == OpDecorate && i[2] == kDecorationSpecId && i[3] < constants_.size())
                values_[i[1]] = constants_[i[3]];
        });
    }

    void readGlobal(Words i) {
        const uint32_t op = opOf(i);
        if (op == OpDecorate && i[2] == kDecorationSpecId && values_.contains(i[1])) return;
        Instruction words(i.begin(), i.end());
        const auto given = i.size() > 2 ? values_.find(i[2]) : values_.end();
        if (op == OpSpecConstantTrue || op == OpSpecConstantFalse) {
            if (given != values_.end()) words = boolean(i, given->second != 0);
        } else if (op == OpSpecConstant && given != values_.end() && i.size() == 4) {
            words = make(OpConstant, {i[1], i[2], given->second});
        } else if (op == OpSpecConstantOp && isFoldable(i[3])) {
            const auto value =
                folded(i[3], valueOf(known_, i[4]), i.size() > 5 ? valueOf(known_, i[5]) : std::nullopt);
            if (value) words = boolean(i, *value != 0);
        }
        const uint32_t now = opOf(words);
        if (now == OpConstantTrue || now == OpConstantFalse) known_[words[2]] = now == OpConstantTrue;
        if (now == OpConstant && words.size() == 4) known_[words[2]] = words[3];
        code_.globals.push_back(std::move(words));
    }

    static Instruction boolean(Words i, bool value) {
        return make(value ? OpConstantTrue : OpConstantFalse, {i[1], i[2]});
    }

    // Unused memory of invocations and workgroups would take room, unused bindings need not be in the layout.
    void keepUsedVariables() {
        std::unordered_set<uint32_t> used;
        for (const Function& function : code_.functions)
            for (const Block& block : function.blocks)
                for (const Instruction& i : block.body) {
                    if (isKnown(i))
                        eachId(i, [&](uint32_t id) { used.insert(id); });
                    else
                        used.insert(i.begin() + 1, i.end());
                }
        std::erase_if(code_.globals, [&](const Instruction& i) {
            return opOf(i) == OpVariable && i[3] != kInput && !used.contains(i[2]);
        });
    }

    // Removes the capabilities of shuffles if no function uses them, so that a device without shuffles can
    // run a kernel that chose not to shuffle. (An entry point may not name what another instruction needs, so
    // only functions can.)
    void keepUsedCapabilities() {
        for (const Function& function : code_.functions)
            for (const Block& block : function.blocks)
                for (const Instruction& i : block.body)
                    if (opOf(i) >= OpGroupNonUniformElect && opOf(i) <= OpGroupNonUniformQuadSwap) return;
        std::erase_if(code_.globals, [](const Instruction& i) {
            return opOf(i) == OpCapability &&
                   (i[1] == kCapabilityGroupNonUniform || i[1] == kCapabilityGroupNonUniformShuffle);
        });
    }

    // Everything left that could be decorated.
    void collectIds() {
        for (const Instruction& i : code_.globals) {
            const uint32_t op = opOf(i);
            if (op >= OpTypeVoid && op <= OpTypeForwardPointer) ids_.insert(i[1]);
            if ((op >= OpConstantTrue && op <= OpSpecConstantOp) || op == OpVariable || op == OpUndef)
                ids_.insert(i[2]);
        }
        for (const Function& function : code_.functions) {
            for (const Instruction& i : function.head) ids_.insert(i[2]);
            for (const Block& block : function.blocks) {
                for (const Instruction& i : block.body)
                    if (const size_t at = resultPlace(i)) ids_.insert(i[at]);
            }
        }
    }

    Words constants_;
    std::unordered_map<uint32_t, uint32_t> values_;  // of specialization constants, by result id
    Known known_;
    Code code_;
    std::unordered_set<uint32_t> ids_;
};

}  // namespace

std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants) {
    return Module(spirv, constants).written();
}

}  // namespace glint::gpu
