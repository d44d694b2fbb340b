#include "no_contraction.h"

#include <set>

namespace glint::stability {

// Khronos, SPIR-V Specification 1.3: section 2.3 (five header words; an instruction's first word holds its
// length and opcode), 3.20 (decoration 42 is NoContraction), 3.32 (opcodes).
size_t withoutNoContraction(std::span<const uint32_t> module) {
    constexpr uint32_t kDecorate = 71, kNoContraction = 42;
    const std::set<uint32_t> arithmetic = {129, 131, 133, 136, 142};
    std::set<uint32_t> decorated, found;
    for (size_t at = 5; at < module.size();) {
        const uint32_t length = module[at] >> 16, opcode = module[at] & 0xffffu;
        if (length == 0 || at + length > module.size()) break;
        if (opcode == kDecorate && length >= 3 && module[at + 2] == kNoContraction)
            decorated.insert(module[at + 1]);
        if (arithmetic.contains(opcode)) found.insert(module[at + 2]);
        at += length;
    }
    size_t missing = 0;
    for (const uint32_t id : found) missing += !decorated.contains(id);
    return missing;
}

}  // namespace glint::stability
