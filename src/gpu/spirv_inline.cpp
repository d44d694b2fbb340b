// Calls replaced by the bodies of functions, and local variables by values: a part of specialize.h.
#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "gpu/specialize.h"

namespace glint::gpu::spirv {
namespace {

// Types and constants that a module's globals declare; gives new ids.
class Ids {
  public:
    explicit Ids(Code& code) : code_(code) {
        for (const Instruction& i : code.globals) {
            if (opOf(i) == OpTypePointer) pointees_[i[1]] = i[3];
            if (opOf(i) == OpConstant) constants_[i[2]] = i[3];
        }
    }

    uint32_t fresh() { return code_.header[kBound]++; }
    uint32_t pointeeOf(uint32_t pointerType) const { return pointees_.at(pointerType); }
    // Value of an integer constant; null for other ids.
    const uint32_t* constantOf(uint32_t id) const {
        const auto constant = constants_.find(id);
        return constant == constants_.end() ? nullptr : &constant->second;
    }
    uint32_t undefined(uint32_t type) {
        uint32_t& id = undefined_[type];
        if (id == 0) {
            id = fresh();
            code_.globals.push_back(make(OpUndef, {type, id}));
        }
        return id;
    }

  private:
    Code& code_;
    std::unordered_map<uint32_t, uint32_t> pointees_, constants_, undefined_;
};

// ---- Local variables ----

bool hasEffect(const Instruction& i) {
    const uint32_t op = opOf(i);
    return resultPlace(i) == 0 || op == OpLabel || op == OpFunctionCall ||
           (op >= OpAtomicExchange && op <= OpAtomicXor);
}

// Whatever a function stores to and loads from its own variables becomes values (M. Braun et al., "Simple and
// Efficient Construction of Static Single Assignment Form", CC 2013). Instructions whose results are then
// unused are removed. Variables that are passed to a function or have an index that is not constant remain.
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
    // A part of a variable, or all of it without indices.
    struct Place {
        uint32_t variable;
        std::vector<uint32_t> indices;
    };

    struct Phi {
        uint32_t id, variable;
        size_t block;
        std::vector<uint32_t> values;  // one for each predecessor
    };

    void findPlaces() {
        for (const Instruction& i : function_.blocks.front().body) {
            if (opOf(i) != OpVariable || i[3] != kFunction) continue;
            places_[i[2]] = {i[2], {}};
            types_[i[2]] = ids_.pointeeOf(i[1]);
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
            if (index == nullptr) {
                kept_.insert(place.variable);
                break;
            }
            place.indices.push_back(*index);
        }
        places_[chain[2]] = std::move(place);
    }

    // Null unless `pointer` is to a variable that becomes values.
    const Place* placeOf(uint32_t pointer) const {
        const auto place = places_.find(pointer);
        return place == places_.end() || kept_.contains(place->second.variable) ? nullptr : &place->second;
    }

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

    // Value of a variable at the end of the processed part of a block.
    uint32_t read(uint32_t variable, size_t block) {
        const auto known = defined_[block].find(variable);
        if (known != defined_[block].end()) return known->second;
        const std::vector<size_t>& before = before_[block];
        uint32_t value;
        if (before.empty()) {
            value = ids_.undefined(types_.at(variable));
        } else if (before.size() == 1 && processed_[before[0]]) {
            value = read(variable, before[0]);
        } else {
            value = ids_.fresh();
            phis_.push_back({value, variable, block, {}});
        }
        defined_[block][variable] = value;
        return value;
    }

    void turn(Instruction& i) {
        const uint32_t op = opOf(i);
        if (op == OpVariable || op == OpAccessChain) {
            if (placeOf(i[2]) == nullptr) add(std::move(i));
        } else if (const Place* place = op == OpLoad ? placeOf(i[3]) : nullptr) {
            load(i, *place);
        } else if (const Place* target = op == OpStore ? placeOf(i[1]) : nullptr) {
            store(i, *target);
        } else {
            add(std::move(i));
        }
    }

    void add(Instruction i) { function_.blocks[at_].body.push_back(std::move(i)); }

    void load(const Instruction& i, const Place& place) {
        const uint32_t value = read(place.variable, at_);
        if (place.indices.empty())
            replaced_[i[2]] = value;
        else
            add(make(OpCompositeExtract, joined({i[1], i[2], value}, place.indices)));
    }

    void store(const Instruction& i, const Place& place) {
        uint32_t value = i[2];
        if (!place.indices.empty()) {
            value = ids_.fresh();
            const uint32_t before = read(place.variable, at_);
            add(make(OpCompositeInsert,
                     joined({types_.at(place.variable), value, i[2], before}, place.indices)));
        }
        defined_[at_][place.variable] = value;
    }

    static std::vector<uint32_t> joined(std::vector<uint32_t> words, const std::vector<uint32_t>& more) {
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }

    void fillPhis() {
        for (size_t p = 0; p < phis_.size(); ++p) {  // read() may add more
            for (const size_t from : before_[phis_[p].block]) {
                const uint32_t value = read(phis_[p].variable, from);
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
            std::vector<uint32_t> words{types_.at(phi.variable), phi.id};
            for (size_t from = 0; from < phi.values.size(); ++from) {
                words.push_back(phi.values[from]);
                words.push_back(function_.blocks[before_[phi.block][from]].label);
            }
            std::vector<Instruction>& body = function_.blocks[phi.block].body;
            body.insert(body.begin() + 1, make(OpPhi, words));
        }
    }

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
    std::unordered_map<uint32_t, uint32_t> types_;                 // by variable
    std::vector<std::unordered_map<uint32_t, uint32_t>> defined_;  // by block and variable
    std::vector<Phi> phis_;
    std::unordered_map<uint32_t, uint32_t> replaced_;  // loads and trivial phis, by the value that they are
    size_t at_ = 0;                                    // current block
};

// ---- Calls ----

// The only return is at the end, so the last block can continue with what follows the call.
bool endsOnce(const Function& function) {
    size_t returns = 0;
    for (const Block& block : function.blocks) {
        const uint32_t op = opOf(block.terminator());
        if (op == OpReturn || op == OpReturnValue) ++returns;
    }
    const uint32_t last = opOf(function.blocks.back().terminator());
    return returns == 1 && (last == OpReturn || last == OpReturnValue);
}

class Inliner {
  public:
    explicit Inliner(Code& code) : code_(code), ids_(code) {
        for (Function& function : code_.functions) functions_[function.id()] = &function;
    }

    void run() {
        for (Function& function : code_.functions) inlineIn(function);
    }

  private:
    // The functions that it calls come first.
    void inlineIn(Function& function) {
        if (!done_.insert(function.id()).second) return;
        for (const Block& block : function.blocks)
            for (const Instruction& i : block.body)
                if (opOf(i) == OpFunctionCall) inlineIn(*functions_.at(i[3]));
        replaceCalls(function);
        Values(function, ids_).run();
    }

    void replaceCalls(Function& function) {
        blocks_.clear();
        variables_.clear();
        tails_.clear();
        std::unordered_set<uint32_t> own;  // labels
        for (const Block& block : function.blocks) own.insert(block.label);
        for (Block& block : function.blocks) copyBlock(block);
        for (Block& block : blocks_) {
            for (Instruction& i : block.body) {
                // The result of one call may be the argument of the next.
                eachId(i, [&](uint32_t& id) {
                    for (auto result = results_.find(id); result != results_.end();
                         result = results_.find(id))
                        id = result->second;
                });
                if (opOf(i) == OpPhi && own.contains(block.label)) comeFromTails(i);
            }
        }
        std::vector<Instruction>& first = blocks_.front().body;
        first.insert(first.begin() + 1, variables_.begin(), variables_.end());
        function.blocks = std::move(blocks_);
    }

    void comeFromTails(Instruction& phi) {
        for (size_t at = 4; at < phi.size(); at += 2)
            if (const auto tail = tails_.find(phi[at]); tail != tails_.end()) phi[at] = tail->second;
    }

    // glslang makes a block of its own of a loop's header, without calls.
    void copyBlock(Block& block) {
        const Instruction* merge = block.merge();
        const bool isHeader = merge && opOf(*merge) == OpLoopMerge;
        current_ = Block{block.label, {}};
        for (Instruction& i : block.body) {
            const Function* callee = opOf(i) == OpFunctionCall ? functions_.at(i[3]) : nullptr;
            if (!callee || !endsOnce(*callee)) {
                current_.body.push_back(std::move(i));
                continue;
            }
            if (isHeader) throw std::domain_error("a call in a loop's header in SPIR-V");
            insertBody(i, *callee);
        }
        if (current_.label != block.label) tails_[block.label] = current_.label;
        blocks_.push_back(std::move(current_));
    }

    void insertBody(const Instruction& call, const Function& callee) {
        std::unordered_map<uint32_t, uint32_t> names;  // ids of the callee, in this function
        for (size_t i = 1; i < callee.head.size(); ++i) names[callee.head[i][2]] = call[3 + i];
        for (const Block& block : callee.blocks)
            for (const Instruction& i : block.body)
                if (const size_t at = resultPlace(i)) names[i[at]] = ids_.fresh();
        names[callee.blocks.front().label] = current_.label;  // the first block continues the current one
        for (const Block& block : callee.blocks) {
            const uint32_t label = names[block.label];
            if (&block != &callee.blocks.front()) current_ = Block{label, {make(OpLabel, {label})}};
            for (size_t at = 1; at < block.body.size(); ++at) insert(call, block.body[at], names);
            if (&block != &callee.blocks.back()) blocks_.push_back(std::move(current_));
        }
    }

    void insert(const Instruction& call, Instruction i, const std::unordered_map<uint32_t, uint32_t>& names) {
        if (const size_t result = resultPlace(i)) i[result] = names.at(i[result]);
        eachId(i, [&](uint32_t& id) {
            if (const auto name = names.find(id); name != names.end()) id = name->second;
        });
        const uint32_t op = opOf(i);
        if (op == OpReturnValue) results_[call[2]] = i[1];
        if (op == OpVariable) {
            variables_.push_back(std::move(i));
        } else if (op != OpReturn && op != OpReturnValue) {
            current_.body.push_back(std::move(i));
        }
    }

    Code& code_;
    Ids ids_;
    std::unordered_map<uint32_t, Function*> functions_;
    std::unordered_set<uint32_t> done_;
    std::unordered_map<uint32_t, uint32_t> results_;  // of calls
    // Resulting code of the current function.
    std::vector<Block> blocks_;
    Block current_;
    std::vector<Instruction> variables_;  // of the functions that it called
    // Label of the last part of each divided block, by the label of the first part.
    std::unordered_map<uint32_t, uint32_t> tails_;
};

}  // namespace

void inlineCalls(Code& code) {
    Inliner(code).run();
}

}  // namespace glint::gpu::spirv
