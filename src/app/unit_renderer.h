// A picture of `glint render` in units: what they are, and who draws them.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <vector>

#include "app/common.h"
#include "app/drawing.h"
#include "app/render_options.h"
#include "app/render_result.h"
#include "farm/unit_file.h"

namespace glint::app {

class UnitRenderer {
  public:
    // `parts`: 0 for as many as take some seconds each, and no fewer than `leastParts`.
    UnitRenderer(const RenderCommand& command, int parts, std::ostream& err, int leastParts = 1);

    const farm::UnitHeader& header() const { return header_; }
    const LoadedScene& loaded() const { return loaded_; }
    const Drawing& drawing() const { return drawing_; }
    uint64_t pixelsOf(int part) const;

    // Pixels of the largest unit.
    uint64_t mostPixels() const;

    // Nothing if it was interrupted, or `unwanted` says that nobody wants the unit any more. `progress` hears
    // how much of the unit is done.
    std::optional<farm::UnitResult> draw(int part, const std::function<void(double)>& progress,
                                         const std::function<bool()>& unwanted = {});

    // Adds facts and warnings once the image is written.
    void complete(Outcome& outcome, const std::vector<farm::Producer>& producers, std::ostream& err) const;

  private:
    const RenderCommand& command_;
    Drawing drawing_;
    const LoadedScene loaded_;
    Request request_;  // of the whole picture
    farm::UnitHeader header_;
    std::vector<std::vector<Region>> cut_;
    bool uploaded_ = false;
};

}  // namespace glint::app
