#include "app/render_result.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/common.h"
#include "app/loading.h"
#include "app/picture_advice.h"
#include "core/codecs.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/quantize.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/request_environment.h"
#include "pack/scene_arrays.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

const char* limitOf(converge::Stop stop) {
    switch (stop) {
        case converge::Stop::Samples:
            return "--max-spp";
        case converge::Stop::Seconds:
            return "--max-seconds";
        case converge::Stop::Fixed:
            return "more would not help: cuts and rounding alone exceed the target";
        case converge::Stop::Reached:
        case converge::Stop::Interrupted:
            break;
    }
    return "";
}

// Numbers that are not finite become null.
nlohmann::json errorJson(const ErrorTarget& target, const converge::Result& result) {
    const converge::Target defaults;
    const converge::ErrorBudget& budget = result.budget;
    return {{"asked", *target.error},
            {"confidence", target.confidence.value_or(defaults.confidence)},
            {"reached", result.reached()},
            {"stopped", nameOf(result.stop)},
            {"bound", budget.total()},
            {"sampling", budget.sampling},
            {"estimate", result.estimate},
            {"rounding", budget.rounding},
            {"cut", budget.cut},
            {"maxDepth", budget.depth},
            {"maxDepthCounts", budget.depthCounts},
            {"unseen", result.unseen},
            {"samplesPerPixel", result.samplesPerPixel},
            {"rounds", result.rounds}};
}

// The same for an image's file: glint.error.asked and so on; true is 1, null is left out.
PictureNotes errorNotes(const ErrorTarget& target, const converge::Result& result) {
    const nlohmann::json json = errorJson(target, result);
    PictureNotes notes;
    for (const auto& [key, value] : json.items()) {
        const std::string name = "glint.error." + key;
        if (value.is_string())
            notes.emplace_back(name, value.get<std::string>());
        else if (value.is_boolean())
            notes.emplace_back(name, value.get<bool>() ? 1.0 : 0.0);
        else if (std::isfinite(value.get<double>()))
            notes.emplace_back(name, value.get<double>());
    }
    return notes;
}

std::string errorSummary(const ErrorTarget& target, const converge::Result& result) {
    const converge::Target defaults;
    const converge::ErrorBudget& budget = result.budget;
    std::string text =
        "error (rmse): at most " + format("%.3g", budget.total()) + " with confidence " +
        describe(target.confidence.value_or(defaults.confidence)) + "; sampling " +
        format("%.2g", budget.sampling) + " (about " + format("%.2g", result.estimate) + "), rounding " +
        format("%.1g", budget.rounding) + ", cut " + format("%.1g", budget.cut) + ", maxDepth " +
        format("%.1g", budget.depth) + (budget.depthCounts ? "; " : " (not counted); ") +
        counted(result.samplesPerPixel, "sample") + " per pixel, " + counted(result.rounds, "round");
    // The bound allows for details of full scale; brighter ones are reported apart.
    if (std::isfinite(result.unseen) && result.unseen > budget.total())
        text +=
            "\nnot counted: a highlight as bright as the scene allows that all samples missed might add " +
            format("%.2g", result.unseen);
    return text;
}

// Prints a warning with the reason if the target was not reached.
void warnAboutError(const ErrorTarget& target, const converge::Result& result, const std::string& start,
                    std::ostream& err) {
    if (result.reached() || result.stop == converge::Stop::Interrupted) return;
    // Few pixels with any error tell too little to bound it.
    const bool bounded = std::isfinite(result.budget.total());
    err << start << "target " << format("%.3g", *target.error) << " not reached: "
        << (bounded ? "error is at most " + format("%.3g", result.budget.total()) : "the error has no bound")
        << " after " << counted(result.samplesPerPixel, "sample") << " per pixel (" << limitOf(result.stop)
        << (bounded ? ")" : "); too few pixels show any error") << '\n';
}

// Below half a step of an 8-bit picture nothing is seen; with the sRGB curve's slope of up to 12.92 the steps
// of dark colours are smaller, but there a loss of this size is one of a bright branch.
constexpr double kVisible = 1.0 / 255;

double meanOf(const LostBranches& lost, const Picture& picture) {
    const auto pixels = static_cast<double>(picture.done.size());
    return pixels > 0 ? lost.sum / pixels : 0;
}

// Numbers that are not finite become null.
nlohmann::json lostJson(const LostBranches& lost, const Picture& picture) {
    return {{"branches", lost.count}, {"meanBound", meanOf(lost, picture)}, {"greatestBound", lost.greatest}};
}

std::string boundText(const LostBranches& lost, const Picture& picture) {
    if (!std::isfinite(lost.greatest)) return "how much light that is, is not known";
    return format("a pixel lacks at most %.3g, on average at most %.3g", lost.greatest,
                  meanOf(lost, picture));
}

nlohmann::json samplesJson(const Outcome& outcome) {
    BandTotals totals;
    if (outcome.bands)
        totals = *outcome.bands;
    else
        totals.add(outcome.picture);
    const double mean =
        totals.done > 0 ? static_cast<double>(totals.sum) / static_cast<double>(totals.done) : 0;
    return {{"min", totals.least}, {"mean", mean}, {"max", totals.most}};
}

nlohmann::json statsJson(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded) {
    const render::StageTimes& t = outcome.drawn.times;
    nlohmann::json json;
    json["scene"] = command.scene.scene.string();
    json.update(drawnJson(outcome.drawn));
    if (!outcome.drawn.traversal.empty()) json["traversal"] = outcome.drawn.traversal;
    json["files"] = filesJson(outcome.files);
    json["hash"] = outcome.hash;
    json["complete"] = outcome.picture.complete;
    if (outcome.bands) json["bands"] = outcome.bands->bands;
    if (outcome.ranks > 0) json["ranks"] = outcome.ranks;
    json["width"] = outcome.picture.region.width();
    json["height"] = outcome.picture.region.height();
    json["samplesPerPixel"] = outcome.request.image.samplesPerPixel;
    json["sampler"] = nameOf(samplerOf(outcome.request.image));
    json["samplesTaken"] = samplesJson(outcome);
    json["maxDepth"] = depthOf(loaded.packed, outcome.request);
    visitKinds(loaded.packed, [&](const KindCount& kind) {
        if (kind.kind != shared::PrimitiveKind::Instance) json[kind.array] = kind.count;
    });
    json["intersector"] = nameOf(command.scene.methods.triangles);
    json["sphere"] = nameOf(command.scene.methods.spheres);
    if (outcome.converged) json["error"] = errorJson(command.target, *outcome.converged);
    json["lost"] = lossesJson(outcome.picture);
    json["minContribution"] = command.scene.limits.minContribution;
    json["notFinite"] = outcome.picture.notFinite;
    if (outcome.picture.notFinite > 0)
        json["firstNotFinite"] = {outcome.picture.firstNotFinite.x, outcome.picture.firstNotFinite.y};
    json["seconds"] = {{"load", loaded.loadSeconds},
                       {"pack", loaded.packSeconds},
                       {"upload", t.upload},
                       {"compile", t.compile},
                       {"trace", t.trace},
                       {"device", t.device},
                       {"readback", t.readback},
                       {"write", outcome.writeSeconds},
                       {"total", outcome.totalSeconds},
                       {"longestSubmission", t.longestSubmission}};
    json["submissions"] = t.submissions;
    json["slices"] = t.slices;
    json["resumes"] = t.resumes;
    return json;
}

void printSummary(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                  std::ostream& out) {
    for (const auto& file : outcome.files) {
        out << "wrote " << shown(file) << " (" << outcome.picture.region.width() << "x"
            << outcome.picture.region.height() << ")\n";
    }
    if (outcome.converged) out << errorSummary(command.target, *outcome.converged) << '\n';
    printDevice(outcome.drawn, out);
    if (outcome.ranks > 0) out << "ranks: " << outcome.ranks << '\n';
    out << "hash: " << outcome.hash;
    if (outcome.drawn.arithmetic && !outcome.drawn.arithmetic->sharesBits())
        out << " (this device " << outcome.drawn.arithmetic->text() << ')';
    out << '\n';
    printTimes(outcome, loaded, out);
}

}  // namespace

nlohmann::json lossesJson(const Picture& picture) {
    const TreeLosses& losses = picture.losses;
    return {{"cut", lostJson(losses.cut, picture)},
            {"maxDepth", lostJson(losses.depth, picture)},
            {"waiting", lostJson(losses.room, picture)},
            {"crowdedMedia", losses.crowdedMedia}};
}

void warnOfLosses(const Picture& picture, const std::string& start, std::ostream& err) {
    const TreeLosses& losses = picture.losses;
    const auto branches = [](uint64_t count) {
        return std::to_string(count) + (count == 1 ? " branch" : " branches");
    };
    if (losses.cut.count > 0)
        err << start << "--min-contribution cut " << branches(losses.cut.count) << "; "
            << boundText(losses.cut, picture) << '\n';
    if (losses.depth.greatest > kVisible)
        err << start << branches(losses.depth.count)
            << " beyond maxDepth not followed (increase --max-depth); " << boundText(losses.depth, picture)
            << '\n';
    if (losses.room.count > 0)
        err << start << branches(losses.room.count) << " dropped, as " << shared::kMaxWaiting
            << " others were waiting already; " << boundText(losses.room, picture) << '\n';
    if (losses.crowdedMedia > 0)
        err << start << "rays inside " << shared::kMaxMedia << " media at a time passed "
            << counted(losses.crowdedMedia, "surface") << " of more as if they were not there\n";
}

void BandTotals::add(const Picture& band) {
    for (size_t i = 0; i < band.done.size(); ++i) {
        if (!band.done[i]) continue;
        const uint32_t taken = band.samples.empty() ? band.samplesPerPixel : band.samples[i];
        least = done == 0 ? taken : std::min(least, taken);
        most = std::max(most, taken);
        sum += taken;
        ++done;
    }
    ++bands;
}

double Outcome::doneShare() const {
    const Region& r = picture.region;
    const double pixels = static_cast<double>(r.width()) * r.height();
    if (bands) return static_cast<double>(bands->done) / pixels;
    return static_cast<double>(std::count(picture.done.begin(), picture.done.end(), 1)) / pixels;
}

nlohmann::json drawnJson(const DrawingFacts& drawn) {
    nlohmann::json json = {{"backend", nameOf(drawn.backend)},
                           {"device", drawn.device},
                           {"driver", drawn.driver},
                           {"reproducible", drawn.sharesBits()}};
    if (drawn.failed) json["fallback"] = {{"device", drawn.failed->name}, {"reason", drawn.failed->reason}};
    return json;
}

nlohmann::json filesJson(const std::vector<std::filesystem::path>& files) {
    nlohmann::json json = nlohmann::json::array();
    for (const std::filesystem::path& file : files) json.push_back(file.string());
    return json;
}

void printDevice(const DrawingFacts& drawn, std::ostream& out) {
    if (!drawn.device.empty()) out << "device: " << drawn.device << ", " << drawn.driver << '\n';
}

void printTimes(const Outcome& outcome, const LoadedScene& loaded, std::ostream& out) {
    const render::StageTimes& t = outcome.drawn.times;
    out << "times: load " << formatSeconds(loaded.loadSeconds) << ", BVH and packing "
        << formatSeconds(loaded.packSeconds);
    if (t.submissions > 0) {
        out << ", upload " << formatSeconds(t.upload) << ", compile " << formatSeconds(t.compile);
    }
    out << ", trace " << formatSeconds(t.trace);
    if (t.submissions > 0) out << ", readback " << formatSeconds(t.readback);
    out << ", write " << formatSeconds(outcome.writeSeconds) << "; " << formatSeconds(outcome.totalSeconds)
        << " in all\n";
}

void warnOfNotFinite(const Picture& picture, const std::string& start, std::ostream& err) {
    if (picture.notFinite == 0) return;
    err << start << counted(picture.notFinite, "pixel") << " not finite (NaN or infinite), the first at "
        << picture.firstNotFinite.x << ',' << picture.firstNotFinite.y
        << "; shown black. Is a light of falloff inverseSquare almost on a surface, or far too "
           "bright?\n";
}

void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err) {
    if (command.quiet) return;
    const Picture& picture = outcome.picture;
    const std::string start = "glint: warning: " + command.scene.scene.string() + ": ";
    warnOfNotFinite(picture, start, err);
    // That mirrors face each other without end is nothing new.
    if (loaded.packed.features.transmission || command.scene.limits.minContribution > 0)
        warnOfLosses(picture, start, err);
    if (outcome.converged) warnAboutError(command.target, *outcome.converged, start, err);
    const auto advice = outcome.bands ? outcome.bands->advice
                                      : pictureAdvice(picture, loaded.scene, loaded.packed, outcome.request,
                                                      scaleOf(outcome.output, command.exposure));
    if (advice) err << start << *advice << '\n';
}

float scaleOf(const std::filesystem::path& output, std::optional<double> exposure) {
    if (output == "-" || lowerExtension(output) == ".png")
        return static_cast<float>(std::exp2(exposure.value_or(0)));
    if (exposure && isWritableImagePath(output))
        throw Error(ErrorKind::Argument,
                    "--exposure: " + output.string() + " holds linear floats, which need none; use .png");
    return 0;
}

void expose(std::vector<Layer>& layers, float scale) {
    if (scale == 0 || scale == 1) return;
    for (Layer& layer : layers)
        if (layer.name == "color")
            for (size_t i = 0; i < layer.image.pixels.size(); ++i)
                if (layer.image.channels < 4 || i % 4 < 3) layer.image.pixels[i] *= scale;
}

std::vector<std::string> namesOf(const std::vector<Aov>& aovs) {
    std::vector<std::string> names;
    for (const Aov aov : aovs) names.emplace_back(nameOf(aov));
    return names;
}

void writePicture(Outcome& outcome, const RenderCommand& command, std::ostream& out) {
    if (outcome.doneShare() == 0)
        throw Error(ErrorKind::Interrupted,
                    "interrupted before any part of the picture was finished; nothing written");
    if (outcome.bands) return;
    blackenNotFinite(outcome.picture);
    const Stopwatch writing;
    outcome.hash = pictureHash(outcome.picture.color);
    std::vector<Layer> layers = makeLayers(outcome.picture, command.aovs);
    expose(layers, scaleOf(outcome.output, command.exposure));
    if (outcome.output == "-") {
        const Image& image = layers.front().image;
        const auto bytes = encodePng(image.width, image.height, image.channels, quantizeColor(image));
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        outcome.files = {"standard output"};
    } else {
        outcome.files =
            writeLayers(outcome.output, layers,
                        outcome.converged ? errorNotes(command.target, *outcome.converged) : PictureNotes{});
    }
    outcome.writeSeconds = writing.seconds();
}

void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 std::ostream& out) {
    if (command.output == "-") {
        out.flush();  // the image
    } else if (command.json) {
        printJson(statsJson(outcome, command, loaded), out);
    } else if (!command.quiet) {
        printSummary(outcome, command, loaded, out);
    }
}

}  // namespace glint::app
