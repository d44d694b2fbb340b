#include "app/render_result.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/common.h"
#include "app/loading.h"
#include "app/picture_advice.h"
#include "pack/scene_arrays.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

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
    json["backend"] = nameOf(outcome.drawn.failed ? Backend::Cpu : command.backend);
    json["device"] = outcome.drawn.device;
    json["driver"] = outcome.drawn.driver;
    if (outcome.drawn.failed) json["fallback"] = fallbackJson(*outcome.drawn.failed);
    if (!outcome.drawn.traversal.empty()) json["traversal"] = outcome.drawn.traversal;
    json["files"] = nlohmann::json::array();
    for (const auto& file : outcome.files) json["files"].push_back(file.string());
    json["hash"] = outcome.hash;
    json["reproducible"] = outcome.drawn.arithmetic && outcome.drawn.arithmetic->sharesBits();
    json["complete"] = outcome.picture.complete;
    if (outcome.bands) json["bands"] = outcome.bands->bands;
    if (outcome.ranks > 0) json["ranks"] = outcome.ranks;
    json["width"] = outcome.picture.region.width();
    json["height"] = outcome.picture.region.height();
    json["samplesPerPixel"] = outcome.request.image.samplesPerPixel;
    json["sampler"] = nameOf(samplerOf(outcome.request.image));
    json["samplesTaken"] = samplesJson(outcome);
    json["maxDepth"] = depthOf(loaded, outcome.request);
    visitKinds(loaded.packed, [&](const KindCount& kind) {
        if (kind.kind != shared::PrimitiveKind::Instance) json[kind.array] = kind.count;
    });
    json["intersector"] = nameOf(command.scene.methods.triangles);
    json["sphere"] = nameOf(command.scene.methods.spheres);
    if (outcome.converged) json["error"] = errorJson(command.target, *outcome.converged);
    json["lost"] = lossesJson(outcome.picture);
    json["minContribution"] = command.scene.minContribution;
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
    const render::StageTimes& t = outcome.drawn.times;
    for (const auto& file : outcome.files) {
        out << "wrote " << shown(file) << " (" << outcome.picture.region.width() << "x"
            << outcome.picture.region.height() << ")\n";
    }
    if (outcome.converged) out << errorSummary(command.target, *outcome.converged) << '\n';
    if (!outcome.drawn.device.empty())  // else nothing was left to draw
        out << "device: " << outcome.drawn.device << ", " << outcome.drawn.driver << '\n';
    if (outcome.ranks > 0) out << "ranks: " << outcome.ranks << '\n';
    out << "hash: " << outcome.hash;
    if (outcome.drawn.arithmetic && !outcome.drawn.arithmetic->sharesBits())
        out << " (this device " << outcome.drawn.arithmetic->text() << ')';
    out << '\n';
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

Picture drawPicture(Drawing& drawing, const Request& request, const std::optional<converge::Job>& job,
                    Outcome& outcome) {
    return drawing.whole([&] {
        if (!job) return drawing.draw(request);
        outcome.converged = converge::converge([&](const Request& r) { return drawing.draw(r); }, *job);
        return std::move(outcome.converged->picture);
    });
}

nlohmann::json fallbackJson(const FailedDevice& failed) {
    return {{"device", failed.name}, {"reason", failed.reason}};
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
    const Picture& picture = outcome.picture;
    const std::string start = "glint: warning: " + command.scene.scene.string() + ": ";
    warnOfNotFinite(picture, start, err);
    // That mirrors face each other without end is nothing new.
    if (loaded.packed.features.transmission || command.scene.minContribution > 0)
        warnOfLosses(picture, start, err);
    if (outcome.converged) warnAboutError(command.target, *outcome.converged, start, err);
    const auto advice = outcome.bands ? outcome.bands->advice
                                      : pictureAdvice(picture, loaded.scene, loaded.packed, outcome.request,
                                                      scaleOf(outputOf(command), command.exposure));
    if (advice) err << start << *advice << '\n';
}

PictureNotes notesOf(const Outcome& outcome, const RenderCommand& command) {
    return outcome.converged ? errorNotes(command.target, *outcome.converged) : PictureNotes{};
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
