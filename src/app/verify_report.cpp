#include "app/verify_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <utility>

#include "app/common.h"
#include "core/image_io.h"
#include "core/text_file.h"
#include "report/write.h"

namespace glint::app {

namespace {

constexpr size_t kPrintedPixels = 10;

// Result of one tracer for a pixel.
struct Seen {
    glm::dvec3 color;
    uint32_t pathHash, bounces;
    bool hit;
    uint32_t object = 0, primitive = 0;
    double t = 0;
    glm::dvec3 position{0};
};

Seen seenBy(const verify::DifferingPixel& pixel) {
    const PixelData& d = pixel.device;
    const bool hit = d.object != PixelData::kNoIndex;
    return {glm::dvec3(pixel.deviceColor),
            d.pathHash,
            d.bounces,
            hit,
            d.object,
            d.primitive,
            d.depth,
            d.position};
}

Seen seenBy(const reference::PixelRecord& r, const glm::dvec3& origin) {
    Seen seen = {r.color, r.pathHash, r.bounces, r.hit && r.surface};
    if (seen.hit) {
        seen.object = r.surface->object;
        seen.primitive = r.surface->primitive;
        seen.t = r.hit->t;
        seen.position = origin + r.surface->position;
    }
    return seen;
}

void printSeen(const char* who, const Seen& s, std::ostream& out) {
    out << format("      %-9s  color (%.6g %.6g %.6g)  ", who, s.color.x, s.color.y, s.color.z);
    if (s.hit)
        out << format("object %u primitive %u t %.9g at (%.9g %.9g %.9g)  ", s.object, s.primitive, s.t,
                      s.position.x, s.position.y, s.position.z);
    else
        out << "miss  ";
    out << format("bounces %u path %08x\n", s.bounces, s.pathHash);
}

void printPixel(const verify::DifferingPixel& pixel, bool manySamples, const glm::dvec3& origin,
                std::ostream& out) {
    out << "    pixel " << pixel.x << ',' << pixel.y;
    if (manySamples) out << " sample " << pixel.sample;
    out << format(": difference %.6g, ", pixel.difference) << nameOf(pixel.reason);
    if (pixel.reason != verify::Reason::Unexplained && pixel.reason != verify::Reason::Undecided)
        out << format(" (%u open decisions, rays moved by at most %.3g x 2^-24)", pixel.openDecisions,
                      pixel.ulps);
    out << '\n';
    printSeen("device", seenBy(pixel), out);
    printSeen("reference", seenBy(pixel.reference, origin), out);
}

void printRepresentation(const verify::Representation& r, const glm::dvec3& origin, std::ostream& out) {
    out << "    rounding the scene: " << r.asked
        << format(" pixels of the reference, RMSE %.3g, 99th percentile %.3g, max %.3g", r.rmse, r.p99,
                  r.greatest)
        << "; beyond what moved numbers predict: " << r.explained << " explained, " << r.unexplained
        << " unexplained\n";
    for (const verify::RepresentedPixel& pixel : r.worst) {
        if (pixel.explained) continue;
        out << "    pixel " << pixel.x << ',' << pixel.y << " sample " << pixel.sample
            << format(": difference %.6g by packing, unexplained\n", pixel.difference);
        printSeen("packed", seenBy(pixel.rounded, origin), out);
        printSeen("read", seenBy(pixel.truth, origin), out);
    }
}

nlohmann::json seenJson(const Seen& s) {
    nlohmann::json json = {{"color", {s.color.x, s.color.y, s.color.z}},
                           {"hit", s.hit},
                           {"bounces", s.bounces},
                           {"path", s.pathHash}};
    if (s.hit) {
        json["object"] = s.object;
        json["primitive"] = s.primitive;
        json["t"] = s.t;
    }
    return json;
}

nlohmann::json pixelsJson(const verify::Report& report) {
    nlohmann::json pixels = nlohmann::json::array();
    for (const verify::DifferingPixel& pixel : report.worst)
        pixels.push_back({{"x", pixel.x},
                          {"y", pixel.y},
                          {"sample", pixel.sample},
                          {"reason", nameOf(pixel.reason)},
                          {"difference", pixel.difference},
                          {"openDecisions", pixel.openDecisions},
                          {"units", pixel.ulps},
                          {"device", seenJson(seenBy(pixel))},
                          {"reference", seenJson(seenBy(pixel.reference, glm::dvec3(0)))}});
    return pixels;
}

std::string testCase(const SceneResult& result) {
    const auto markup = [](const std::string& text) { return report::escapeMarkup(printable(text)); };
    std::string inside;
    if (result.status != SceneStatus::Passed) {
        const std::string name =
            result.status == SceneStatus::Failed ? "failure" : std::string(nameOf(result.status));
        inside = "\n    <" + name + " message=\"" + markup(result.message) + "\">" +
                 report::escapeMarkup(result.details) + "</" + name + ">\n  ";
    }
    return "  <testcase classname=\"glint.verify\" name=\"" + markup(result.scene) + "\" time=\"" +
           format("%.3f", result.seconds) + "\">" + inside + "</testcase>\n";
}

}  // namespace

std::string verdict(const verify::Report& report) {
    if (report.passed()) {
        if (report.unexplained > 0)
            return "ok: " + std::to_string(report.unexplained) + " unexplained, " +
                   std::to_string(report.allowedUnexplained) + " allowed";
        return "ok";
    }
    if (report.unexplained > report.allowedUnexplained) return "FAILED: unexplained pixels";
    if (report.plainDiffers > 0) return "FAILED: the image without layers has other bits";
    if (report.filmDiffers > 0) return "FAILED: the image is not the mean of its samples";
    if (report.lossesDiffer) return "FAILED: device and reference leave out different branches";
    if (report.representation && report.representation->unexplained > 0)
        return "FAILED: the packed scene differs from the scene by more than rounding";
    if (report.explained() <= report.allowedExplained())
        return "FAILED: more pixels are undecided than may differ: their paths take too many steps to "
               "examine";
    return "FAILED: too many pixels differ, though rounding explains each: the method loses digits here";
}

void printReport(const std::string& scene, const verify::Report& report, const verify::Options& options,
                 const glm::dvec3& origin, std::ostream& out) {
    const verify::Sensitivity& s = report.sensitivity;
    out << scene << ": " << verdict(report) << "\n    " << report.pixels
        << " pixels; beyond their predicted error: " << report.edges << " edge, " << report.roundings
        << " rounding, " << report.undecided << " undecided (at most " << report.allowedExplained() << "), "
        << report.unexplained << " unexplained\n    sensitivity: " << format("%.3g", s.changedByOne())
        << " of " << s.tried << " pixels change when rays move by 2^-24, " << s.changedWidely
        << " by 32 times that, " << s.open << " by the order of surfaces in one place\n"
        << format("    RMSE %.3g; where the paths agree: RMSE %.3g, max %.3g\n", report.rmse,
                  report.rmseSamePath, report.maxSamePath);
    if (report.plainDiffers > 0)
        out << "    " << report.plainDiffers << " pixels have other bits without layers\n";
    if (report.filmDiffers > 0)
        out << "    " << report.filmDiffers << " pixels are not the mean of the samples that they need\n";
    if (report.lossesDiffer) out << "    other branches are left out, or bounded otherwise\n";
    out << format("    kappa %.2g (%s): expected fp32 error %.2g, measured %.2g (99th percentile)\n", s.kappa,
                  verify::stiffnessOf(s.kappa), s.kappa * verify::kFloatUnit, report.p99);
    if (report.representation) printRepresentation(*report.representation, origin, out);
    for (size_t i = 0; i < std::min(report.worst.size(), kPrintedPixels); ++i)
        printPixel(report.worst[i], options.samples.round > 1, origin, out);
}

nlohmann::json reportJson(const verify::Report& report) {
    const verify::Sensitivity& s = report.sensitivity;
    nlohmann::json json = {
        {"passed", report.passed()},
        {"pixels", report.pixels},
        {"kappa", s.kappa},
        {"arithmetic",
         {{"rmse", report.rmse},
          {"rmseSamePath", report.rmseSamePath},
          {"maxSamePath", report.maxSamePath},
          {"p99", report.p99},
          {"edge", report.edges},
          {"rounding", report.roundings},
          {"allowed", report.allowedExplained()},
          {"undecided", report.undecided},
          {"unexplained", report.unexplained}}},
        {"plainDiffers", report.plainDiffers},
        {"filmDiffers", report.filmDiffers},
        {"lossesDiffer", report.lossesDiffer ? 1 : 0},
        {"allowedUnexplained", report.allowedUnexplained},
        {"differing", report.explained() + report.unexplained},
        {"differingPixels", pixelsJson(report)},
    };
    if (!report.representation) return json;
    const verify::Representation& r = *report.representation;
    json["representation"] = {
        {"pixels", r.asked}, {"rmse", r.rmse},           {"p99", r.p99},
        {"max", r.greatest}, {"explained", r.explained}, {"unexplained", r.unexplained}};
    return json;
}

std::string briefFigures(const verify::Report& report) {
    return std::to_string(report.pixels) + " pixels, " + std::to_string(report.explained()) + " explained, " +
           std::to_string(report.unexplained) + " unexplained, RMSE " + format("%.3g", report.rmse);
}

size_t countOf(const std::vector<SceneResult>& results, SceneStatus status) {
    return static_cast<size_t>(
        std::count_if(results.begin(), results.end(), [&](const auto& r) { return r.status == status; }));
}

double secondsOf(const std::vector<SceneResult>& results) {
    double sum = 0;
    for (const SceneResult& result : results) sum += result.seconds;
    return sum;
}

std::string jsonText(const std::vector<SceneResult>& results, const std::string& device,
                     const std::string& driver) {
    nlohmann::json file = {{"format", "glint.verify"}, {"version", kVerifyJsonVersion},
                           {"glint", GLINT_VERSION},   {"device", device},
                           {"driver", driver},         {"scenes", nlohmann::json::array()}};
    for (const EnumEntry<SceneStatus>& status : kEnumEntries<SceneStatus>)
        file["summary"][std::string(status.name)] = countOf(results, status.value);
    for (const SceneResult& result : results) {
        nlohmann::json scene = {{"scene", result.scene},
                                {"status", nameOf(result.status)},
                                {"verdict", result.message},
                                {"seconds", result.seconds}};
        if (result.facts.is_object()) scene.update(result.facts);
        file["scenes"].push_back(std::move(scene));
    }
    std::ostringstream text;
    printJson(file, text);
    return text.str();
}

std::string junitText(const std::vector<SceneResult>& results) {
    std::ostringstream out;
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"glint verify\" tests=\""
        << results.size() << "\" failures=\"" << countOf(results, SceneStatus::Failed) << "\" errors=\""
        << countOf(results, SceneStatus::Error) << "\" skipped=\"" << countOf(results, SceneStatus::Skipped)
        << "\" time=\"" << format("%.3f", secondsOf(results)) << "\">\n";
    for (const SceneResult& result : results) out << testCase(result);
    out << "</testsuite>\n";
    return out.str();
}

void writeArtifacts(const std::filesystem::path& folder, const std::string& stem,
                    const verify::Report& report) {
    writeImage(folder / (stem + ".device.png"), report.device);
    writeImage(folder / (stem + ".reference.png"), report.reference);
    writeImage(folder / (stem + ".difference.png"), report.difference);
}

}  // namespace glint::app
