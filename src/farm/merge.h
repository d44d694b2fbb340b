// Units put together to pictures.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "farm/unit_file.h"

namespace glint::farm {

// A picture that grows by its units, in any order: pixels are copied, never computed with, so it has the bits
// of one that was drawn at once. Only the sums in Picture::losses depend on the order, in their last digits.
class Assembly {
  public:
    Assembly(const Region& whole, const std::vector<Aov>& aovs);

    // Throws Error(Failed) if some of its pixels are there already.
    void add(const UnitResult& result);
    bool complete() const { return missing_ == 0; }
    // Pixels that are there, of all.
    double share() const;

    // With color, done, losses and notFinite; nothing else.
    const Picture& picture() const { return picture_; }
    // In the order of the AOVs. Takes them out of the assembly.
    std::vector<Layer> takeLayers();

  private:
    std::vector<Aov> aovs_;
    Picture picture_;
    std::vector<Layer> layers_;
    uint64_t missing_;
};

struct Merged {
    UnitHeader header;
    Picture picture;  // as Assembly's
    std::vector<Layer> layers;
    std::vector<Producer> producers;  // all different, in the order of the files
};

// Merges the files of one picture's parts. `room` is called with the first header, before memory is taken.
// Throws Error(Failed), naming files and parts, for parts that are damaged, missing, there twice, or of
// another picture.
Merged mergeParts(const std::vector<std::filesystem::path>& files,
                  const std::function<void(const UnitHeader&)>& room);

// "parts 3, 5 to 7 of 8": numbers in ascending order.
std::string namesOfParts(const std::vector<int>& parts, int of);

}  // namespace glint::farm
