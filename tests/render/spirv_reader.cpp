#include "spirv_reader.h"

#include <cstring>

namespace glint::render::test {
namespace {

// SPIR-V 1.3 specification, sections 2.3 (layout), 3.20 (decorations) and 3.32 (instructions).
enum Op : uint32_t {
    OpName = 5,
    OpMemberName = 6,
    OpTypeInt = 21,
    OpTypeFloat = 22,
    OpTypeVector = 23,
    OpTypeRuntimeArray = 29,
    OpTypeStruct = 30,
    OpDecorate = 71,
    OpMemberDecorate = 72
};
constexpr uint32_t kDecorationArrayStride = 6;
constexpr uint32_t kDecorationOffset = 35;
constexpr size_t kHeaderWords = 5;

struct Module {
    std::map<uint32_t, std::string> names, types;
    std::map<uint32_t, std::vector<uint32_t>> structs;  // member types
    std::map<uint32_t, uint32_t> elements, strides;     // of runtime arrays
    std::map<std::pair<uint32_t, uint32_t>, std::string> memberNames;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> offsets;

    void read(std::span<const uint32_t> words);
};

// Literal strings are UTF-8, zero-terminated and padded to words.
std::string literal(std::span<const uint32_t> words) {
    const std::string padded(reinterpret_cast<const char*>(words.data()), words.size_bytes());
    return padded.substr(0, padded.find('\0'));
}

void Module::read(std::span<const uint32_t> words) {
    const auto operand = [&](size_t i) { return words[i]; };
    switch (operand(0) & 0xffffu) {
        case OpName:
            names[operand(1)] = literal(words.subspan(2));
            break;
        case OpMemberName:
            memberNames[{operand(1), operand(2)}] = literal(words.subspan(3));
            break;
        case OpTypeInt:
            types[operand(1)] = operand(2) == 32 && operand(3) == 0 ? "uint" : "other";
            break;
        case OpTypeFloat:
            types[operand(1)] = operand(2) == 32 ? "float" : "other";
            break;
        case OpTypeVector:
            types[operand(1)] = types[operand(2)] == "float" && operand(3) == 3 ? "vec3" : "other";
            break;
        case OpTypeRuntimeArray:
            elements[operand(1)] = operand(2);
            break;
        case OpTypeStruct:
            structs[operand(1)].assign(words.begin() + 2, words.end());
            break;
        case OpDecorate:
            if (operand(2) == kDecorationArrayStride) strides[operand(1)] = operand(3);
            break;
        case OpMemberDecorate:
            if (operand(3) == kDecorationOffset) offsets[{operand(1), operand(2)}] = operand(4);
            break;
        default:
            break;
    }
}

}  // namespace

std::map<std::string, SpirvStruct> readStructs(std::span<const uint32_t> code) {
    Module module;
    for (size_t at = kHeaderWords; at < code.size();) {
        const size_t length = code[at] >> 16;
        if (length == 0 || length > code.size() - at) return {};
        module.read(code.subspan(at, length));
        at += length;
    }
    std::map<std::string, SpirvStruct> result;
    for (const auto& [id, memberTypes] : module.structs) {
        if (!module.offsets.contains({id, 0})) continue;
        SpirvStruct& item = result[module.names[id]];
        for (uint32_t i = 0; i < memberTypes.size(); ++i) {
            const std::string type =
                module.types.contains(memberTypes[i]) ? module.types[memberTypes[i]] : "other";
            item.members.push_back({module.memberNames[{id, i}], type, module.offsets[{id, i}]});
        }
        for (const auto& [array, element] : module.elements) {
            if (element == id && module.strides.contains(array)) item.arrayStride = module.strides[array];
        }
    }
    return result;
}

}  // namespace glint::render::test
