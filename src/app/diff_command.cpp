#include <algorithm>
#include <cmath>
#include <ostream>

#include "app/commands.h"
#include "core/error.h"
#include "core/image_diff.h"
#include "core/image_io.h"

namespace glint::app {

namespace {

struct DiffCommand {
    std::filesystem::path a, b, output;
    double tolerance = 0;
};

void declare(OptionTable& table, DiffCommand& c) {
    table.name("A", "", "image: .png .exr .pfm .hdr .jpg .webp", c.a);
    table.name("B", "", "image of the same size", c.b);
    table.name("-o,--output", "FILE", "write the image |A - B|", c.output);
    table.value("--tolerance", "X", "largest difference of linear values that counts as equal (default 0)",
                c.tolerance, parseNotNegative);
}

ImageDifference compare(const DiffCommand& command, const Image& a, const Image& b) {
    try {
        return compareImages(a, b, command.tolerance);
    } catch (const Error& e) {
        throw Error(e.kind(), command.a.string() + ", " + command.b.string() + ": " + e.what());
    }
}

ExitCode run(const DiffCommand& command, std::ostream& out, std::ostream&) {
    if (!command.output.empty()) checkPicturePath(command.output);
    const Image a = readImage(command.a);
    const Image b = readImage(command.b);
    const ImageDifference d = compare(command, a, b);
    const double similarity =
        structuralSimilarity(a, b);  // not finite if the images are smaller than its window
    out << format("RMSE %.6g, PSNR %.4g dB, relMSE %.4g, SSIM %s, max %.6g, mean %.6g\n", d.rmse, d.psnr,
                  d.relMse, std::isfinite(similarity) ? format("%.6g", similarity).c_str() : "-", d.max,
                  d.mean);
    out << d.above << " of " << d.pixels
        << format(" pixels (%.4f %%) differ by more than %g, ",
                  100.0 * static_cast<double>(d.above) / static_cast<double>(std::max<uint64_t>(d.pixels, 1)),
                  command.tolerance)
        << d.notFinite << " not finite in one image only\n";
    for (const PixelDifference& p : d.worst)
        out << format("  pixel %d,%d: %.6g\n", p.x, p.y, static_cast<double>(p.difference));
    if (!command.output.empty()) {
        writeImage(command.output, differenceImage(a, b));
        out << "wrote " << shown(command.output) << '\n';
    }
    return d.above > 0 || d.notFinite > 0 ? ExitCode::Difference : ExitCode::Done;
}

}  // namespace

Run diffCommand(OptionTable& table) {
    return commandOf<DiffCommand>(table, declare, run);
}

}  // namespace glint::app
