// Specializes the SPIR-V of a kernel for one scene.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace glint::gpu {

// The module with constants[i] for the specialization constant of id i (ids beyond keep their defaults and
// stay specialization constants), without the branches that are then never taken, with the bodies of
// functions in place of calls, values in place of local variables, and without what is then unused. A driver
// makes these reductions only after it has translated the whole module, which takes many times as long
// (docs/lab/building.md).
//
// All float arithmetic is decorated NoContraction, so that a driver may neither fuse nor reorder it (SPIR-V
// specification 1.3, section 3.20; Vulkan specification, "Precision and Operation of SPIR-V Instructions");
// GLSL's `precise` marks only what its variables depend on. Results keep every bit.
//
// `spirv` must be valid. Throws std::invalid_argument if it is not SPIR-V, and std::domain_error for an
// instruction that no kernel of glint has.
std::vector<uint32_t> specialize(std::span<const uint32_t> spirv, std::span<const uint32_t> constants);

// ---- private to src/gpu and its tests: a module taken apart into functions, blocks and instructions ----

namespace spirv {

// Opcodes of the SPIR-V specification 1.3, section 3.32.
enum Op : uint32_t {
    OpUndef = 1,
    OpSourceContinued = 2,
    OpLine = 8,
    OpExtInst = 12,
    OpEntryPoint = 15,
    OpCapability = 17,
    OpTypeVoid = 19,
    OpTypePointer = 32,
    OpTypeForwardPointer = 39,
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
    OpImageTexelPointer = 60,
    OpLoad = 61,
    OpStore = 62,
    OpAccessChain = 65,
    OpDecorate = 71,
    OpVectorShuffle = 79,
    OpCompositeConstruct = 80,
    OpCompositeExtract = 81,
    OpCompositeInsert = 82,
    OpImageRead = 98,
    OpImageWrite = 99,
    OpConvertFToU = 109,
    OpBitcast = 124,
    OpSNegate = 126,
    OpLogicalEqual = 164,
    OpLogicalNotEqual = 165,
    OpLogicalOr = 166,
    OpLogicalAnd = 167,
    OpLogicalNot = 168,
    OpIEqual = 170,
    OpINotEqual = 171,
    OpBitCount = 205,
    OpControlBarrier = 224,
    OpMemoryBarrier = 225,
    OpAtomicExchange = 229,
    OpAtomicXor = 242,
    OpPhi = 245,
    OpLoopMerge = 246,
    OpSelectionMerge = 247,
    OpLabel = 248,
    OpBranch = 249,
    OpBranchConditional = 250,
    OpSwitch = 251,
    OpReturn = 253,
    OpReturnValue = 254,
    OpUnreachable = 255,
    OpNoLine = 317,
    OpModuleProcessed = 330,
    OpGroupNonUniformElect = 333,
    OpGroupNonUniformShuffle = 345,
    OpGroupNonUniformShuffleXor = 346,
    OpGroupNonUniformQuadSwap = 366
};
constexpr uint32_t kMagic = 0x07230203, kHeaderWords = 5, kBound = 3;
constexpr uint32_t kCapabilityGroupNonUniform = 61, kCapabilityGroupNonUniformShuffle = 65;
constexpr uint32_t kDecorationSpecId = 1, kDecorationNoContraction = 42;
constexpr uint32_t kInput = 1, kFunction = 7;  // storage classes

using Words = std::span<const uint32_t>;
using Instruction = std::vector<uint32_t>;

inline uint32_t opOf(Words words) {
    return words[0] & 0xffff;
}

Instruction make(Op op, const std::vector<uint32_t>& operands);

struct Block {
    uint32_t label = 0;
    std::vector<Instruction> body;  // the label first, the terminator last

    const Instruction& terminator() const { return body.back(); }
    // The merge instruction before the terminator, or null.
    const Instruction* merge() const;
    std::vector<uint32_t> successors() const;
};

struct Function {
    std::vector<Instruction> head;  // OpFunction and its parameters
    std::vector<Block> blocks;

    uint32_t id() const { return head.front()[2]; }
};

// Calls use(instruction) for each instruction in the bodies of `functions`.
template <typename Use>
void eachInstruction(const std::vector<Function>& functions, Use use) {
    for (const Function& function : functions)
        for (const Block& block : function.blocks)
            for (const Instruction& i : block.body) use(i);
}

// A module without debug information. Throws std::invalid_argument for an invalid module.
struct Code {
    std::vector<uint32_t> header;
    std::vector<Instruction> globals;  // all before the first function
    std::vector<Function> functions;

    static Code read(Words spirv);
    std::vector<uint32_t> written() const;
    // Removes functions that no entry point calls, directly or indirectly.
    void keepCalledFunctions();
};

// Puts bodies of functions in place of their calls, and values in place of the variables of each function.
// Calls of functions that return from within a loop or a branch remain (spirv_inline.cpp).
void inlineCalls(Code& code);

// The place of an instruction's result in its words, 0 if it has none. Of what stands in functions.
size_t resultPlace(const Instruction& i);

// One past the place of the last id among the words of an instruction. Throws std::domain_error for an
// instruction that is not known here.
size_t endOfIds(const Instruction& i);

// Calls use(id) for each id that it uses, but for its type. Throws as endOfIds.
template <typename Words, typename Use>
void eachId(Words& i, Use use) {
    const uint32_t op = opOf(i);
    if (op == OpSwitch) {
        use(i[1]);
        for (size_t at = 2; at < i.size(); at += 2) use(i[at]);
        return;
    }
    const size_t end = endOfIds(i);
    // In OpExtInst, word 3 is the instruction set and word 4 the instruction in it.
    for (size_t at = op == OpExtInst ? 5 : resultPlace(i) + 1; at < end; ++at) use(i[at]);
}

}  // namespace spirv

}  // namespace glint::gpu
