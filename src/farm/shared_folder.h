// A picture that any number of processes draw together by a folder that all of them see (farm/claims.h).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "farm/claims.h"
#include "farm/unit_file.h"

namespace glint::farm {

class SharedFolder {
  public:
    // Makes the folder if it is not there, and says in it which picture it is for, unless another process
    // has. Throws Error(Failed) if it is for another picture (and says in what), or cannot be used.
    SharedFolder(const std::filesystem::path& folder, const UnitHeader& header, double lease);

    // Units whose results are there; at most UnitHeader::parts.
    int done();
    bool complete() { return done() == header_.parts; }

    // A unit to draw, by its number from 1; nothing if all others are done or somebody's. Of those the first
    // that somebody has had for `patience` seconds, if that is given.
    std::optional<int> next(std::optional<double> patience = std::nullopt);
    // Its result is there.
    bool has(int part) const;
    // Its result, for all to see.
    void put(const UnitResult& result);
    // What next() gave is not drawn; another may have it.
    void giveUp() { claims_.release(); }

    // True if it is this process that writes the picture, once it is complete.
    bool mayMerge();
    // Calls it with all results, in the order in which they stand in the picture. Throws Error(Failed) for
    // one that is damaged.
    void forEach(const std::function<void(const UnitResult&)>& add) const;
    // What was said when the picture was written, if it was.
    std::optional<std::string> note() const;
    void setNote(const std::string& text);

  private:
    std::filesystem::path resultPath(int part) const;

    const std::filesystem::path folder_;
    const UnitHeader header_;
    Claims claims_;
    std::vector<bool> there_;  // results, by number less 1
};

}  // namespace glint::farm
