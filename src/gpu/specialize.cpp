#include "gpu/specialize.h"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace glint::gpu::spirv {
namespace {

bool isDebug(uint32_t op) {
    return (op >= OpSourceContinued && op <= OpLine) || op == OpNoLine || op == OpModuleProcessed;
}

// No operands but ids.
bool hasIdsAlone(uint32_t op) {
    return op == OpUndef || op == OpExtInst || op == OpFunctionCall || op == OpImageTexelPointer ||
           op == OpAccessChain || op == OpCompositeConstruct || (op >= OpConvertFToU && op <= OpBitcast) ||
           (op >= OpSNegate && op <= OpBitCount) || (op >= OpAtomicExchange && op <= OpAtomicXor) ||
           op == OpControlBarrier || op == OpMemoryBarrier || op == OpPhi || op == OpGroupNonUniformShuffle ||
           op == OpGroupNonUniformShuffleXor;
}

}  // namespace

Instruction make(Op op, const std::vector<uint32_t>& operands) {
    Instruction words{static_cast<uint32_t>(op) | static_cast<uint32_t>(operands.size() + 1) << 16};
    words.insert(words.end(), operands.begin(), operands.end());
    return words;
}

const Instruction* Block::merge() const {
    if (body.size() < 2) return nullptr;
    const uint32_t op = opOf(body[body.size() - 2]);
    return op == OpLoopMerge || op == OpSelectionMerge ? &body[body.size() - 2] : nullptr;
}

std::vector<uint32_t> Block::successors() const {
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

Code Code::read(Words spirv) {
    if (spirv.size() < kHeaderWords || spirv[0] != kMagic) throw std::invalid_argument("not a SPIR-V module");
    Code code;
    code.header.assign(spirv.begin(), spirv.begin() + kHeaderWords);
    bool inFunction = false;
    for (size_t at = kHeaderWords, length = 0; at < spirv.size(); at += length) {
        length = spirv[at] >> 16;
        if (length == 0 || at + length > spirv.size())
            throw std::invalid_argument("a SPIR-V module that ends within an instruction");
        const Words i = spirv.subspan(at, length);
        const uint32_t op = opOf(i);
        if (isDebug(op)) continue;
        if (op == OpFunction) {
            code.functions.emplace_back();
            inFunction = true;
        }
        if (!inFunction) {
            code.globals.emplace_back(i.begin(), i.end());
        } else if (op == OpFunctionEnd) {
            inFunction = false;
        } else {
            std::vector<Block>& blocks = code.functions.back().blocks;
            if (op == OpLabel) blocks.push_back({i[1], {}});
            (blocks.empty() ? code.functions.back().head : blocks.back().body)
                .emplace_back(i.begin(), i.end());
        }
    }
    return code;
}

std::vector<uint32_t> Code::written() const {
    std::vector<uint32_t> words = header;
    const auto add = [&](const Instruction& i) { words.insert(words.end(), i.begin(), i.end()); };
    for (const Instruction& i : globals) add(i);
    for (const Function& function : functions) {
        for (const Instruction& i : function.head) add(i);
        for (const Block& block : function.blocks)
            for (const Instruction& i : block.body) add(i);
        add(make(OpFunctionEnd, {}));
    }
    return words;
}

void Code::keepCalledFunctions() {
    std::unordered_map<uint32_t, const Function*> byId;
    for (const Function& function : functions) byId[function.id()] = &function;
    std::unordered_set<uint32_t> called;
    std::vector<uint32_t> pending;
    for (const Instruction& i : globals)
        if (opOf(i) == OpEntryPoint) pending.push_back(i[2]);
    while (!pending.empty()) {
        const uint32_t id = pending.back();
        pending.pop_back();
        if (!called.insert(id).second) continue;
        for (const Block& block : byId.at(id)->blocks)
            for (const Instruction& i : block.body)
                if (opOf(i) == OpFunctionCall) pending.push_back(i[3]);
    }
    std::erase_if(functions, [&](const Function& f) { return !called.contains(f.id()); });
}

size_t resultPlace(const Instruction& i) {
    switch (opOf(i)) {
        case OpLabel:
            return 1;
        case OpStore:
        case OpImageWrite:
        case OpControlBarrier:
        case OpMemoryBarrier:
        case OpLoopMerge:
        case OpSelectionMerge:
        case OpBranch:
        case OpBranchConditional:
        case OpSwitch:
        case OpReturn:
        case OpReturnValue:
        case OpUnreachable:
            return 0;
        default:
            return i.size() > 2 ? 2 : 0;
    }
}

size_t endOfIds(const Instruction& i) {
    switch (opOf(i)) {
        case OpLabel:
        case OpReturn:
        case OpUnreachable:
            return 1;
        case OpVariable:
            if (i.size() == 4) return 1;  // without an initial value
            break;
        case OpSelectionMerge:
        case OpBranch:
        case OpReturnValue:
            return 2;
        case OpStore:
        case OpLoopMerge:
            return 3;
        case OpBranchConditional:
        case OpLoad:
        case OpCompositeExtract:
            return 4;
        case OpCompositeInsert:
        case OpVectorShuffle:
            return 5;
        // No image operands.
        case OpImageWrite:
            if (i.size() == 4) return 4;
            break;
        case OpImageRead:
            if (i.size() == 5) return 5;
            break;
        default:
            if (hasIdsAlone(opOf(i))) return i.size();
    }
    throw std::domain_error("instruction " + std::to_string(opOf(i)) + " of SPIR-V is not known here");
}

}  // namespace glint::gpu::spirv

namespace glint::gpu {
namespace {

using namespace spirv;

// Known values of booleans and 32-bit numbers, by id.
using Known = std::unordered_map<uint32_t, uint32_t>;

std::optional<uint32_t> valueOf(const Known& known, uint32_t id) {
    const auto found = known.find(id);
    return found == known.end() ? std::nullopt : std::optional(found->second);
}

// Result of an operation on these ids. For two booleans one known operand may be enough.
std::optional<uint32_t> folded(uint32_t op, Words operands, const Known& known) {
    const std::optional<uint32_t> a = valueOf(known, operands[0]);
    const std::optional<uint32_t> b = operands.size() > 1 ? valueOf(known, operands[1]) : std::nullopt;
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
                    value = folded(op, Words(i).subspan(3), known);
                }
                if (value) known[i[2]] = *value;
            }
            changed |= foldBranch(block, known, headers);
        }
        if (changed) dropUnreached(function);
    }
}

Instruction boolean(const Instruction& i, bool value) {
    return make(value ? OpConstantTrue : OpConstantFalse, {i[1], i[2]});
}

// Puts the values in place of the specialization constants, and returns those of all constants.
Known setConstants(std::vector<Instruction>& globals, Words constants) {
    std::unordered_map<uint32_t, uint32_t> values;  // by result id
    std::erase_if(globals, [&](const Instruction& i) {
        const bool isGiven = opOf(i) == OpDecorate && i[2] == kDecorationSpecId && i[3] < constants.size();
        if (isGiven) values[i[1]] = constants[i[3]];
        return isGiven;
    });
    Known known;
    for (Instruction& i : globals) {
        const uint32_t op = opOf(i);
        const std::optional<uint32_t> given = i.size() > 2 ? valueOf(values, i[2]) : std::nullopt;
        if ((op == OpSpecConstantTrue || op == OpSpecConstantFalse) && given) {
            i = boolean(i, *given != 0);
        } else if (op == OpSpecConstant && given) {
            i = make(OpConstant, {i[1], i[2], *given});
        } else if (op == OpSpecConstantOp && isFoldable(i[3])) {
            const std::optional<uint32_t> value = folded(i[3], Words(i).subspan(4), known);
            if (value) i = boolean(i, *value != 0);
        }
        const uint32_t now = opOf(i);
        if (now == OpConstantTrue || now == OpConstantFalse) known[i[2]] = now == OpConstantTrue;
        if (now == OpConstant && i.size() == 4) known[i[2]] = i[3];
    }
    return known;
}

// Unused memory of invocations and workgroups would take room, unused bindings need not be in the layout.
void keepUsedVariables(Code& code) {
    std::unordered_set<uint32_t> used, dropped;
    eachInstruction(code.functions,
                    [&](const Instruction& i) { eachId(i, [&](uint32_t id) { used.insert(id); }); });
    for (const Instruction& i : code.globals)
        if (opOf(i) == OpVariable && i[3] != kInput && !used.contains(i[2])) dropped.insert(i[2]);
    std::erase_if(code.globals, [&](const Instruction& i) {
        return (opOf(i) == OpVariable && dropped.contains(i[2])) ||
               (opOf(i) == OpDecorate && dropped.contains(i[1]));
    });
}

// Removes the capabilities of shuffles if no function uses them, so that a device without shuffles can run a
// kernel that chose not to shuffle. (An entry point may not name what another instruction needs, so only
// functions can.)
void keepUsedCapabilities(Code& code) {
    bool shuffles = false;
    eachInstruction(code.functions, [&](const Instruction& i) {
        shuffles |= opOf(i) >= OpGroupNonUniformElect && opOf(i) <= OpGroupNonUniformQuadSwap;
    });
    if (shuffles) return;
    std::erase_if(code.globals, [](const Instruction& i) {
        return opOf(i) == OpCapability &&
               (i[1] == kCapabilityGroupNonUniform || i[1] == kCapabilityGroupNonUniformShuffle);
    });
}

// Negations, sums, differences, products and quotients of floats, of vectors too (SPIR-V specification 1.3,
// section 3.32).
bool isFloatArithmetic(uint32_t op) {
    constexpr uint32_t kFNegate = 127, kFAdd = 129, kFSub = 131, kFMul = 133, kFDiv = 136, kFRem = 140,
                       kDot = 148;
    return op == kFNegate || op == kFAdd || op == kFSub || op == kFMul || op == kFDiv ||
           (op >= kFRem && op <= kDot);
}

// In place of the marks of GLSL's `precise`. Decorations stand before the types.
void markArithmetic(Code& code) {
    std::erase_if(code.globals, [](const Instruction& i) {
        return opOf(i) == OpDecorate && i[2] == kDecorationNoContraction;
    });
    std::vector<Instruction> marks;
    eachInstruction(code.functions, [&](const Instruction& i) {
        if (isFloatArithmetic(opOf(i))) marks.push_back(make(OpDecorate, {i[2], kDecorationNoContraction}));
    });
    const auto types = std::find_if(code.globals.begin(), code.globals.end(), [](const Instruction& i) {
        return opOf(i) >= OpTypeVoid && opOf(i) <= OpTypeForwardPointer;
    });
    code.globals.insert(types, marks.begin(), marks.end());
}

}  // namespace

std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants) {
    Code code = Code::read(spirv);
    Known known = setConstants(code.globals, constants);
    for (Function& function : code.functions) simplify(function, known);
    code.keepCalledFunctions();
    inlineCalls(code);
    // Conditions that were arguments or variables may be constants now.
    for (Function& function : code.functions) simplify(function, known);
    code.keepCalledFunctions();
    keepUsedVariables(code);
    keepUsedCapabilities(code);
    markArithmetic(code);
    return code.written();
}

}  // namespace glint::gpu
