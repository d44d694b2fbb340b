// Pictures that do not fit into memory: drawn from the top in bands of rows, each of which goes straight into
// the file. Pixels do not depend on each other, so they are those of a picture that was drawn at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "app/drawing.h"
#include "app/render_command.h"
#include "app/render_result.h"
#include "core/content_hash.h"
#include "core/image_io.h"

namespace glint::app {

// True if a file can be written row by row: .png with colour and alpha alone, .exr and .pfm.
bool canWriteRows(const std::filesystem::path& output, const std::vector<Aov>& aovs);

// An image that goes into its file row by row, from the top.
class RowFile {
  public:
    // `scale`: see scaleOf().
    RowFile(const std::filesystem::path& output, const Region& region, const std::vector<Aov>& aovs,
            float scale);

    // The rows below those before.
    void add(const Picture& rows, std::vector<Layer> layers);
    // All rows that are left, each like the one given.
    void fill(const Picture& row, std::vector<Layer> layers);
    // The files appear. Sets bands, files, hash and seconds of writing.
    void finish(Outcome& outcome);
    const BandTotals& totals() const { return totals_; }

  private:
    float scale_;
    int left_;  // rows
    PictureRows file_;
    PictureHash hash_;
    BandTotals totals_;
    double seconds_ = 0;
};

// Rows of a band; 0: the picture is drawn at once, because it fits into `available` bytes and no bands were
// asked for. Throws Error(Failed) if not even a band fits, or the picture cannot be written in bands, and
// Error(Argument) if bands were asked for where there can be none.
int bandRowsOf(const RenderCommand& command, const std::filesystem::path& output, const Region& region,
               uint64_t available);

// Draws and writes the picture; `outcome` gets all but what is known of a drawing later. An interrupted one
// is blank from where it was interrupted, and is not written if that is everywhere.
void drawBands(Drawing& drawing, const RenderCommand& command, const LoadedScene& loaded,
               const Request& request, int rows, Outcome& outcome);

}  // namespace glint::app
