// An image of `glint render` in units: the renderer of its units, and the file that they fill.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "app/drawing.h"
#include "app/render_bands.h"
#include "app/render_command.h"
#include "farm/merge.h"
#include "farm/unit_file.h"
#include "pack/loaded_scene.h"

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

class UnitPicture {
  public:
    // `rows`: row by row, see needsRows(). `scale`: see scaleOf().
    UnitPicture(const farm::UnitHeader& header, const std::filesystem::path& output, bool rows, float scale);

    void add(const farm::UnitResult& result);
    const farm::Assembly& assembly() const { return assembly_; }

    // Once it is complete: the file appears. Files, hash, picture and time of writing are set.
    Outcome write();

  private:
    const std::filesystem::path output_;
    const float scale_;
    farm::Assembly assembly_;
    std::optional<RowFile> file_;  // empty: at once
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
