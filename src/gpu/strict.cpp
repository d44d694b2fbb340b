#include "gpu/strict.h"

#include <algorithm>
#include <unordered_set>

#include "gpu/spirv_code.h"

namespace glint::gpu {
namespace {

using namespace spirv;

// Opcodes of the SPIR-V specification 1.3, section 3.32.
bool isArithmetic(uint32_t op) {
    constexpr uint32_t kFAdd = 129, kFSub = 131, kFMul = 133, kFDiv = 136, kFRem = 140, kDot = 148;
    return op == kFAdd || op == kFSub || op == kFMul || op == kFDiv || (op >= kFRem && op <= kDot);
}

}  // namespace

std::vector<uint32_t> strictArithmetic(std::span<const uint32_t> spirv) {
    std::unordered_set<uint32_t> marked;
    std::vector<uint32_t> found;
    size_t firstType = spirv.size();  // decorations stand before the types
    eachInstruction(spirv, [&](Words i) {
        const uint32_t op = opOf(i);
        if (op == OpDecorate && i[2] == kDecorationNoContraction) marked.insert(i[1]);
        if (op >= OpTypeVoid && op <= OpTypeForwardPointer)
            firstType = std::min(firstType, static_cast<size_t>(i.data() - spirv.data()));
        if (isArithmetic(op)) found.push_back(i[2]);
    });
    const auto middle = spirv.begin() + static_cast<std::ptrdiff_t>(firstType);
    std::vector<uint32_t> result(spirv.begin(), middle);
    for (const uint32_t id : found)
        if (!marked.contains(id))
            result.insert(result.end(), {OpDecorate | 3u << 16, id, kDecorationNoContraction});
    result.insert(result.end(), middle, spirv.end());
    return result;
}

}  // namespace glint::gpu
