#include "fingerprint.h"

#include <unordered_map>

#include "gpu/spirv_code.h"

namespace glint::mutation {
namespace {

using namespace gpu::spirv;

// splitmix64 (Steele, Lea, Flood 2014) of what was and what comes.
uint64_t mixed(uint64_t hash, uint64_t word) {
    uint64_t z = hash * 0x9e3779b97f4a7c15u + word + 0x632be59bd9b4e019u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Of the globals of a module: which word is the id that it defines, and which are ids that it uses.
struct Places {
    size_t result = 0, firstId = 0, endOfIds = 0;
};

bool hasType(const Instruction& i) {
    return opOf(i) >= OpConstantTrue || opOf(i) == OpUndef;
}

Places placesOf(const Instruction& i) {
    constexpr uint32_t kExtInstImport = 11, kTypeImage = 25, kTypeRuntimeArray = 29, kTypeFunction = 33;
    const size_t size = i.size();
    switch (opOf(i)) {
        case kExtInstImport:
            return {1, size, size};
        case OpTypeVector:
        case kTypeImage:
        case kTypeRuntimeArray:
            return {1, 2, 3};
        case OpTypeArray:
        case OpTypeStruct:
        case kTypeFunction:
            return {1, 2, size};
        case OpTypePointer:
            return {1, 3, size};
        case OpConstantComposite:
            return {2, 3, size};
        case OpVariable:
            return {2, 4, size};
        default:
            return {hasType(i) ? size_t{2} : size_t{1}, size, size};
    }
}

class Fingerprint {
  public:
    explicit Fingerprint(std::span<const uint32_t> spirv) : code_(Code::read(spirv)) {
        constexpr uint32_t kMemberDecorate = 72;
        for (const Instruction& i : code_.globals)
            if (opOf(i) == OpDecorate || opOf(i) == kMemberDecorate) decorate(i);
        for (const Instruction& i : code_.globals) define(i);
    }

    uint64_t value() {
        for (const Function& function : code_.functions) {
            for (const Instruction& i : function.head) add(i);
            for (const Block& block : function.blocks)
                for (const Instruction& i : block.body) add(i);
        }
        return hash_;
    }

  private:
    void decorate(const Instruction& i) {
        uint64_t& hash = decorations_[i[1]];
        uint64_t one = 0;
        for (size_t at = 2; at < i.size(); ++at) one = mixed(one, i[at]);
        hash += one;  // in any order
    }

    void define(const Instruction& i) {
        constexpr uint32_t kFirst = OpTypeVoid, kLast = OpSpecConstantOp, kExtInstImport = 11;
        const uint32_t op = opOf(i);
        const bool defines =
            (op >= kFirst && op <= kLast) || op == OpVariable || op == OpUndef || op == kExtInstImport;
        if (!defines) {
            // What the module demands and how it is entered; ids of that are the functions' and variables'.
            constexpr uint32_t kExecutionMode = 16;
            if (op != kExecutionMode) return;
            for (size_t at = 2; at < i.size(); ++at) hash_ = mixed(hash_, i[at]);
            return;
        }
        const Places places = placesOf(i);
        uint64_t hash = mixed(op, decorations_[i[places.result]]);
        for (size_t at = 1; at < i.size(); ++at) {
            if (at == places.result) continue;
            const bool isId = (at >= places.firstId && at < places.endOfIds) || (hasType(i) && at == 1);
            hash = mixed(hash, isId ? meaningOf(i[at]) : i[at]);
        }
        meanings_[i[places.result]] = hash;
    }

    // Of a global what it is; of the others their order of appearance.
    uint64_t meaningOf(uint32_t id) {
        const auto [found, isNew] = meanings_.try_emplace(id, 0);
        if (isNew) found->second = mixed(++appeared_, decorations_[id]);
        return found->second;
    }

    void add(const Instruction& i) {
        hash_ = mixed(hash_, i[0]);
        const size_t result = resultPlace(i);
        for (size_t at = 1; at <= result; ++at) hash_ = mixed(hash_, meaningOf(i[at]));
        if (opOf(i) == OpFunction) {
            for (size_t at = 3; at < i.size(); ++at) hash_ = mixed(hash_, at == 4 ? meaningOf(i[at]) : i[at]);
            return;
        }
        if (opOf(i) == OpFunctionParameter) return;
        // All words but those that eachId calls ids are numbers.
        std::vector<bool> isId(i.size());
        Instruction places(i.size());
        for (uint32_t at = 0; at < places.size(); ++at) places[at] = at;
        places[0] = i[0];
        if (opOf(i) == OpExtInst) isId[3] = true;
        eachId(places, [&](uint32_t at) { isId[at] = true; });
        for (size_t at = result + 1; at < i.size(); ++at)
            hash_ = mixed(hash_, isId[at] ? meaningOf(i[at]) : i[at]);
    }

    Code code_;
    std::unordered_map<uint32_t, uint64_t> decorations_, meanings_;
    uint64_t hash_ = 0, appeared_ = 0;
};

}  // namespace

uint64_t fingerprintOf(std::span<const uint32_t> spirv) {
    return Fingerprint(spirv).value();
}

}  // namespace glint::mutation
