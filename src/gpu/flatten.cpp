#include "gpu/flatten.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

#include "gpu/spirv_code.h"
#include "gpu/spirv_values.h"

namespace glint::gpu {
namespace {

using namespace spirv;

// One way out, at its end: the last block can go on with what follows the call.
bool endsOnce(const Function& function) {
    size_t returns = 0;
    for (const Block& block : function.blocks) {
        const uint32_t op = opOf(block.terminator());
        if (op == OpReturn || op == OpReturnValue) ++returns;
    }
    const uint32_t last = opOf(function.blocks.back().terminator());
    return returns == 1 && (last == OpReturn || last == OpReturnValue);
}

// Negations, sums, differences, products and quotients of floats, of vectors too (SPIR-V specification 1.3,
// section 3.32).
bool isFloatArithmetic(uint32_t op) {
    constexpr uint32_t kFNegate = 127, kFAdd = 129, kFSub = 131, kFMul = 133, kFDiv = 136, kFRem = 140,
                       kDot = 148;
    return op == kFNegate || op == kFAdd || op == kFSub || op == kFMul || op == kFDiv ||
           (op >= kFRem && op <= kDot);
}

class Flattener {
  public:
    explicit Flattener(Words spirv) : code_(Code::read(spirv)), ids_(code_) {
        for (size_t i = 0; i < code_.functions.size(); ++i) indexOf_[code_.functions[i].id()] = i;
        std::erase_if(code_.globals, [](const Instruction& i) {
            return opOf(i) == OpDecorate && i[2] == kDecorationNoContraction;
        });
    }

    std::vector<uint32_t> written() {
        for (Function& function : code_.functions) flattenOnce(function);
        code_.keepCalledFunctions();
        markArithmetic();
        code_.header[kBound] = ids_.bound();
        return code_.written();
    }

  private:
    // Those it calls come first.
    void flattenOnce(Function& function) {
        if (!done_.insert(function.id()).second) return;
        for (const Block& block : function.blocks)
            for (const Instruction& i : block.body)
                if (opOf(i) == OpFunctionCall) flattenOnce(called(i));
        putCallsIn(function);
        turnVariablesIntoValues(function, ids_, tables_);
    }

    Function& called(const Instruction& call) { return code_.functions[indexOf_.at(call[3])]; }

    void putCallsIn(Function& function) {
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
                    while (const uint32_t other = results_[id]) id = other;
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

    void copyBlock(Block& block) {
        const Instruction* merge = block.merge();
        const bool isHeader = merge && opOf(*merge) == OpLoopMerge;
        const bool isWholeLoop = isHeader && (*merge)[2] == block.label;
        Instruction loopMerge = isHeader ? *merge : Instruction{};
        bool apart = false;  // what follows the loop's header has blocks of its own
        current_ = Block{block.label, {}};
        for (Instruction& i : block.body) {
            const Function* callee = opOf(i) == OpFunctionCall ? &called(i) : nullptr;
            if (!callee || !endsOnce(*callee)) {
                if (apart && opOf(i) == OpLoopMerge) continue;
                // The way back of what was a block by itself.
                const bool goesBack = apart && isWholeLoop && &i == &block.body.back();
                if (goesBack) endBlock(make(OpBranch, {loopMerge[2]}), loopMerge[2]);
                current_.body.push_back(std::move(i));
                continue;
            }
            if (callee->blocks.size() > 1 && isHeader && !apart) {
                apart = true;
                if (isWholeLoop) loopMerge[2] = ids_.fresh();
                const uint32_t next = ids_.fresh();
                current_.body.push_back(loopMerge);
                endBlock(make(OpBranch, {next}), next);
            }
            putIn(i, *callee);
        }
        if (current_.label != block.label) tails_[block.label] = current_.label;
        blocks_.push_back(std::move(current_));
    }

    void endBlock(Instruction terminator, uint32_t next) {
        current_.body.push_back(std::move(terminator));
        blocks_.push_back(std::move(current_));
        current_ = Block{next, {make(OpLabel, {next})}};
    }

    // The body of a function in the place of a call.
    void putIn(const Instruction& call, const Function& callee) {
        for (size_t i = 1; i < callee.head.size(); ++i) names_.set(callee.head[i][2], call[3 + i]);
        for (const Block& block : callee.blocks) {
            for (const Instruction& i : block.body) {
                if (const size_t at = resultPlace(i)) names_.set(i[at], ids_.fresh());
            }
        }
        names_.set(callee.blocks.front().label, current_.label);  // which it goes on with
        for (const Block& block : callee.blocks) {
            const uint32_t label = names_[block.label];
            if (&block != &callee.blocks.front()) current_ = Block{label, {make(OpLabel, {label})}};
            for (size_t at = 1; at < block.body.size(); ++at) putIn(call, block.body[at]);
            if (&block != &callee.blocks.back()) blocks_.push_back(std::move(current_));
        }
    }

    void putIn(const Instruction& call, Instruction i) {
        if (const size_t result = resultPlace(i)) i[result] = names_[i[result]];
        eachId(i, [&](uint32_t& id) {
            if (const uint32_t name = names_[id]) id = name;
        });
        const uint32_t op = opOf(i);
        if (op == OpReturnValue) results_.set(call[2], i[1]);
        if (op == OpVariable) {
            variables_.push_back(std::move(i));
        } else if (op != OpReturn && op != OpReturnValue) {
            current_.body.push_back(std::move(i));
        }
    }

    // A driver may then neither fuse nor reorder float arithmetic. Decorations stand before the types.
    void markArithmetic() {
        std::vector<Instruction> marks;
        for (const Function& function : code_.functions)
            for (const Block& block : function.blocks)
                for (const Instruction& i : block.body)
                    if (isFloatArithmetic(opOf(i)))
                        marks.push_back(make(OpDecorate, {i[2], kDecorationNoContraction}));
        const auto types = std::find_if(code_.globals.begin(), code_.globals.end(), [](const Instruction& i) {
            return opOf(i) >= OpTypeVoid && opOf(i) <= OpTypeForwardPointer;
        });
        code_.globals.insert(types, marks.begin(), marks.end());
    }

    Code code_;
    Ids ids_;
    Tables tables_;
    std::unordered_map<uint32_t, size_t> indexOf_;  // of functions
    std::unordered_set<uint32_t> done_;
    Table names_;    // of what is in the function that is put in the place of a call
    Table results_;  // of calls
    // Resulting code of the current function.
    std::vector<Block> blocks_;
    Block current_;
    std::vector<Instruction> variables_;  // of functions called
    // Label of the last part of each divided block, by the label of the first part.
    std::unordered_map<uint32_t, uint32_t> tails_;
};

}  // namespace

std::vector<uint32_t> flatten(std::span<const uint32_t> spirv) {
    return Flattener(spirv).written();
}

}  // namespace glint::gpu
