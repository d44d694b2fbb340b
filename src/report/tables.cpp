// Tables and conclusions of a report.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "core/text_file.h"
#include "report/write.h"
#include "verify/stiffness.h"

namespace glint::report {

namespace {

constexpr int kLeastTellingWidth = 256;

std::string row(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + cell + " |";
    return line + "\n";
}

std::string header(const std::vector<std::string>& cells) {
    std::string line = row(cells) + "|";
    for (size_t i = 0; i < cells.size(); ++i) line += "---|";
    return line + "\n";
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

std::string settingOf(const Measured& m) {
    const std::string name = m.family + ", " + shortNumber(m.samples) + " spp";
    return isSampler(m.family) ? name : name + " lowDiscrepancy";
}

// The distance from 1 matters.
std::string similarity(const std::optional<double>& ssim) {
    char text[32] = "-";
    if (ssim) std::snprintf(text, sizeof(text), "%.5f", *ssim);
    return text;
}

std::string slopeLine(const SceneReport& scene) {
    std::string out = "Slopes of error against samples:";
    for (const Sampler s : kSamplers) {
        const std::string sampler(nameOf(s));
        std::vector<double> x, y;
        for (const Measured* m : familyOf(scene, sampler)) {
            if (m->hidden) continue;
            x.push_back(m->spp);
            y.push_back(m->error);
        }
        const auto slope = logSlope(x, y);
        out += " " + sampler + " " + (slope ? shortNumber(*slope) : "not measured") + ",";
    }
    return out +
           " where -1/2 is expected of random samples, -3/4 of stratified ones at edges, -1 of smooth "
           "images.\n";
}

std::string samplingTable(const SceneReport& scene) {
    std::string rows;
    for (const Sampler s : kSamplers)
        for (const Measured* m : familyOf(scene, std::string(nameOf(s))))
            rows += row({m->family, std::to_string(m->spp), wallOf(*m),
                         milliseconds(quartilesOf(m->deviceSeconds).median), errorOf(scene, *m),
                         shortNumber(m->total.relMse), similarity(m->ssim), shortNumber(m->total.max),
                         shortNumber(m->total.percentVisible), rateOf(*m)});
    if (rows.empty()) return "";
    return header({"sampler", "spp", "ms (q1..q3)", "device ms", "RMSE", "relMSE", "SSIM", "max", "> 1/255 %",
                   "Mrays/s"}) +
           rows + "\n" + slopeLine(scene) + "\n";
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
                     shortNumber(a.all.percentVisible), shortNumber(a.all.percentSmall),
                     shortNumber(a.all.bias)});
    }
    if (rows.empty()) return "";
    return header({"at 1 spp", "ms (q1..q3)", "compile ms", "RMSE, same path", "max, same path",
                   "other path, pixels", "RMSE, all", "> 1/255 %", "> 1e-3 %", "bias"}) +
           rows;
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
    if (rows.empty()) return "";
    return "\n" +
           header({"at 4 spp", "ms (q1..q3)", "RMSE, same samples", "bound", "max", "> 1/255 %", "bias"}) +
           rows;
}

// Adaptive sampling, --error and the reference.
std::string otherWaysTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured)
        if (m.family.starts_with("adaptive") || m.family.starts_with("error") || m.family == "reference")
            rows += row({m.family, shortNumber(m.samples), wallOf(m), errorOf(scene, m),
                         m.asked > 0 ? shortNumber(m.error / m.asked) : std::string("-")});
    if (rows.empty()) return "";
    return "\n" + header({"in another way", "samples", "ms (q1..q3)", "RMSE", "RMSE / --error"}) + rows;
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
    if (rows.empty()) return "";
    return "\n" +
           header({"device", "spp", "ms (q1..q3)", "time / the first one's", "RMSE",
                   "rounding (at most 4 spp, same path)", "Mrays/s"}) +
           rows;
}

std::string stabilityTable(const Report& report) {
    std::string rows;
    for (const SceneReport& scene : report.scenes)
        for (const Measured* m : familyOf(scene, "lowDiscrepancy")) {
            if (m->spp != 1 || !m->arithmetic) continue;
            rows += row({scene.name, shortNumber(scene.kappa), scene.stiffness,
                         shortNumber(scene.kappa * verify::kFloatUnit), shortNumber(m->arithmetic->all.p99),
                         shortNumber(m->arithmetic->samePath.rmse)});
        }
    if (rows.empty()) return "";
    return "\n## Stability\n\n" +
           header({"scene", "kappa", "class", "expected kappa u", "measured p99", "RMSE, same path"}) + rows;
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
    std::string line = scene.camera.empty() ? "" : "camera \"" + printable(scene.camera) + "\", ";
    line += std::to_string(scene.width) + " x " + std::to_string(scene.height) + " pixels, " +
            scene.contents + ", greatest depth " + std::to_string(scene.depth) + ", kappa " +
            shortNumber(scene.kappa) + " (" + scene.stiffness + "); converged image of " +
            std::to_string(scene.truthSamples) + " samples, whose own error, " +
            shortNumber(scene.truthError) + ", is taken out of the others'.";
    return line + (scene.width < kLeastTellingWidth
                       ? " Starting the device's work takes much of the time of so small an image."
                       : "");
}

std::string frontLine(const SceneReport& scene) {
    std::string front;
    for (const Measured* m : frontOf(scene)) front += (front.empty() ? "" : "; ") + settingOf(*m);
    return front.empty() ? "" : "\nNo setting is faster and more exact than these: " + front + ".\n";
}

std::string list(const std::vector<std::string>& lines) {
    std::string out;
    for (const std::string& line : lines) out += "- " + line + "\n";
    return out;
}

}  // namespace

std::vector<size_t> paretoFront(std::span<const WorkPoint> points) {
    std::vector<size_t> order(points.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        if (points[a].seconds != points[b].seconds) return points[a].seconds < points[b].seconds;
        return points[a].error < points[b].error;
    });
    std::vector<size_t> front;
    for (const size_t i : order) {
        if (front.empty() || points[i].error < points[front.back()].error) front.push_back(i);
    }
    return front;
}

std::optional<double> logSlope(std::span<const double> x, std::span<const double> y) {
    double n = 0, sx = 0, sy = 0;
    const auto usable = [&](size_t i) { return x[i] > 0 && y[i] > 0; };
    for (size_t i = 0; i < x.size(); ++i) {
        if (!usable(i)) continue;
        n += 1;
        sx += std::log(x[i]);
        sy += std::log(y[i]);
    }
    if (n < 2) return std::nullopt;
    double sxx = 0, sxy = 0;  // about the mean, which does not cancel
    for (size_t i = 0; i < x.size(); ++i) {
        if (!usable(i)) continue;
        const double dx = std::log(x[i]) - sx / n;
        sxx += dx * dx;
        sxy += dx * (std::log(y[i]) - sy / n);
    }
    if (sxx <= 0) return std::nullopt;
    return sxy / sxx;
}

bool isSampler(const std::string& family) {
    const auto sampler = named<Sampler>(family);
    return sampler && *sampler != Sampler::Auto;
}

std::string shortNumber(double value) {
    char text[32];
    const bool whole = std::abs(value) >= 1000 && std::abs(value) < 1e6;
    std::snprintf(text, sizeof(text), whole ? "%.0f" : "%.3g", value);
    return text;
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
    std::vector<WorkPoint> points;
    std::vector<const Measured*> settings;
    for (const Measured& m : scene.measured) {
        if (m.hidden || m.family.starts_with(kOnDevice)) continue;
        points.push_back({m.median(), m.error});
        settings.push_back(&m);
    }
    std::vector<const Measured*> front;
    for (const size_t i : paretoFront(points)) front.push_back(settings[i]);
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
        out += "\n## " + scene.name + "\n\n" + sceneLine(scene) + "\n\n" + samplingTable(scene) +
               methodTable(scene) + truncationTable(scene) + otherWaysTable(scene) + devicesTable(scene) +
               frontLine(scene);
        if (!scene.leftOut.empty())
            out += "\nNot measured in the time (repeat the command to resume):\n" + list(scene.leftOut);
    }
    return out + stabilityTable(report);
}

}  // namespace glint::report
