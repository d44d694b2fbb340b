#include "no_contraction.h"

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace glint::stability {

namespace {

// As glslang writes it: "intersectBox(struct-Ray-vf3...".
bool decidesHits(const std::string& name) {
    for (const std::string_view start : {"intersect", "nearestRoot(", "crosses(", "shearedVertex(",
                                         "makeFrame(", "turnToZ(", "crossingsOf(", "firstSurface("}) {
        if (name.starts_with(start)) return true;
    }
    return false;
}

// Literal strings: four bytes a word, the first lowest, ended by a zero byte.
std::string textOf(std::span<const uint32_t> words) {
    std::string text;
    for (const uint32_t word : words) {
        for (int byte = 0; byte < 4; ++byte) {
            const char c = static_cast<char>((word >> (8 * byte)) & 0xffu);
            if (c == 0) return text;
            text += c;
        }
    }
    return text;
}

}  // namespace

// Khronos, SPIR-V Specification 1.3: section 2.3 (five header words; an instruction's first word holds its
// length and opcode), 3.20 (decoration 42 is NoContraction), 3.32 (opcodes).
Contractible withoutNoContraction(std::span<const uint32_t> module) {
    constexpr uint32_t kName = 5, kFunction = 54, kDecorate = 71, kNoContraction = 42;
    const std::set<uint32_t> arithmetic = {129, 131, 133, 136, 142};
    std::map<uint32_t, std::string> names;
    std::set<uint32_t> decorated, found;
    bool counted = false;
    Contractible result;
    for (size_t at = 5; at < module.size();) {
        const uint32_t length = module[at] >> 16, opcode = module[at] & 0xffffu;
        if (length == 0 || at + length > module.size()) break;
        if (opcode == kName) names[module[at + 1]] = textOf(module.subspan(at + 2, length - 2));
        if (opcode == kDecorate && length >= 3 && module[at + 2] == kNoContraction)
            decorated.insert(module[at + 1]);
        if (opcode == kFunction) {
            counted = decidesHits(names[module[at + 2]]);
            result.functions += counted;
        }
        if (counted && arithmetic.contains(opcode)) found.insert(module[at + 2]);
        at += length;
    }
    for (const uint32_t id : found) result.instructions += !decorated.contains(id);
    return result;
}

}  // namespace glint::stability
