#include "gpu/spirv_ids.h"

#include <stdexcept>

namespace glint::gpu::spirv {

Ids::Ids(Code& code) : code_(code) {
    for (const Instruction& i : code.globals) {
        switch (opOf(i)) {
            case OpTypeStruct:
                structs_[i[1]].assign(i.begin() + 2, i.end());
                break;
            case OpTypeVector:
                parts_[i[1]] = {i[2], i[3]};
                break;
            case OpTypeArray:
                parts_[i[1]] = {i[2], 0};
                break;
            case OpTypePointer:
                pointees_[i[1]] = i[3];
                break;
            case OpConstant:
                constants_[i[2]] = i[3];
                break;
            case OpUndef:
            case OpConstantNull:
            case OpConstantComposite:
                composites_[i[2]] = i;
                break;
        }
    }
}

const std::vector<uint32_t>& Ids::leavesOf(uint32_t type) {
    const auto known = leaves_.find(type);
    if (known != leaves_.end()) return known->second;
    std::vector<uint32_t> leaves;
    const auto members = structs_.find(type);
    if (members == structs_.end()) {
        leaves = {type};
    } else {
        for (const uint32_t member : members->second) {
            const std::vector<uint32_t>& more = leavesOf(member);
            leaves.insert(leaves.end(), more.begin(), more.end());
        }
    }
    return leaves_[type] = std::move(leaves);
}

uint32_t Ids::partOf(uint32_t type, uint32_t index) const {
    const auto members = structs_.find(type);
    if (members != structs_.end()) return members->second.at(index);
    const auto parts = parts_.find(type);
    return parts == parts_.end() ? 0 : parts->second.of;
}

const uint32_t* Ids::constantOf(uint32_t id) const {
    const auto constant = constants_.find(id);
    return constant == constants_.end() ? nullptr : &constant->second;
}

uint32_t Ids::componentsOf(uint32_t type) const {
    const auto parts = parts_.find(type);
    return parts == parts_.end() ? 0 : parts->second.count;
}

std::vector<uint32_t> Ids::leavesOfConstant(uint32_t id, uint32_t type) {
    if (!isStruct(type)) return {id};
    const auto found = composites_.find(id);
    if (found == composites_.end()) throw std::domain_error("a structure of SPIR-V that comes from nowhere");
    std::vector<uint32_t> leaves;
    const Instruction constant = found->second;
    if (opOf(constant) == OpConstantComposite) {
        for (size_t m = 0; m + 3 < constant.size(); ++m) {
            const std::vector<uint32_t> more = leavesOfConstant(constant[3 + m], membersOf(type)[m]);
            leaves.insert(leaves.end(), more.begin(), more.end());
        }
        return leaves;
    }
    for (const uint32_t leaf : leavesOf(type)) {
        leaves.push_back(fresh());
        code_.globals.push_back(make(static_cast<Op>(opOf(constant)), {leaf, leaves.back()}));
    }
    return leaves;
}

uint32_t Ids::undefined(uint32_t type) {
    uint32_t& id = undefined_[type];
    if (id == 0) {
        id = fresh();
        code_.globals.push_back(make(OpUndef, {type, id}));
    }
    return id;
}

}  // namespace glint::gpu::spirv
