// Tables and conclusions of a report.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/text_file.h"
#include "report/write.h"
#include "verify/stiffness.h"

namespace glint::report {

namespace {

std::string row(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + cell + " |";
    return line + "\n";
}

// A blank line and the table; empty without rows.
std::string table(const std::vector<std::string>& heading, const std::string& rows) {
    if (rows.empty()) return "";
    std::string rule = "|";
    for (size_t i = 0; i < heading.size(); ++i) rule += "---|";
    return "\n" + row(heading) + rule + "\n" + rows;
}

std::string milliseconds(double seconds) {
    return shortNumber(seconds * 1e3);
}

std::string wallOf(const Measured& m) {
    const Quartiles wall = m.wall();
    return milliseconds(wall.median) + " (" + milliseconds(wall.low) + ".." + milliseconds(wall.high) + ")";
}

std::string rateOf(const Measured& m) {
    const double seconds = m.median();
    return m.rays > 0 && seconds > 0 ? shortNumber(static_cast<double>(m.rays) / seconds / 1e6) : "-";
}

std::string errorOf(const SceneReport& scene, const Measured& m) {
    return m.hidden ? "< " + shortNumber(scene.truthError) : shortNumber(m.error);
}

std::string samplingTable(const SceneReport& scene) {
    std::string rows;
    for (const Sampler s : kSamplers)
        for (const Measured* m : familyOf(scene, std::string(nameOf(s))))
            rows += row({m->family, std::to_string(m->spp), wallOf(*m),
                         milliseconds(quartilesOf(m->deviceSeconds).median), errorOf(scene, *m),
                         shortNumber(m->total.relMse), m->ssim ? format("%.5f", *m->ssim) : "-",
                         shortNumber(m->total.max), shortNumber(m->total.percentVisible), rateOf(*m)});
    return table({"sampler", "spp", "ms (q1..q3)", "device ms", "RMSE", "relMSE", "SSIM", "max", "> 1/255 %",
                  "Mrays/s"},
                 rows);
}

bool isTruncated(const Measured& m) {
    return m.family == "depth" || m.family == "cut";
}

// At one sample, where a pixel is one path: rounding errors, by method.
std::string methodTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured) {
        if (m.spp != 1 || !m.arithmetic || isTruncated(m) || isSampler(m.family) ||
            m.family.starts_with(kOnDevice))
            continue;
        const ArithmeticError& a = *m.arithmetic;
        rows += row({m.family, wallOf(m), milliseconds(m.compile), shortNumber(a.samePath.rmse),
                     shortNumber(a.samePath.max), std::to_string(a.otherPath.pixels), shortNumber(a.all.rmse),
                     shortNumber(a.all.percentVisible), shortNumber(a.all.bias)});
    }
    return table({"at 1 spp", "ms (q1..q3)", "compile ms", "RMSE, same path", "max, same path",
                  "other path, pixels", "RMSE, all", "> 1/255 %", "bias"},
                 rows);
}

std::string truncationTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured) {
        if (!isTruncated(m) || !m.arithmetic) continue;
        const ErrorMeasures& e = m.arithmetic->all;
        rows += row({m.family == "cut" ? "cut below " + shortNumber(m.minContribution)
                                       : "depth " + std::to_string(m.depth),
                     wallOf(m), shortNumber(e.rmse), shortNumber(m.bound), shortNumber(e.max),
                     shortNumber(e.percentVisible), shortNumber(e.bias)});
    }
    return table({"at 4 spp", "ms (q1..q3)", "RMSE, same samples", "bound", "max", "> 1/255 %", "bias"},
                 rows);
}

// Adaptive sampling, --error and the reference.
std::string otherWaysTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured)
        if (m.family.starts_with("adaptive") || m.family.starts_with("error") || m.family == "reference")
            rows += row({m.family, shortNumber(m.samples), wallOf(m), errorOf(scene, m),
                         m.asked > 0 ? shortNumber(m.error / m.asked) : std::string("-")});
    return table({"in another way", "samples", "ms (q1..q3)", "RMSE", "RMSE / --error"}, rows);
}

std::string devicesTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured) {
        if (!m.family.starts_with(kOnDevice)) continue;
        const auto first = std::find_if(
            scene.measured.begin(), scene.measured.end(),
            [&](const Measured& other) { return other.family.starts_with(kOnDevice) && other.spp == m.spp; });
        rows += row({m.family.substr(std::string_view(kOnDevice).size()), std::to_string(m.spp), wallOf(m),
                     shortNumber(m.median() / first->median()), errorOf(scene, m),
                     m.arithmetic ? shortNumber(m.arithmetic->samePath.rmse) : "-", rateOf(m)});
    }
    return table({"device", "spp", "ms (q1..q3)", "time / the first one's", "RMSE",
                  "rounding (at most 4 spp, same path)", "Mrays/s"},
                 rows);
}

// The arithmetic error that the condition of each scene predicts, and the measured one.
std::string stabilityTable(const Report& report) {
    std::string rows;
    for (const SceneReport& scene : report.scenes)
        for (const Measured* m : familyOf(scene, "lowDiscrepancy"))
            if (m->spp == 1 && m->arithmetic)
                rows +=
                    row({scene.name, shortNumber(scene.kappa), scene.stiffness,
                         shortNumber(scene.kappa * verify::kFloatUnit),
                         shortNumber(m->arithmetic->samePath.rmse), shortNumber(m->arithmetic->all.rmse)});
    const std::string all =
        table({"scene", "kappa", "class", "expected kappa u", "RMSE, same path", "RMSE, all"}, rows);
    return all.empty() ? "" : "\n## Stability\n" + all;
}

// The fastest sampler and count that reach an error.
const Measured* cheapestFor(const SceneReport& scene, double wanted) {
    const Measured* best = nullptr;
    for (const Measured& m : scene.measured) {
        if (m.hidden ? scene.truthError > wanted : m.error > wanted) continue;
        if (isSampler(m.family) && (best == nullptr || m.median() < best->median())) best = &m;
    }
    return best;
}

std::string sceneLine(const SceneReport& scene) {
    return (scene.camera.empty() ? "" : "camera \"" + printable(scene.camera) + "\", ") +
           format("%d x %d pixels, greatest depth %d, kappa ", scene.width, scene.height, scene.depth) +
           shortNumber(scene.kappa) + " (" + scene.stiffness + "); converged image of " +
           std::to_string(scene.truthSamples) + " samples, whose own error, " +
           shortNumber(scene.truthError) + ", is taken out of the others'.";
}

std::string list(const std::vector<std::string>& lines) {
    std::string out;
    for (const std::string& line : lines) out += "- " + line + "\n";
    return out;
}

}  // namespace

bool isSampler(const std::string& family) {
    const auto sampler = named<Sampler>(family);
    return sampler && *sampler != Sampler::Auto;
}

std::string shortNumber(double value) {
    const bool whole = std::abs(value) >= 1000 && std::abs(value) < 1e6;
    return whole ? format("%.0f", value) : format("%.3g", value);
}

std::vector<const Measured*> familyOf(const SceneReport& scene, const std::string& family) {
    std::vector<const Measured*> points;
    for (const Measured& m : scene.measured)
        if (m.family == family) points.push_back(&m);
    std::stable_sort(points.begin(), points.end(),
                     [](const Measured* a, const Measured* b) { return a->spp < b->spp; });
    return points;
}

std::vector<const Measured*> frontOf(const SceneReport& scene) {
    std::vector<const Measured*> order, front;
    for (const Measured& m : scene.measured)
        if (!m.hidden && !m.family.starts_with(kOnDevice)) order.push_back(&m);
    std::stable_sort(order.begin(), order.end(), [](const Measured* a, const Measured* b) {
        return std::pair(a->median(), a->error) < std::pair(b->median(), b->error);
    });
    for (const Measured* m : order)
        if (front.empty() || m->error < front.back()->error) front.push_back(m);
    return front;
}

std::vector<std::string> useTheseSettings(const SceneReport& scene) {
    std::vector<std::string> lines;
    const bool sampled = std::any_of(scene.measured.begin(), scene.measured.end(),
                                     [](const Measured& m) { return isSampler(m.family); });
    if (!sampled) return {"no sampler was measured: run the report without --only"};
    for (const double error : {0.01, 0.003, 0.001}) {
        const std::string start = "for an error of " + shortNumber(error) + ": ";
        if (const Measured* best = cheapestFor(scene, error))
            lines.push_back(start + "--sampler " + best->family + " --spp " + std::to_string(best->spp) +
                            " (" + milliseconds(best->median()) + " ms)");
        else
            lines.push_back(start + "--error " + shortNumber(error) + " (no measured setting reaches it)");
    }
    return lines;
}

std::string toMarkdown(const Report& report) {
    std::string out;
    for (const SceneReport& scene : report.scenes)
        out += "## " + scene.name + ": use these settings\n\n" + list(useTheseSettings(scene)) + "\n";
    out +=
        "Errors are RMSE of linear color (full scale 1). Times are of an image without loading and "
        "compiling, the median of at most " +
        std::to_string(report.repeats) + " runs.\n\n" + "device: " + report.device + ", " + report.driver +
        ", Vulkan " + report.api + "; " + std::to_string(report.cores) + " cores; glint " + report.version +
        "; converged images: " + report.truthBackend + ", lowDiscrepancy, other seeds\n";
    for (const SceneReport& scene : report.scenes) {
        out += "\n## " + scene.name + "\n\n" + sceneLine(scene) + "\n" + samplingTable(scene) +
               methodTable(scene) + truncationTable(scene) + otherWaysTable(scene) + devicesTable(scene);
        if (!scene.leftOut.empty())
            out += "\nNot measured in the time (repeat the command to resume):\n" + list(scene.leftOut);
    }
    return out + stabilityTable(report);
}

}  // namespace glint::report
