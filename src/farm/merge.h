// Units put together to pictures.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "farm/unit_file.h"

namespace glint::farm {

// Whole rows of a picture.
struct Rows {
    Picture picture;            // region, color and done; nothing else
    std::vector<Layer> layers;  // in the order of the AOVs
};

// A picture that grows by its units, in any order: pixels are copied, never computed with, so it has the bits
// of one that was drawn at once. Only the sums in the losses depend on the order, in their last digits. Rows
// can be taken as soon as they are complete, so that memory is for those alone that are not.
class Assembly {
  public:
    Assembly(const Region& whole, const std::vector<Aov>& aovs);

    // Throws Error(Failed) if some of its pixels are there already.
    void add(const UnitResult& result);
    bool complete() const { return missing_ == 0; }
    const Region& region() const { return whole_; }
    // Pixels that are there, of all.
    double share() const;

    // All rows below those that were taken before that are there, down to the first that is not. None: no
    // rows.
    Rows take();

    // Flaws of all units so far.
    const PictureFlaws& flaws() const { return flaws_; }
    // All that drew them, each once, in the order in which they came.
    const std::vector<Producer>& producers() const { return producers_; }

  private:
    // Some rows, between which tiles of the device end.
    struct Strip {
        Image color;
        std::vector<Layer> layers;
        std::vector<uint8_t> done;
        uint64_t missing = 0;
    };
    Region regionOf(int strip) const;
    Strip& stripOf(int y);
    void addRow(const Block& block, int y, int part);

    const Region whole_;
    const std::vector<Aov> aovs_;
    const LayerShapes shapes_;
    std::map<int, Strip> strips_;  // that are begun and not taken, from the top
    int taken_ = 0;                // strips
    uint64_t missing_;
    PictureFlaws flaws_;
    std::vector<Producer> producers_;
};

// Merges the files of one picture's parts. `begin` is called with the header, and how many bytes the largest
// file has, before more is read, and then `add` with each part, in the order in which they stand in the
// picture. Throws Error(Failed), naming files and parts, for parts that are damaged, missing, there twice, or
// of another picture.
void mergeParts(const std::vector<std::filesystem::path>& files,
                const std::function<void(const UnitHeader&, uint64_t largest)>& begin,
                const std::function<void(const UnitResult&)>& add);

// "part 3 of 8", "parts 3, 5 to 7 of 8": numbers in ascending order.
std::string namesOfParts(const std::vector<int>& parts, int of);

}  // namespace glint::farm
