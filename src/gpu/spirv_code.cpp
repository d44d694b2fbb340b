#include "gpu/spirv_code.h"

#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>

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
