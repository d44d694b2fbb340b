// The types and constants of a SPIR-V module, by their ids.
#pragma once

#include <unordered_map>
#include <vector>

#include "gpu/spirv_code.h"

namespace glint::gpu::spirv {

// Types and constants that a module's globals declare; gives new ids, and new globals.
class Ids {
  public:
    explicit Ids(Code& code);

    uint32_t fresh() { return code_.header[kBound]++; }
    bool isStruct(uint32_t type) const { return structs_.contains(type); }
    // A structure's members, those of its members, and so on: what is none itself. Of another type: itself.
    const std::vector<uint32_t>& leavesOf(uint32_t type);
    // The type of part `index` of a value, 0 if it has none that is known.
    uint32_t partOf(uint32_t type, uint32_t index) const;
    const std::vector<uint32_t>& membersOf(uint32_t type) const { return structs_.at(type); }
    uint32_t pointeeOf(uint32_t pointerType) const { return pointees_.at(pointerType); }
    // Value of an integer constant; null for other ids.
    const uint32_t* constantOf(uint32_t id) const;
    // How many components a vector type has, 0 for other types.
    uint32_t componentsOf(uint32_t type) const;
    // The parts of a constant or undefined structure.
    std::vector<uint32_t> leavesOfConstant(uint32_t id, uint32_t type);
    uint32_t undefined(uint32_t type);

  private:
    struct Parts {
        uint32_t of;     // type of each
        uint32_t count;  // of a vector's
    };

    Code& code_;
    std::unordered_map<uint32_t, std::vector<uint32_t>> structs_, leaves_;
    std::unordered_map<uint32_t, Parts> parts_;  // of vectors and arrays
    std::unordered_map<uint32_t, uint32_t> pointees_, constants_, undefined_;
    std::unordered_map<uint32_t, Instruction> composites_;
};

}  // namespace glint::gpu::spirv
