#include "gpu/strict.h"

#include <algorithm>
#include <unordered_set>

namespace glint::gpu {
namespace {

// SPIR-V specification 1.3, sections 2.3 (layout), 3.20 (decorations) and 3.32 (instructions).
constexpr size_t kHeaderWords = 5;
constexpr uint32_t kDecorate = 71, kNoContraction = 42;
constexpr uint32_t kFirstType = 19, kLastType = 39;

bool isArithmetic(uint32_t op) {
    constexpr uint32_t kFAdd = 129, kFSub = 131, kFMul = 133, kFDiv = 136, kFRem = 140, kDot = 148;
    return op == kFAdd || op == kFSub || op == kFMul || op == kFDiv || (op >= kFRem && op <= kDot);
}

template <typename Visit>
void eachInstruction(std::span<const uint32_t> spirv, Visit visit) {
    for (size_t at = kHeaderWords; at < spirv.size();) {
        const size_t length = spirv[at] >> 16;
        if (length == 0 || at + length > spirv.size()) return;
        visit(at, spirv[at] & 0xffffu, spirv.subspan(at, length));
        at += length;
    }
}

}  // namespace

std::vector<uint32_t> strictArithmetic(std::span<const uint32_t> spirv) {
    std::unordered_set<uint32_t> marked;
    std::vector<uint32_t> found;
    size_t firstType = spirv.size();  // decorations stand before the types
    eachInstruction(spirv, [&](size_t at, uint32_t op, std::span<const uint32_t> words) {
        if (op == kDecorate && words[2] == kNoContraction) marked.insert(words[1]);
        if (op >= kFirstType && op <= kLastType) firstType = std::min(firstType, at);
        if (isArithmetic(op)) found.push_back(words[2]);
    });
    const auto middle = spirv.begin() + static_cast<std::ptrdiff_t>(firstType);
    std::vector<uint32_t> result(spirv.begin(), middle);
    for (const uint32_t id : found)
        if (!marked.contains(id)) result.insert(result.end(), {kDecorate | 3u << 16, id, kNoContraction});
    result.insert(result.end(), middle, spirv.end());
    return result;
}

}  // namespace glint::gpu
