#include "gpu/specialize.h"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace glint::gpu {
namespace {

// Of the SPIR-V specification 1.3, section 3.32.
enum Op : uint32_t {
    OpSourceContinued = 2,
    OpSource = 3,
    OpSourceExtension = 4,
    OpName = 5,
    OpMemberName = 6,
    OpString = 7,
    OpLine = 8,
    OpEntryPoint = 15,
    OpConstantTrue = 41,
    OpConstantFalse = 42,
    OpConstant = 43,
    OpSpecConstantTrue = 48,
    OpSpecConstantFalse = 49,
    OpSpecConstant = 50,
    OpSpecConstantOp = 52,
    OpFunction = 54,
    OpFunctionEnd = 56,
    OpFunctionCall = 57,
    OpVariable = 59,
    OpStore = 62,
    OpDecorate = 71,
    OpImageWrite = 99,
    OpLogicalEqual = 164,
    OpLogicalNotEqual = 165,
    OpLogicalOr = 166,
    OpLogicalAnd = 167,
    OpLogicalNot = 168,
    OpIEqual = 170,
    OpINotEqual = 171,
    OpPhi = 245,
    OpLoopMerge = 246,
    OpSelectionMerge = 247,
    OpLabel = 248,
    OpBranch = 249,
    OpBranchConditional = 250,
    OpSwitch = 251,
    OpUnreachable = 255,
    OpNoLine = 317,
    OpModuleProcessed = 330
};
constexpr uint32_t kMagic = 0x07230203, kHeaderWords = 5, kDecorationSpecId = 1;
constexpr uint32_t kWorkgroup = 4, kPrivate = 6;  // storage classes

using Words = std::span<const uint32_t>;
using Instruction = std::vector<uint32_t>;

uint32_t opOf(Words words) {
    return words[0] & 0xffff;
}

Instruction make(Op op, std::initializer_list<uint32_t> operands) {
    Instruction words{static_cast<uint32_t>(op) | static_cast<uint32_t>(operands.size() + 1) << 16};
    words.insert(words.end(), operands);
    return words;
}

bool isDebug(uint32_t op) {
    return (op >= OpSourceContinued && op <= OpLine) || op == OpNoLine || op == OpModuleProcessed;
}

// What is known of ids: the values of booleans and 32-bit numbers.
using Known = std::unordered_map<uint32_t, uint32_t>;

std::optional<uint32_t> valueOf(const Known& known, uint32_t id) {
    const auto found = known.find(id);
    return found == known.end() ? std::nullopt : std::optional(found->second);
}

// What an operation gives; of two booleans one may be enough.
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

struct Block {
    uint32_t label = 0;
    std::vector<Instruction> body;  // the label first, the terminator last

    const Instruction& terminator() const { return body.back(); }
    // The merge instruction before the terminator; null if there is none.
    const Instruction* merge() const {
        if (body.size() < 2) return nullptr;
        const uint32_t op = opOf(body[body.size() - 2]);
        return op == OpLoopMerge || op == OpSelectionMerge ? &body[body.size() - 2] : nullptr;
    }
    std::vector<uint32_t> successors() const {
        const Instruction& last = terminator();
        switch (opOf(last)) {
            case OpBranch:
                return {last[1]};
            case OpBranchConditional:
                return {last[2], last[3]};
            case OpSwitch: {
                std::vector<uint32_t> targets{last[2]};
                for (size_t i = 4; i < last.size(); i += 2) targets.push_back(last[i]);
                return targets;
            }
            default:
                return {};
        }
    }
};

struct Function {
    std::vector<Instruction> head;  // OpFunction and its parameters
    std::vector<Block> blocks;

    uint32_t id() const { return head.front()[2]; }
};

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
        if (spirv.size() < kHeaderWords || spirv[0] != kMagic)
            throw std::invalid_argument("not a SPIR-V module");
        header_.assign(spirv.begin(), spirv.begin() + kHeaderWords);
        findSpecIds(spirv);
        read(spirv);
    }

    std::vector<uint32_t> written() {
        for (Function& function : functions_) simplify(function, known_);
        keepCalledFunctions();
        keepUsedVariables();
        collectIds();
        std::vector<uint32_t> words = header_;
        const auto add = [&](const Instruction& i) { words.insert(words.end(), i.begin(), i.end()); };
        for (const Instruction& i : globals_)
            if (opOf(i) != OpDecorate || ids_.contains(i[1])) add(i);
        for (const Function& function : functions_) {
            for (const Instruction& i : function.head) add(i);
            for (const Block& block : function.blocks)
                for (const Instruction& i : block.body) add(i);
            add(make(OpFunctionEnd, {}));
        }
        return words;
    }

  private:
    template <typename Use>
    static void each(Words spirv, Use use) {
        for (size_t at = kHeaderWords; at < spirv.size();) {
            const size_t length = spirv[at] >> 16;
            if (length == 0 || at + length > spirv.size())
                throw std::invalid_argument("a SPIR-V module that ends within an instruction");
            use(spirv.subspan(at, length));
            at += length;
        }
    }

    // Decorations come before the constants, but for this a module is read twice.
    void findSpecIds(Words spirv) {
        each(spirv, [&](Words i) {
            if (opOf(i) == OpDecorate && i[2] == kDecorationSpecId && i[3] < constants_.size())
                values_[i[1]] = constants_[i[3]];
        });
    }

    void read(Words spirv) {
        bool inFunction = false;
        each(spirv, [&](Words i) {
            const uint32_t op = opOf(i);
            if (isDebug(op)) return;
            if (op == OpFunction) {
                functions_.emplace_back();
                inFunction = true;
            }
            if (!inFunction) {
                readGlobal(i);
            } else if (op == OpFunctionEnd) {
                inFunction = false;
            } else {
                std::vector<Block>& blocks = functions_.back().blocks;
                if (op == OpLabel) blocks.push_back({i[1], {}});
                (blocks.empty() ? functions_.back().head : blocks.back().body)
                    .emplace_back(i.begin(), i.end());
            }
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
        globals_.push_back(std::move(words));
    }

    static Instruction boolean(Words i, bool value) {
        return make(value ? OpConstantTrue : OpConstantFalse, {i[1], i[2]});
    }

    void keepCalledFunctions() {
        std::unordered_map<uint32_t, const Function*> byId;
        for (const Function& function : functions_) byId[function.id()] = &function;
        std::unordered_set<uint32_t> called;
        std::vector<uint32_t> pending;
        for (const Instruction& i : globals_)
            if (opOf(i) == OpEntryPoint) pending.push_back(i[2]);
        while (!pending.empty()) {
            const uint32_t id = pending.back();
            pending.pop_back();
            if (!called.insert(id).second) continue;
            for (const Block& block : byId.at(id)->blocks)
                for (const Instruction& i : block.body)
                    if (opOf(i) == OpFunctionCall) pending.push_back(i[3]);
        }
        std::erase_if(functions_, [&](const Function& f) { return !called.contains(f.id()); });
    }

    // Of invocations and workgroups: memory that a driver might set aside. A number that is no id may keep
    // one for nothing.
    void keepUsedVariables() {
        std::unordered_set<uint32_t> used;
        for (const Function& function : functions_)
            for (const Block& block : function.blocks)
                for (const Instruction& i : block.body) used.insert(i.begin() + 1, i.end());
        std::erase_if(globals_, [&](const Instruction& i) {
            return opOf(i) == OpVariable && (i[3] == kWorkgroup || i[3] == kPrivate) && !used.contains(i[2]);
        });
    }

    static bool hasResult(const Instruction& i) {
        const uint32_t op = opOf(i);
        return i.size() > 2 && op != OpStore && op != OpImageWrite &&
               (op < OpLoopMerge || op > OpUnreachable);
    }

    // Of everything left that could be decorated.
    void collectIds() {
        for (const Instruction& i : globals_) {
            if (opOf(i) == OpDecorate) continue;
            if (i.size() > 1) ids_.insert(i[1]);
            if (i.size() > 2) ids_.insert(i[2]);
        }
        for (const Function& function : functions_) {
            for (const Instruction& i : function.head) ids_.insert(i[2]);
            for (const Block& block : function.blocks) {
                for (const Instruction& i : block.body)
                    if (hasResult(i)) ids_.insert(i[2]);
            }
        }
    }

    Words constants_;
    std::vector<uint32_t> header_;
    std::unordered_map<uint32_t, uint32_t> values_;  // of specialization constants, by result id
    Known known_;
    std::vector<Instruction> globals_;
    std::vector<Function> functions_;
    std::unordered_set<uint32_t> ids_;
};

}  // namespace

std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants) {
    return Module(spirv, constants).written();
}

}  // namespace glint::gpu
