#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "core/error.h"
#include "core/image_diff.h"
#include "core/image_io.h"
#include "core/similarity.h"

namespace glint::app {

namespace {

struct DiffCommand {
    std::filesystem::path a, b, output;
    double tolerance = 0;
};

void declare(OptionTable& table, DiffCommand& c) {
    constexpr auto kRequired = OptionTable::Need::Required;
    table.value(
        "A", "", "picture: .png .exr .pfm .hdr .jpg", [&](const std::string& t) { c.a = t; }, kRequired);
    table.value(
        "B", "", "picture of the same size", [&](const std::string& t) { c.b = t; }, kRequired);
    table.path("-o,--output", "FILE", "picture of |A - B| to write", "the file name", c.output);
    table.value("--tolerance", "X",
                "greatest difference, on linear values, that still counts as equal (default 0)",
                [&](const std::string& t) { c.tolerance = parseNotNegative(t); });
}

ImageDifference compare(const DiffCommand& command, const Image& a, const Image& b) {
    try {
        return compareImages(a, b, command.tolerance);
    } catch (const Error& e) {
        throw Error(e.kind(), command.a.string() + ", " + command.b.string() + ": " + e.what());
    }
}

std::string wholeFrame(const ImageDifference& d, double similarity) {
    char line[256], alike[32] = "-";  // smaller than a window of it
    if (std::isfinite(similarity)) std::snprintf(alike, sizeof(alike), "%.6g", similarity);
    std::snprintf(line, sizeof(line), "RMSE %.6g, PSNR %.4g dB, relMSE %.4g, SSIM %s, max %.6g, mean %.6g",
                  d.rmse, d.psnr, d.relMse, alike, d.max, d.mean);
    return line;
}

int run(const DiffCommand& command, std::ostream& out) {
    if (!command.output.empty()) checkPicturePath(command.output);
    const Image a = readImage(command.a);
    const Image b = readImage(command.b);
    const ImageDifference d = compare(command, a, b);
    char line[256];
    out << wholeFrame(d, structuralSimilarity(a, b)) << '\n';
    std::snprintf(
        line, sizeof(line),
        "%llu of %llu pixels (%.4f %%) differ by more than %g, %llu not finite in one picture only\n",
        static_cast<unsigned long long>(d.above), static_cast<unsigned long long>(d.pixels),
        100.0 * static_cast<double>(d.above) / static_cast<double>(std::max<uint64_t>(d.pixels, 1)),
        command.tolerance, static_cast<unsigned long long>(d.notFinite));
    out << line;
    for (const PixelDifference& p : d.worst) {
        std::snprintf(line, sizeof(line), "  pixel %d,%d: %.6g\n", p.x, p.y,
                      static_cast<double>(p.difference));
        out << line;
    }
    if (!command.output.empty()) {
        writeImage(command.output, differenceImage(a, b));
        out << "wrote " << shown(command.output) << '\n';
    }
    return static_cast<int>(d.above > 0 || d.notFinite > 0 ? ExitCode::Difference : ExitCode::Done);
}

}  // namespace

Run diffCommand(OptionTable& table) {
    const auto command = std::make_shared<DiffCommand>();
    declare(table, *command);
    return [command](std::ostream& out, std::ostream&) { return run(*command, out); };
}

}  // namespace glint::app
