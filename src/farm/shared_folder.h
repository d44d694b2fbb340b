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
    // More than kMostFlat units lie in folders of kGroup each, so that a look at what is left costs as much
    // as there are processes, not as there are units: folders whose units are all there are not looked at
    // again, nor those that nobody has begun.
    static constexpr int kMostFlat = 1024, kGroup = 256;

    // Makes the folder if it is not there, and says in it which picture it is for, unless another process
    // has. Throws Error(Failed) if it is for another picture (and says in what), or cannot be used.
    SharedFolder(const std::filesystem::path& folder, const UnitHeader& header, double lease);

    // Units whose results were there when next() looked; at most UnitHeader::parts.
    int done() const { return done_; }
    bool complete() const { return done_ == header_.parts; }

    // Looks at the folder. A unit to draw, by its number from 1; nothing if all others are done or
    // somebody's. Of those the first that somebody has had for `patience` seconds, if that is given.
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
    std::string nameOfUnit(int part) const;  // below the folder
    std::filesystem::path resultPath(int part) const;
    std::optional<int> claimOne(std::optional<double> patience);
    bool look(int group, std::vector<Work>& works, std::vector<int>& parts);
    void remember(int part);

    const std::filesystem::path folder_;
    const UnitHeader header_;
    Claims claims_;
    const int groupSize_;
    std::vector<bool> there_;  // results, by number less 1
    std::vector<int> left_;    // units of each group whose results are not there
    int done_ = 0;
};

}  // namespace glint::farm
