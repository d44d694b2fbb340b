// What a SPIR-V module says about the structs in its buffers.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace glint::render::test {

struct SpirvMember {
    std::string name;
    std::string type;  // "float", "vec3", "uint" or "other"
    uint32_t offset = 0;
    bool operator==(const SpirvMember&) const = default;
};

struct SpirvStruct {
    std::vector<SpirvMember> members;
    std::optional<uint32_t> arrayStride;  // of the runtime array of it
};

// All structs whose members carry offsets, by name.
std::map<std::string, SpirvStruct> readStructs(std::span<const uint32_t> module);

}  // namespace glint::render::test
