#include "gpu/spirv_values.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace glint::gpu::spirv {

namespace {

// A part of a variable: leaf `slot` and those that follow it, or what `rest` leads to within that leaf.
struct Place {
    uint32_t variable;
    uint32_t slot;
    uint32_t type;
    std::vector<uint32_t> rest;
};

struct Structure {
    uint32_t type;
    std::vector<uint32_t> leaves;
};

struct Phi {
    uint32_t id;
    uint32_t slot;
    size_t block;
    std::vector<uint32_t> values;  // one for each predecessor
};

bool hasEffect(const Instruction& i) {
    const uint32_t op = opOf(i);
    return resultPlace(i) == 0 || op == OpLabel || op == OpFunctionCall ||
           (op >= OpAtomicExchange && op <= OpAtomicXor);
}

class Values {
  public:
    Values(Function& function, Ids& ids)
        : function_(function),
          ids_(ids),
          before_(function.blocks.size()),
          processed_(function.blocks.size()),
          defined_(function.blocks.size()) {}

    void run() {
        findPlaces();
        findPredecessors();
        for (at_ = 0; at_ < function_.blocks.size(); ++at_) {
            for (Instruction& i : std::exchange(function_.blocks[at_].body, {})) turn(i);
            processed_[at_] = true;
        }
        fillPhis();
        dropTrivialPhis();
        addPhis();
        keepUsed();
    }

  private:
    // ---- Which variables ----

    void findPlaces() {
        for (const Instruction& i : function_.blocks.front().body) {
            if (opOf(i) != OpVariable || i[3] != kFunction) continue;
            const uint32_t type = ids_.pointeeOf(i[1]);
            places_[i[2]] = {i[2], static_cast<uint32_t>(slotTypes_.size()), type, {}};
            const std::vector<uint32_t>& leaves = ids_.leavesOf(type);
            slotTypes_.insert(slotTypes_.end(), leaves.begin(), leaves.end());
        }
        for (const Block& block : function_.blocks) {
            for (const Instruction& i : block.body) {
                const uint32_t op = opOf(i);
                if (op == OpAccessChain) findPlace(i);
                if (op == OpAccessChain || op == OpLoad || op == OpStore) continue;
                eachId(i, [&](uint32_t id) {
                    if (const auto place = places_.find(id); place != places_.end())
                        kept_.insert(place->second.variable);
                });
            }
        }
    }

    void findPlace(const Instruction& chain) {
        const auto base = places_.find(chain[3]);
        if (base == places_.end()) return;
        Place place = base->second;
        for (size_t at = 4; at < chain.size(); ++at) {
            const uint32_t* index = ids_.constantOf(chain[at]);
            const uint32_t part = index ? ids_.partOf(place.type, *index) : 0;
            if (part == 0) {
                kept_.insert(place.variable);
                return;
            }
            if (place.rest.empty() && ids_.isStruct(place.type)) {
                place.slot += leavesBefore(place.type, *index);
            } else {
                place.rest.push_back(*index);
            }
            place.type = part;
        }
        places_[chain[2]] = std::move(place);
    }

    uint32_t leavesBefore(uint32_t type, uint32_t member) {
        size_t before = 0;
        for (uint32_t m = 0; m < member; ++m) before += ids_.leavesOf(ids_.membersOf(type)[m]).size();
        return static_cast<uint32_t>(before);
    }

    // Null unless `pointer` is to a variable that becomes values.
    const Place* placeOf(uint32_t pointer) const {
        const auto place = places_.find(pointer);
        return place == places_.end() || kept_.contains(place->second.variable) ? nullptr : &place->second;
    }

    // ---- Their values ----

    void findPredecessors() {
        std::unordered_map<uint32_t, size_t> byLabel;
        for (size_t b = 0; b < function_.blocks.size(); ++b) byLabel[function_.blocks[b].label] = b;
        for (size_t b = 0; b < function_.blocks.size(); ++b) {
            for (const uint32_t next : function_.blocks[b].successors()) {
                std::vector<size_t>& before = before_[byLabel.at(next)];
                if (std::find(before.begin(), before.end(), b) == before.end()) before.push_back(b);
            }
        }
    }

    // Value of a leaf at the end of the processed part of a block.
    uint32_t read(uint32_t slot, size_t block) {
        const auto known = defined_[block].find(slot);
        if (known != defined_[block].end()) return known->second;
        const std::vector<size_t>& before = before_[block];
        uint32_t value;
        if (before.empty()) {
            value = ids_.undefined(slotTypes_[slot]);
        } else if (before.size() == 1 && processed_[before[0]]) {
            value = read(slot, before[0]);
        } else {
            value = ids_.fresh();
            phis_.push_back({value, slot, block, {}});
        }
        defined_[block][slot] = value;
        return value;
    }

    void fillPhis() {
        for (size_t p = 0; p < phis_.size(); ++p) {  // read() may add more
            for (const size_t from : before_[phis_[p].block]) {
                const uint32_t value = read(phis_[p].slot, from);
                phis_[p].values.push_back(value);
            }
        }
    }

    // If all values of a phi except itself are equal, that value replaces the phi.
    void dropTrivialPhis() {
        const auto isTrivial = [&](const Phi& phi) {
            uint32_t same = 0;
            for (const uint32_t value : phi.values) {
                const uint32_t id = resolved(value);
                if (id == phi.id || id == same) continue;
                if (same != 0) return false;
                same = id;
            }
            if (same != 0) replaced_[phi.id] = same;
            return same != 0;
        };
        while (std::erase_if(phis_, isTrivial) != 0) {
        }
    }

    // The id that replaces `id`.
    uint32_t resolved(uint32_t id) {
        const auto first = replaced_.find(id);
        if (first == replaced_.end()) return id;
        return first->second = resolved(first->second);
    }

    void addPhis() {
        for (const Phi& phi : phis_) {
            std::vector<uint32_t> words{slotTypes_[phi.slot], phi.id};
            for (size_t from = 0; from < phi.values.size(); ++from) {
                words.push_back(phi.values[from]);
                words.push_back(function_.blocks[before_[phi.block][from]].label);
            }
            std::vector<Instruction>& body = function_.blocks[phi.block].body;
            body.insert(body.begin() + 1, make(OpPhi, words));
        }
    }

    std::vector<Instruction>& body() { return function_.blocks[at_].body; }

    // ---- Instruction by instruction ----

    void turn(Instruction& i) {
        const Place* place = nullptr;
        switch (opOf(i)) {
            case OpVariable:
            case OpAccessChain:
                if (!placeOf(i[2])) keep(i);
                return;
            case OpLoad:
                place = placeOf(i[3]);
                place ? load(i, *place) : keep(i);
                return;
            case OpStore:
                place = placeOf(i[1]);
                place ? store(i, *place) : keep(i);
                return;
            case OpCompositeConstruct:
                construct(i);
                return;
            case OpCompositeExtract:
                extract(i);
                return;
            case OpCompositeInsert:
                insert(i);
                return;
            case OpPhi:
                if (ids_.isStruct(i[1])) throw std::domain_error("a phi of structures in SPIR-V");
                [[fallthrough]];
            default:
                keep(i);
        }
    }

    // Structures that are operands are put together, one that is the result is taken apart.
    void keep(Instruction& i) {
        if (opOf(i) != OpPhi) {
            eachId(i, [&](uint32_t& id) {
                const Structure* structure = structureOf(id);
                if (!structure) return;
                const uint32_t* leaf = structure->leaves.data();
                id = together(structure->type, leaf);
            });
        }
        const bool isStruct = resultPlace(i) == 2 && i.size() > 2 && ids_.isStruct(i[1]);
        const uint32_t type = isStruct ? i[1] : 0, id = isStruct ? i[2] : 0;
        body().push_back(std::move(i));
        if (isStruct) addStructure(id, {type, apart(type, id)});
    }

    void addStructure(uint32_t id, Structure structure) { structures_[id] = std::move(structure); }

    const Structure* structureOf(uint32_t id) const {
        const auto structure = structures_.find(id);
        return structure == structures_.end() ? nullptr : &structure->second;
    }

    uint32_t together(uint32_t type, const uint32_t*& leaf) {
        if (!ids_.isStruct(type)) return *leaf++;
        std::vector<uint32_t> words{type, ids_.fresh()};
        for (const uint32_t member : ids_.membersOf(type)) words.push_back(together(member, leaf));
        body().push_back(make(OpCompositeConstruct, words));
        return words[1];
    }

    std::vector<uint32_t> apart(uint32_t type, uint32_t id) {
        if (!ids_.isStruct(type)) return {id};
        std::vector<uint32_t> leaves;
        const std::vector<uint32_t>& members = ids_.membersOf(type);
        for (uint32_t m = 0; m < members.size(); ++m) {
            const uint32_t part = ids_.fresh();
            body().push_back(make(OpCompositeExtract, {members[m], part, id, m}));
            const std::vector<uint32_t> more = apart(members[m], part);
            leaves.insert(leaves.end(), more.begin(), more.end());
        }
        return leaves;
    }

    std::vector<uint32_t> leaves(uint32_t id, uint32_t type) {
        if (!ids_.isStruct(type)) return {id};
        const Structure* structure = structureOf(id);
        return structure ? structure->leaves : ids_.leavesOfConstant(id, type);
    }

    void load(const Instruction& i, const Place& place) {
        if (!place.rest.empty()) {
            std::vector<uint32_t> words{i[1], i[2], read(place.slot, at_)};
            words.insert(words.end(), place.rest.begin(), place.rest.end());
            Instruction part = make(OpCompositeExtract, words);
            extract(part);
        } else if (ids_.isStruct(i[1])) {
            Structure structure{i[1], {}};
            for (uint32_t leaf = 0; leaf < ids_.leavesOf(i[1]).size(); ++leaf)
                structure.leaves.push_back(read(place.slot + leaf, at_));
            addStructure(i[2], std::move(structure));
        } else {
            replaced_[i[2]] = read(place.slot, at_);
        }
    }

    void store(Instruction& i, const Place& place) {
        if (place.rest.empty()) {
            uint32_t slot = place.slot;
            for (const uint32_t leaf : leaves(i[2], place.type)) defined_[at_][slot++] = leaf;
            return;
        }
        const uint32_t whole = ids_.fresh();
        std::vector<uint32_t> words{slotTypes_[place.slot], whole, i[2], read(place.slot, at_)};
        words.insert(words.end(), place.rest.begin(), place.rest.end());
        Instruction with = make(OpCompositeInsert, words);
        keep(with);
        defined_[at_][place.slot] = whole;
    }

    void construct(Instruction& i) {
        if (!ids_.isStruct(i[1])) {
            if (i.size() - 3 == ids_.componentsOf(i[1])) vectors_[i[2]] = {i.begin() + 3, i.end()};
            keep(i);
            return;
        }
        Structure structure{i[1], {}};
        const std::vector<uint32_t>& members = ids_.membersOf(i[1]);
        for (size_t m = 0; m < members.size(); ++m) {
            const std::vector<uint32_t> more = leaves(i[3 + m], members[m]);
            structure.leaves.insert(structure.leaves.end(), more.begin(), more.end());
        }
        addStructure(i[2], std::move(structure));
    }

    // Follows the indices into a structure as far as it goes; returns where the next one is.
    size_t follow(const Instruction& i, size_t at, uint32_t& type, uint32_t& leaf) {
        for (; at < i.size() && ids_.isStruct(type); ++at) {
            leaf += leavesBefore(type, i[at]);
            type = ids_.membersOf(type)[i[at]];
        }
        return at;
    }

    void extract(Instruction& i) {
        i[3] = resolved(i[3]);
        const Structure* structure = structureOf(i[3]);
        if (!structure) {
            const auto vector = vectors_.find(i[3]);
            if (vector != vectors_.end() && i.size() == 5) {
                replaced_[i[2]] = vector->second[i[4]];
            } else {
                keep(i);
            }
            return;
        }
        uint32_t type = structure->type, leaf = 0;
        const size_t at = follow(i, 4, type, leaf);
        const auto first = structure->leaves.begin() + leaf;
        if (at < i.size()) {
            std::vector<uint32_t> words{i[1], i[2], *first};
            words.insert(words.end(), i.begin() + static_cast<std::ptrdiff_t>(at), i.end());
            Instruction rest = make(OpCompositeExtract, words);
            extract(rest);
        } else if (ids_.isStruct(type)) {
            Structure part{type, {first, first + static_cast<std::ptrdiff_t>(ids_.leavesOf(type).size())}};
            addStructure(i[2], std::move(part));
        } else {
            replaced_[i[2]] = *first;
        }
    }

    void insert(Instruction& i) {
        if (!ids_.isStruct(i[1])) {
            keep(i);
            return;
        }
        Structure structure{i[1], leaves(i[4], i[1])};
        uint32_t type = i[1], leaf = 0;
        if (follow(i, 5, type, leaf) < i.size()) throw std::domain_error("a deep insertion in SPIR-V");
        const std::vector<uint32_t> part = leaves(i[3], type);
        std::copy(part.begin(), part.end(), structure.leaves.begin() + leaf);
        addStructure(i[2], std::move(structure));
    }

    // ---- Used instructions ----

    void keepUsed() {
        std::unordered_map<uint32_t, Instruction*> makers;
        std::unordered_set<uint32_t> used;
        std::vector<Instruction*> pending;
        for (Block& block : function_.blocks) {
            for (Instruction& i : block.body) {
                if (hasEffect(i))
                    pending.push_back(&i);
                else
                    makers[i[2]] = &i;
            }
        }
        while (!pending.empty()) {
            Instruction& user = *pending.back();
            pending.pop_back();
            eachId(user, [&](uint32_t& id) {
                id = resolved(id);
                const auto maker = makers.find(id);
                if (maker != makers.end() && used.insert(id).second) pending.push_back(maker->second);
            });
        }
        for (Block& block : function_.blocks)
            std::erase_if(block.body,
                          [&](const Instruction& i) { return !hasEffect(i) && !used.contains(i[2]); });
    }

    Function& function_;
    Ids& ids_;
    std::unordered_map<uint32_t, Place> places_;                   // by pointer
    std::unordered_set<uint32_t> kept_;                            // variables that remain
    std::vector<std::vector<size_t>> before_;                      // predecessors, by block
    std::vector<bool> processed_;                                  // by block
    std::vector<uint32_t> slotTypes_;                              // of all leaves of all variables
    std::vector<std::unordered_map<uint32_t, uint32_t>> defined_;  // by block and slot
    std::unordered_map<uint32_t, Structure> structures_;           // by id
    std::unordered_map<uint32_t, std::vector<uint32_t>> vectors_;  // components of constructed vectors
    std::vector<Phi> phis_;
    std::unordered_map<uint32_t, uint32_t> replaced_;  // loads and trivial phis, by the value that they are
    size_t at_ = 0;                                    // current block
};

}  // namespace

void turnVariablesIntoValues(Function& function, Ids& ids) {
    Values(function, ids).run();
}

}  // namespace glint::gpu::spirv
