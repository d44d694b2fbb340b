// A report's tables and conclusions, as Markdown and as a page.
//
// The page holds everything, without scripts and references. Each scene's first screen shows its image, the
// settings to use and the error curve; the tables follow.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/format.h"
#include "core/text_file.h"
#include "reference/sensitivity.h"
#include "report/write.h"

namespace glint::report {

namespace {

// A part of the report's text: lines, the rows of a table with its heading first, or an SVG file.
struct Block {
    enum Kind { Heading, Paragraph, List, Table, Diagram };
    Kind kind;
    std::vector<std::vector<std::string>> rows;  // outside tables one cell each
};

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

Block samplingTable(const SceneReport& scene) {
    Block table = {Block::Table,
                   {{"sampler", "spp", "ms (q1..q3)", "device ms", "RMSE", "relMSE", "SSIM", "max",
                     "> 1/255 %", "Mrays/s"}}};
    for (const Sampler s : kSamplers)
        for (const Measured* m : familyOf(scene, std::string(nameOf(s))))
            table.rows.push_back({m->family, std::to_string(m->spp), wallOf(*m),
                                  milliseconds(quartilesOf(m->deviceSeconds).median), errorOf(scene, *m),
                                  shortNumber(m->total.relMse), m->ssim ? format("%.5f", *m->ssim) : "-",
                                  shortNumber(m->total.max), shortNumber(m->total.percentVisible),
                                  rateOf(*m)});
    return table;
}

bool isTruncated(const Measured& m) {
    return m.family == "depth" || m.family == "cut";
}

// At one sample, where a pixel is one path: rounding errors, by method.
Block methodTable(const SceneReport& scene) {
    Block table = {Block::Table,
                   {{"at 1 spp", "ms (q1..q3)", "compile ms", "RMSE, same path", "max, same path",
                     "other path, pixels", "RMSE, all", "> 1/255 %", "bias"}}};
    for (const Measured& m : scene.measured) {
        if (m.spp != 1 || !m.arithmetic || isTruncated(m) || isSampler(m.family)) continue;
        const ArithmeticError& a = *m.arithmetic;
        table.rows.push_back({m.family, wallOf(m), milliseconds(m.compile), shortNumber(a.samePath.rmse),
                              shortNumber(a.samePath.max), std::to_string(a.otherPath.pixels),
                              shortNumber(a.all.rmse), shortNumber(a.all.percentVisible),
                              shortNumber(a.all.bias)});
    }
    return table;
}

Block truncationTable(const SceneReport& scene) {
    Block table = {Block::Table,
                   {{"at 4 spp", "ms (q1..q3)", "RMSE, same samples", "bound", "max", "> 1/255 %", "bias"}}};
    for (const Measured& m : scene.measured) {
        if (!isTruncated(m) || !m.arithmetic) continue;
        const ErrorMeasures& e = m.arithmetic->all;
        table.rows.push_back({m.family == "cut" ? "cut below " + shortNumber(m.minContribution)
                                                : "depth " + std::to_string(m.depth),
                              wallOf(m), shortNumber(e.rmse), shortNumber(m.bound), shortNumber(e.max),
                              shortNumber(e.percentVisible), shortNumber(e.bias)});
    }
    return table;
}

// Adaptive sampling, --error and the reference.
Block otherWaysTable(const SceneReport& scene) {
    Block table = {Block::Table, {{"in another way", "samples", "ms (q1..q3)", "RMSE", "RMSE / --error"}}};
    for (const Measured& m : scene.measured)
        if (m.family.starts_with("adaptive") || m.family.starts_with("error") || m.family == "reference")
            table.rows.push_back({m.family, shortNumber(m.samples), wallOf(m), errorOf(scene, m),
                                  m.asked > 0 ? shortNumber(m.error / m.asked) : std::string("-")});
    return table;
}

// The arithmetic error that the condition of each scene predicts, and the measured one.
Block stabilityTable(const Report& report) {
    Block table = {Block::Table,
                   {{"scene", "kappa", "class", "expected kappa u", "RMSE, same path", "RMSE, all"}}};
    for (const SceneReport& scene : report.scenes)
        for (const Measured* m : familyOf(scene, "lowDiscrepancy"))
            if (m->spp == 1 && m->arithmetic)
                table.rows.push_back({scene.name, shortNumber(scene.kappa), scene.stiffness,
                                      shortNumber(scene.kappa * reference::kFloatUnit),
                                      shortNumber(m->arithmetic->samePath.rmse),
                                      shortNumber(m->arithmetic->all.rmse)});
    return table;
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
        if (!m.hidden) order.push_back(&m);
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
        else  // errors are measured within the scene's depth
            lines.push_back(start + "--error " + shortNumber(error) +
                            " --within-depth (no measured setting reaches it)");
    }
    return lines;
}

namespace {

std::vector<Block> textOf(const Report& report) {
    std::vector<Block> text;
    const auto add = [&](Block::Kind kind, const std::vector<std::string>& lines) {
        text.push_back({kind, {}});
        for (const std::string& line : lines) text.back().rows.push_back({line});
    };
    for (const SceneReport& scene : report.scenes) {
        add(Block::Heading, {scene.name + ": use these settings"});
        add(Block::List, useTheseSettings(scene));
        add(Block::Diagram, {precisionDiagram(scene)});
    }
    add(Block::Paragraph, {"Errors are RMSE of linear color (full scale 1). Times are of an image without "
                           "loading and compiling, "
                           "the median of at most " +
                           std::to_string(report.repeats) + " runs."});
    add(Block::Paragraph, {"device: " + report.device + ", " + report.driver + ", Vulkan " + report.api +
                           "; " + std::to_string(report.cores) + " cores; glint " + report.version +
                           "; converged images: reference, lowDiscrepancy, other seeds"});
    for (const SceneReport& scene : report.scenes) {
        add(Block::Heading, {scene.name});
        add(Block::Paragraph, {sceneLine(scene)});
        for (const auto table : {samplingTable, methodTable, truncationTable, otherWaysTable})
            text.push_back(table(scene));
        add(Block::Diagram, {truncationDiagram(scene)});
        if (scene.leftOut.empty()) continue;
        add(Block::Paragraph, {"Not measured in the time (repeat the command to resume):"});
        add(Block::List, scene.leftOut);
    }
    const Block stability = stabilityTable(report);
    if (stability.rows.size() > 1) add(Block::Heading, {"Stability"});
    text.push_back(stability);
    std::erase_if(text, [](const Block& b) { return b.kind == Block::Table && b.rows.size() < 2; });
    return text;
}

}  // namespace

std::string toMarkdown(const Report& report) {
    std::string out;
    for (const Block& block : textOf(report)) {
        if (block.kind == Block::Diagram) continue;
        if (!out.empty()) out += "\n";
        for (const std::vector<std::string>& row : block.rows) {
            if (block.kind == Block::Table) {
                for (const std::string& cell : row) out += "| " + cell + " ";
                out += "|\n";
                if (&row != &block.rows.front()) continue;
                for (size_t i = 0; i < row.size(); ++i) out += "|---";
                out += "|\n";
            } else {
                out += (block.kind == Block::Heading ? "## "
                        : block.kind == Block::List  ? "- "
                                                     : "") +
                       row[0] + "\n";
            }
        }
    }
    return out;
}

namespace {

constexpr const char* kHead =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>glint report</title>\n"
    "<style>body{font:15px/1.45 sans-serif;max-width:1100px;margin:1em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:13px}td,th{border:1px solid #ddd;padding:2px 7px;"
    "text-align:right}td:first-child,th:first-child{text-align:left}th{background:#f3f3f3}"
    "svg{max-width:100%;height:auto;display:block}</style></head><body>\n"
    "<h1>Error against run time</h1>\n";

std::string element(const std::string& tag, const std::string& text) {
    return "<" + tag + ">" + escapeMarkup(text) + "</" + tag + ">";
}

std::string blockText(const Block& block) {
    if (block.kind == Block::Diagram) return block.rows[0][0];
    std::string out;
    if (block.kind == Block::Table) {
        for (const std::vector<std::string>& row : block.rows) {
            out += "<tr>";
            for (const std::string& cell : row)
                out += element(&row == &block.rows.front() ? "th" : "td", cell);
            out += "</tr>\n";
        }
        return "<table>\n" + out + "</table>\n";
    }
    const char* const tag = block.kind == Block::List ? "li" : block.kind == Block::Heading ? "h2" : "p";
    for (const std::vector<std::string>& row : block.rows) out += element(tag, row[0]) + "\n";
    return block.kind == Block::List ? "<ul>\n" + out + "</ul>\n" : out;
}

}  // namespace

std::string escapeMarkup(const std::string& text) {
    static const std::map<char, const char*> entities = {
        {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
    std::string out;
    for (const char c : text) {
        const auto entity = entities.find(c);
        out += entity == entities.end() ? std::string(1, c) : entity->second;
    }
    return out;
}

std::string toHtml(const Report& report) {
    std::string out = kHead;
    if (!report.complete) out += "<p><b>Interrupted: the results so far.</b></p>\n";
    for (const Block& block : textOf(report)) out += blockText(block);
    return out + "</body></html>\n";
}

}  // namespace glint::report
