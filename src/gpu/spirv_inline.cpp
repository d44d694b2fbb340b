#include "gpu/spirv_inline.h"

#include <unordered_set>
#include <utility>

namespace glint::gpu::spirv {

namespace {

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
    Inliner(Code& code, Ids& ids) : code_(code), ids_(ids) {
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
        turnVariablesIntoValues(function, ids_);
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

    void copyBlock(Block& block) {
        const Instruction* merge = block.merge();
        const bool isHeader = merge && opOf(*merge) == OpLoopMerge;
        const bool isWholeLoop = isHeader && (*merge)[2] == block.label;
        Instruction loopMerge = isHeader ? *merge : Instruction{};
        bool apart = false;  // the loop's header ends before this instruction
        current_ = Block{block.label, {}};
        for (Instruction& i : block.body) {
            const Function* callee = opOf(i) == OpFunctionCall ? functions_.at(i[3]) : nullptr;
            if (!callee || !endsOnce(*callee)) {
                if (apart && opOf(i) == OpLoopMerge) continue;
                // A loop of one block needs a continue target of its own once it has several.
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
            insertBody(i, *callee);
        }
        if (current_.label != block.label) tails_[block.label] = current_.label;
        blocks_.push_back(std::move(current_));
    }

    void endBlock(Instruction terminator, uint32_t next) {
        current_.body.push_back(std::move(terminator));
        blocks_.push_back(std::move(current_));
        current_ = Block{next, {make(OpLabel, {next})}};
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
    Ids& ids_;
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

void inlineCalls(Code& code, Ids& ids) {
    Inliner(code, ids).run();
}

}  // namespace glint::gpu::spirv
