// Assembles an image from units (farm/unit.h), and writes its file; units.cpp also holds `glint merge`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "app/render_command.h"
#include "farm/merge.h"
#include "farm/unit_file.h"

namespace glint::app {

class UnitPicture {
  public:
    // `heldBytes`: of the units that wait for an earlier one. The file is written row by row if `byRows`, or
    // if the image does not fit into memory. Throws Error(Failed) if the image fits neither at once nor in
    // rows, and Error(Argument) for --exposure or `byRows` that the format of the file excludes.
    UnitPicture(const farm::UnitHeader& header, const std::filesystem::path& output, uint64_t heldBytes,
                bool byRows, std::optional<double> exposure);

    void add(const farm::UnitResult& result);
    const farm::Assembly& assembly() const { return assembly_; }
    const PictureFile& file() const { return file_; }
    // The complete image; without pixels if it goes by rows.
    const Picture& picture() const { return picture_; }

    // Call once the image is complete: names the file.
    Outcome write(std::ostream& out);

  private:
    farm::Assembly assembly_;
    PictureFile file_;
    Picture picture_;
};

// Device and driver.
std::string textOf(const farm::Producer& producer);

// Warns if several devices rendered the image and the bits of some differ from those of others.
void warnOfMixedBits(const std::vector<farm::Producer>& producers, const std::string& start,
                     std::ostream& err);

// Bytes of a unit of so many pixels while it is rendered or waits.
uint64_t unitBytes(const std::vector<Aov>& aovs, uint64_t pixels);

}  // namespace glint::app
