#include "gpu/spirv_values.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

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

struct Definition {
    uint32_t block;
    uint32_t value;  // at the end of what is known of the block
};

struct Phi {
    uint32_t id;
    uint32_t slot;
    size_t block;
    std::vector<uint32_t> values;  // one for each predecessor
    bool trivial = false;
};

bool hasEffect(const Instruction& i) {
    const uint32_t op = opOf(i);
    return resultPlace(i) == 0 || op == OpLabel || op == OpFunctionCall ||
           (op >= OpAtomicExchange && op <= OpAtomicXor);
}

class Values {
  public:
    Values(Function& function, Ids& ids, Tables& tables)
        : function_(function),
          ids_(ids),
          pointers_(tables.pointers),
          forward_(tables.forward),
          structured_(tables.structured),
          live_(tables.live),
          makers_(tables.makers) {}

    void run() {
        findPlaces();
        findPredecessors();
        for (at_ = 0; at_ < function_.blocks.size(); ++at_) {
            body_.clear();
            for (Instruction& i : function_.blocks[at_].body) turn(i);
            function_.blocks[at_].body.swap(body_);
            processed_[at_] = true;
        }
        fillPhis();
        dropTrivialPhis();
        keepLive();
    }

  private:
    // ---- Which variables ----

    void findPlaces() {
        for (const Instruction& i : function_.blocks.front().body) {
            if (opOf(i) != OpVariable || i[3] != kFunction) continue;
            const uint32_t type = ids_.pointeeOf(i[1]);
            addPlace(i[2], {i[2], static_cast<uint32_t>(slotTypes_.size()), type, {}});
            const std::vector<uint32_t>& leaves = ids_.leavesOf(type);
            slotTypes_.insert(slotTypes_.end(), leaves.begin(), leaves.end());
        }
        defined_.resize(slotTypes_.size());
        for (const Block& block : function_.blocks) {
            for (const Instruction& i : block.body) {
                const uint32_t op = opOf(i);
                if (op == OpAccessChain) lookInto(i);
                if (op == OpAccessChain || op == OpLoad || op == OpStore) continue;
                eachId(i, [&](uint32_t id) {
                    if (pointers_[id] != 0) keepVariable(id);
                });
            }
        }
    }

    void keepVariable(uint32_t pointer) { kept_.insert(places_[pointers_[pointer] - 1].variable); }

    void addPlace(uint32_t pointer, Place place) {
        places_.push_back(std::move(place));
        pointers_.set(pointer, static_cast<uint32_t>(places_.size()));
    }

    void lookInto(const Instruction& chain) {
        if (pointers_[chain[3]] == 0) return;
        Place place = places_[pointers_[chain[3]] - 1];
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
        addPlace(chain[2], std::move(place));
    }

    uint32_t leavesBefore(uint32_t type, uint32_t member) {
        size_t before = 0;
        for (uint32_t m = 0; m < member; ++m) before += ids_.leavesOf(ids_.membersOf(type)[m]).size();
        return static_cast<uint32_t>(before);
    }

    const Place* placeOf(uint32_t pointer) const {
        const uint32_t number = pointers_[pointer];
        return number == 0 || kept_.contains(places_[number - 1].variable) ? nullptr : &places_[number - 1];
    }

    // ---- What they hold ----

    void findPredecessors() {
        const size_t count = function_.blocks.size();
        std::unordered_map<uint32_t, size_t> byLabel;
        for (size_t b = 0; b < count; ++b) byLabel[function_.blocks[b].label] = b;
        before_.resize(count);
        processed_.resize(count);
        for (size_t b = 0; b < count; ++b) {
            for (const uint32_t next : function_.blocks[b].successors()) {
                std::vector<size_t>& before = before_[byLabel.at(next)];
                if (std::find(before.begin(), before.end(), b) == before.end()) before.push_back(b);
            }
        }
    }

    // Value of a leaf at the end of the known part of a block.
    uint32_t read(uint32_t slot, size_t block) {
        if (const uint32_t known = defined(slot, block)) return known;
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
        defined_[slot].push_back({static_cast<uint32_t>(block), value});
        return value;
    }

    uint32_t& defined(uint32_t slot, size_t block) {
        // The block at hand is among the last.
        const auto end = defined_[slot].rend();
        const auto found = std::find_if(defined_[slot].rbegin(), end,
                                        [&](const Definition& known) { return known.block == block; });
        return found == end ? none_ : found->value;
    }

    void write(uint32_t slot, uint32_t value) {
        uint32_t& known = defined(slot, at_);
        if (known != 0) {
            known = value;
        } else {
            defined_[slot].push_back({static_cast<uint32_t>(at_), value});
        }
    }

    void fillPhis() {
        for (size_t p = 0; p < phis_.size(); ++p) {  // which may add more
            const uint32_t slot = phis_[p].slot;
            for (const size_t from : before_[phis_[p].block]) {
                const uint32_t value = read(slot, from);
                phis_[p].values.push_back(value);
            }
        }
    }

    // One whose values are all the same but for itself is that value.
    void dropTrivialPhis() {
        for (bool changed = true; changed;) {
            changed = false;
            for (Phi& phi : phis_) {
                if (phi.trivial) continue;
                uint32_t same = 0;
                bool differ = false;
                for (uint32_t& value : phi.values) {
                    value = resolved(value);
                    if (value == phi.id || value == same) continue;
                    differ = differ || same != 0;
                    same = value;
                }
                if (differ || same == 0) continue;
                forward_.set(phi.id, same);
                phi.trivial = changed = true;
            }
        }
    }

    uint32_t resolved(uint32_t id) {
        const uint32_t next = forward_[id];
        if (next == 0) return id;
        uint32_t last = next;
        while (const uint32_t more = forward_[last]) last = more;
        if (last != next) forward_.set(id, last);
        return last;
    }

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
        body_.push_back(std::move(i));
        if (isStruct) addStructure(id, {type, apart(type, id)});
    }

    void addStructure(uint32_t id, Structure structure) {
        structures_.push_back(std::move(structure));
        structured_.set(id, static_cast<uint32_t>(structures_.size()));
    }

    const Structure* structureOf(uint32_t id) const {
        const uint32_t number = structured_[id];
        return number == 0 ? nullptr : &structures_[number - 1];
    }

    uint32_t together(uint32_t type, const uint32_t*& leaf) {
        if (!ids_.isStruct(type)) return *leaf++;
        std::vector<uint32_t> words{type, ids_.fresh()};
        for (const uint32_t member : ids_.membersOf(type)) words.push_back(together(member, leaf));
        body_.push_back(make(OpCompositeConstruct, words));
        return words[1];
    }

    std::vector<uint32_t> apart(uint32_t type, uint32_t id) {
        if (!ids_.isStruct(type)) return {id};
        std::vector<uint32_t> leaves;
        const std::vector<uint32_t>& members = ids_.membersOf(type);
        for (uint32_t m = 0; m < members.size(); ++m) {
            const uint32_t part = ids_.fresh();
            body_.push_back(make(OpCompositeExtract, {members[m], part, id, m}));
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
            Instruction part = make(OpCompositeExtract, {i[1], i[2], read(place.slot, at_)});
            part.insert(part.end(), place.rest.begin(), place.rest.end());
            part[0] = OpCompositeExtract | static_cast<uint32_t>(part.size()) << 16;
            extract(part);
        } else if (ids_.isStruct(i[1])) {
            Structure structure{i[1], {}};
            for (uint32_t leaf = 0; leaf < ids_.leavesOf(i[1]).size(); ++leaf)
                structure.leaves.push_back(read(place.slot + leaf, at_));
            addStructure(i[2], std::move(structure));
        } else {
            forward_.set(i[2], read(place.slot, at_));
        }
    }

    void store(Instruction& i, const Place& place) {
        if (place.rest.empty()) {
            uint32_t slot = place.slot;
            for (const uint32_t leaf : leaves(i[2], place.type)) write(slot++, leaf);
            return;
        }
        const uint32_t whole = ids_.fresh();
        Instruction with =
            make(OpCompositeInsert, {slotTypes_[place.slot], whole, i[2], read(place.slot, at_)});
        with.insert(with.end(), place.rest.begin(), place.rest.end());
        with[0] = OpCompositeInsert | static_cast<uint32_t>(with.size()) << 16;
        keep(with);
        write(place.slot, whole);
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
                forward_.set(i[2], vector->second[i[4]]);
            } else {
                keep(i);
            }
            return;
        }
        uint32_t type = structure->type, leaf = 0;
        const size_t at = follow(i, 4, type, leaf);
        const auto first = structure->leaves.begin() + leaf;
        if (at < i.size()) {
            Instruction rest{0, i[1], i[2], *first};
            rest.insert(rest.end(), i.begin() + static_cast<std::ptrdiff_t>(at), i.end());
            rest[0] = OpCompositeExtract | static_cast<uint32_t>(rest.size()) << 16;
            extract(rest);
        } else if (ids_.isStruct(type)) {
            Structure part{type, {first, first + static_cast<std::ptrdiff_t>(ids_.leavesOf(type).size())}};
            addStructure(i[2], std::move(part));
        } else {
            forward_.set(i[2], *first);
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

    // ---- What is used ----

    void use(uint32_t id) {
        if (live_[id]) return;
        live_.set(id, 1);
        pending_.push_back(id);
    }

    void useOperands(Instruction& i) {
        eachId(i, [&](uint32_t& id) { use(id = resolved(id)); });
    }

    void keepLive() {
        std::vector<Instruction*> makers;
        for (Block& block : function_.blocks) {
            for (Instruction& i : block.body) {
                if (hasEffect(i)) {
                    useOperands(i);
                } else {
                    makers.push_back(&i);
                    makers_.set(i[2], static_cast<uint32_t>(makers.size()));
                }
            }
        }
        for (uint32_t p = 0; p < phis_.size(); ++p)
            makers_.set(phis_[p].id, static_cast<uint32_t>(makers.size()) + p + 1);
        while (!pending_.empty()) {
            const uint32_t maker = makers_[pending_.back()];
            pending_.pop_back();
            if (maker > makers.size()) {
                for (uint32_t& value : phis_[maker - makers.size() - 1].values) use(value = resolved(value));
            } else if (maker != 0) {
                useOperands(*makers[maker - 1]);
            }
        }
        for (Block& block : function_.blocks)
            std::erase_if(block.body, [&](const Instruction& i) { return !hasEffect(i) && !live_[i[2]]; });
        addPhis();
    }

    void addPhis() {
        for (const Phi& phi : phis_) {
            if (phi.trivial || !live_[phi.id]) continue;
            std::vector<uint32_t> words{slotTypes_[phi.slot], phi.id};
            for (size_t from = 0; from < phi.values.size(); ++from) {
                words.push_back(phi.values[from]);
                words.push_back(function_.blocks[before_[phi.block][from]].label);
            }
            std::vector<Instruction>& body = function_.blocks[phi.block].body;
            body.insert(body.begin() + 1, make(OpPhi, words));
        }
    }

    Function& function_;
    Ids& ids_;
    std::vector<Place> places_;
    Table& pointers_;                               // by pointer, the number of its place from 1 on
    std::unordered_set<uint32_t> kept_;             // variables that stay
    std::vector<uint32_t> slotTypes_;               // of all leaves of all variables
    std::vector<std::vector<size_t>> before_;       // predecessors
    std::vector<std::vector<Definition>> defined_;  // by slot
    uint32_t none_ = 0;
    std::vector<bool> processed_;
    std::vector<Phi> phis_;
    Table& forward_;  // what an id is the same as
    std::vector<Structure> structures_;
    Table& structured_;  // by id, the number of its structure from 1 on
    std::unordered_map<uint32_t, std::vector<uint32_t>> vectors_;  // that are put together of numbers
    Table& live_;
    Table& makers_;  // by id, the number from 1 on of the instruction, or of the phi after all of those
    std::vector<uint32_t> pending_;
    // Index and new body of the current block.
    size_t at_ = 0;
    std::vector<Instruction> body_;
};

}  // namespace

void turnVariablesIntoValues(Function& function, Ids& ids, Tables& tables) {
    Values(function, ids, tables).run();
}

}  // namespace glint::gpu::spirv
