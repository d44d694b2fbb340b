// The picture that units make, on its way into a file: written at once where it fits into memory, and
// otherwise row by row, as rows become complete.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/render_result.h"
#include "core/picture_hash.h"
#include "core/picture_rows.h"
#include "farm/merge.h"

namespace glint::app {

class UnitPicture {
  public:
    // `rows`: row by row, see needsRows(). `header` must outlive the object. `scale`: see scaleOf().
    UnitPicture(const farm::UnitHeader& header, const std::filesystem::path& output, bool rows, float scale);

    void add(const farm::UnitResult& result);
    const farm::Assembly& assembly() const { return assembly_; }

    // Once it is complete: the file appears. Files, hash, picture and time of writing are set.
    Outcome write();

  private:
    void takeRows();

    const farm::UnitHeader& header_;
    const std::filesystem::path output_;
    const float scale_;
    farm::Assembly assembly_;
    std::optional<PictureRows> file_;  // empty: at once
    PictureHash hash_;
    BandTotals bands_;
    double writeSeconds_ = 0;
};

// True if the image must be written row by row, or is to by `wanted`. `heldBytes`: bytes of the largest unit
// times those that may wait for an earlier one. `available`: bytes of memory. Throws Error(Failed) if the
// image fits neither at once nor in rows.
bool needsRows(const farm::UnitHeader& header, const std::filesystem::path& output, uint64_t heldBytes,
               uint64_t available, bool wanted = false);

std::string producerText(const farm::Producer& producer);

// Warns if several devices rendered the image and the bits of some differ from those of others.
void warnOfMixedBits(const std::vector<farm::Producer>& producers, const std::string& start,
                     std::ostream& err);

// Bytes of a unit of so many pixels while it is rendered or waits.
uint64_t unitBytes(const std::vector<Aov>& aovs, uint64_t pixels);

}  // namespace glint::app
