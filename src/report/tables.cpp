// Tables and words of a report.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/text_file.h"
#include "report/front.h"
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

std::string errorOf(const SceneReport& scene, const Measured& m) {
    return m.hidden ? "< " + shortNumber(scene.truthError) : shortNumber(m.error);
}

bool isSampler(const std::string& family) {
    const auto sampler = named<Sampler>(family);
    return sampler && *sampler != Sampler::Auto;
}

bool isSampled(const SceneReport& scene) {
    return std::any_of(scene.measured.begin(), scene.measured.end(),
                       [](const Measured& m) { return isSampler(m.family); });
}

std::string settingOf(const Measured& m) {
    const std::string name = m.family + ", " + shortNumber(m.samples) + " spp";
    return isSampler(m.family) ? name : name + " lowDiscrepancy";
}

// Its distance from 1 is what tells.
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
           "pictures.\n";
}

std::string samplingTable(const SceneReport& scene) {
    std::string rows;
    const std::string names = header({"sampler", "spp", "ms (q1..q3)", "device ms", "RMSE", "relMSE", "SSIM",
                                      "max", "> 1/255 %", "Mrays/s"});
    for (const Sampler s : kSamplers) {
        const std::string sampler(nameOf(s));
        for (const Measured* m : familyOf(scene, sampler)) {
            const double rate = m->wall.median > 0 ? static_cast<double>(m->rays) / m->wall.median / 1e6 : 0;
            rows += row({sampler, std::to_string(m->spp),
                         milliseconds(m->wall.median) + " (" + milliseconds(m->wall.low) + ".." +
                             milliseconds(m->wall.high) + ")",
                         milliseconds(m->device.median), errorOf(scene, *m), shortNumber(m->total.relMse),
                         similarity(m->ssim), shortNumber(m->total.max), shortNumber(m->total.percentVisible),
                         shortNumber(rate)});
        }
    }
    return rows.empty() ? "" : names + rows + "\n" + slopeLine(scene) + "\n";
}

// At one sample, where a pixel is one path: rounding alone, by method.
std::string methodTable(const SceneReport& scene) {
    std::string rows;
    const std::string names =
        header({"at 1 spp", "ms (q1..q3)", "compile ms", "RMSE, same path", "max, same path",
                "other path, pixels", "RMSE, all", "> 1/255 %", "> 1e-3 %", "bias"});
    for (const Measured& m : scene.measured) {
        if (m.spp != 1 || !m.arithmetic || m.family == "depth" || m.family == "cut" || isSampler(m.family) ||
            m.family.starts_with(kOnDevice))
            continue;
        const ArithmeticError& a = *m.arithmetic;
        rows += row({m.family,
                     milliseconds(m.wall.median) + " (" + milliseconds(m.wall.low) + ".." +
                         milliseconds(m.wall.high) + ")",
                     milliseconds(m.compile), shortNumber(a.samePath.rmse), shortNumber(a.samePath.max),
                     std::to_string(a.otherPath.pixels), shortNumber(a.all.rmse),
                     shortNumber(a.all.percentVisible), shortNumber(a.all.percentSmall),
                     shortNumber(a.all.bias)});
    }
    return rows.empty() ? "" : names + rows;
}

std::string truncationTable(const SceneReport& scene) {
    if (familyOf(scene, "depth").empty() && familyOf(scene, "cut").empty()) return "";
    std::string out = header({"at 4 spp", "ms (q1..q3)", "RMSE, same samples", "at most, by its own account",
                              "max", "> 1/255 %", "bias"});
    for (const Measured& m : scene.measured) {
        if ((m.family != "depth" && m.family != "cut") || !m.arithmetic) continue;
        const std::string name = m.family == "cut" ? "cut below " + shortNumber(m.minContribution)
                                                   : "depth " + std::to_string(m.depth);
        const ErrorMeasures& e = m.arithmetic->all;
        out += row({name,
                    milliseconds(m.wall.median) + " (" + milliseconds(m.wall.low) + ".." +
                        milliseconds(m.wall.high) + ")",
                    shortNumber(e.rmse), shortNumber(m.bound), shortNumber(e.max),
                    shortNumber(e.percentVisible), shortNumber(e.bias)});
    }
    return "\n" + out;
}

std::string stabilityTable(const Report& data) {
    std::string out =
        header({"scene", "kappa", "class", "expected kappa u", "measured p99", "RMSE, same path"});
    for (const SceneReport& scene : data.scenes) {
        for (const Measured* m : familyOf(scene, "lowDiscrepancy")) {
            if (m->spp != 1 || !m->arithmetic) continue;
            out += row({scene.name, shortNumber(scene.kappa), scene.stiffness,
                        shortNumber(scene.kappa * verify::kFloatUnit), shortNumber(m->arithmetic->all.p99),
                        shortNumber(m->arithmetic->samePath.rmse)});
        }
    }
    return out;
}

// The same picture in other ways, beside the default's sampler at as many samples.
std::string otherWaysTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured) {
        if (contestOf(m) != Contest::None || m.family == "depth" || m.family == "cut") continue;
        if (m.family.starts_with(kOnDevice)) continue;
        rows += row({m.family, shortNumber(m.samples),
                     milliseconds(m.wall.median) + " (" + milliseconds(m.wall.low) + ".." +
                         milliseconds(m.wall.high) + ")",
                     errorOf(scene, m), m.asked > 0 ? shortNumber(m.error / m.asked) : std::string("-")});
    }
    if (rows.empty()) return "";
    return "\nErrors of filters, whose pictures are others, are by the differences of their own runs.\n\n" +
           header({"in another way", "samples", "ms (q1..q3)", "RMSE", "of the error asked for"}) + rows;
}

// Times beside the first device's, turn by turn.
std::string devicesTable(const SceneReport& scene) {
    std::string rows;
    for (const Measured& m : scene.measured) {
        if (!m.family.starts_with(kOnDevice)) continue;
        const auto first =
            std::find_if(scene.measured.begin(), scene.measured.end(),
                         [&](const Measured& other) { return other.batch == m.batch && other.spp == m.spp; });
        const double rate = m.wall.median > 0 ? static_cast<double>(m.rays) / m.wall.median / 1e6 : 0;
        rows += row({m.family.substr(std::string_view(kOnDevice).size()), std::to_string(m.spp),
                     milliseconds(m.wall.median) + " (" + milliseconds(m.wall.low) + ".." +
                         milliseconds(m.wall.high) + ")",
                     &*first == &m ? "1" : ratio(m.seconds, first->seconds), errorOf(scene, m),
                     m.arithmetic ? shortNumber(m.arithmetic->samePath.rmse) : "-",
                     m.rays > 0 ? shortNumber(rate) : "-"});
    }
    if (rows.empty()) return "";
    return "\n" +
           header({"device", "spp", "ms (q1..q3)", "x the first one's time", "RMSE",
                   "of which rounding (at most 4 spp, same path)", "Mrays/s"}) +
           rows;
}

// The quickest that is good enough, among settings that any picture can be drawn with.
const Measured* cheapestFor(const SceneReport& scene, double wanted) {
    const Measured* best = nullptr;
    for (const Measured& m : scene.measured) {
        if (m.hidden ? scene.truthError > wanted : m.error > wanted) continue;
        if (!isSampler(m.family)) continue;
        if (best == nullptr || m.wall.median < best->wall.median) best = &m;
    }
    return best;
}

std::string cheapestInWords(const SceneReport& scene, double wanted) {
    const Measured* best = cheapestFor(scene, wanted);
    if (best == nullptr) return "Nothing measured reaches an error of " + shortNumber(wanted) + ". ";
    return "For an error of " + shortNumber(wanted) + " the cheapest is " + settingOf(*best) + ": " +
           shortNumber(best->wall.median * 1e3) + " ms. ";
}

// What to take from it all: which samples for which error, on which kind of scene.
std::string adviceTable(const Report& data) {
    const double errors[] = {0.03, 0.01, 0.003, 0.001};
    std::vector<std::string> names{"scene", "with"};
    for (const double error : errors) names.push_back("error " + shortNumber(error));
    std::string out = header(names);
    for (const SceneReport& scene : data.scenes) {
        std::vector<std::string> cells{scene.name, scene.contents};
        for (const double error : errors) {
            const Measured* best = cheapestFor(scene, error);
            cells.push_back(best == nullptr
                                ? (isSampled(scene) ? "not reached" : "not measured")
                                : settingOf(*best) + ": " + milliseconds(best->wall.median) + " ms");
        }
        out += row(cells);
    }
    return out;
}

std::string sceneLine(const SceneReport& scene) {
    std::string line = scene.camera.empty() ? "" : "camera \"" + printable(scene.camera) + "\", ";
    line += std::to_string(scene.width) + " x " + std::to_string(scene.height) + " pixels, greatest depth " +
            std::to_string(scene.maxDepth) + ", kappa " + shortNumber(scene.kappa) + " (" + scene.stiffness +
            "); converged picture of " + std::to_string(scene.truthSamples) + " samples, whose own error, " +
            shortNumber(scene.truthError) + ", is taken out of the others'.";
    return line + (scene.width < kLeastTellingWidth
                       ? " Starting the device's work takes much of the time of so small a picture."
                       : "");
}

}  // namespace

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

std::vector<std::string> familiesOf(const SceneReport& scene) {
    std::vector<std::string> families;
    for (const Measured& m : scene.measured) {
        if (m.family == "depth" || m.family == "cut") continue;
        if (std::find(families.begin(), families.end(), m.family) == families.end())
            families.push_back(m.family);
    }
    return families;
}

std::vector<const Measured*> frontOf(const SceneReport& scene) {
    std::vector<WorkPoint> points;
    std::vector<const Measured*> told;
    for (const Measured& m : scene.measured) {
        if (m.hidden || m.family.starts_with("filter") || m.family.starts_with(kOnDevice))
            continue;  // another picture, another machine
        points.push_back({m.wall.median, m.error});
        told.push_back(&m);
    }
    std::vector<const Measured*> front;
    for (const size_t i : paretoFront(points)) front.push_back(told[i]);
    return front;
}

std::string conclusionOf(const SceneReport& scene) {
    if (scene.measured.empty()) return "Nothing was measured.";
    std::string out = isSampled(scene) ? cheapestInWords(scene, 1e-2) + cheapestInWords(scene, 1e-3) : "";
    const std::string sampler = defaultInWords(scene, Contest::Samplers);
    if (!sampler.empty()) out += "The default sampler (" + scene.defaultSampler + ") is " + sampler + ". ";
    const std::string methods = defaultInWords(scene, Contest::Methods);
    if (!methods.empty()) out += "The default methods are " + methods + ". ";
    std::string front;
    for (const Measured* m : frontOf(scene)) front += (front.empty() ? "" : "; ") + settingOf(*m);
    return front.empty() ? out : out + "The front by medians: " + front + ".";
}

std::string toMarkdown(const Report& data) {
    std::string out = "## Which samples for which error\n\n" + adviceTable(data) +
                      "\nErrors are RMSE of linear colour (full scale 1); times are of a picture without "
                      "loading and compiling, the median of " +
                      std::to_string(data.repeats) + " runs.\n";
    out += "\ndevice: " + data.device + ", " + data.driver + ", Vulkan " + data.api + "; " +
           std::to_string(data.cores) + " cores; glint " + data.version +
           "; converged pictures: " + data.truthBackend + ", lowDiscrepancy, other seeds\n";
    for (const SceneReport& scene : data.scenes) {
        out += "\n## " + scene.name + "\n\n" + sceneLine(scene) + "\n\n";
        out += samplingTable(scene) + methodTable(scene) + truncationTable(scene) + otherWaysTable(scene) +
               devicesTable(scene) + "\n" + defaultTable(scene) + "\n" + conclusionOf(scene) + "\n";
        if (!scene.leftOut.empty()) {
            out += "\nLeft out for want of time (the same command goes on with it):\n";
            for (const std::string& name : scene.leftOut) out += "- " + name + "\n";
        }
    }
    return out + "\n## Is the default on the front?\n\n" + defaultSummary(data) + "\n## Stability\n\n" +
           stabilityTable(data);
}

}  // namespace glint::report
