#include "app/render_command.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/commands.h"
#include "core/available_memory.h"
#include "core/codecs.h"
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

// Numbers that are not finite become null.
nlohmann::json errorJson(const converge::Target& target, const converge::Result& result) {
    const converge::ErrorBudget& budget = result.budget;
    return {{"asked", target.error},
            {"confidence", target.confidence},
            {"reached", result.reached()},
            {"stopped", nameOf(*result.stop)},
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

std::string errorSummary(const converge::Target& target, const converge::Result& result) {
    const converge::ErrorBudget& budget = result.budget;
    std::string text =
        format("error (rmse): at most %.3g with confidence ", budget.total()) + describe(target.confidence) +
        format("; sampling %.2g (about %.2g), rounding %.2g, cut %.2g, maxDepth %.2g%s; ", budget.sampling,
               result.estimate, budget.rounding, budget.cut, budget.depth,
               budget.depthCounts ? "" : " (not counted)") +
        counted(result.samplesPerPixel, "sample") + " per pixel, " + counted(result.rounds, "round") + "\n";
    // The bound allows for details of full scale; brighter ones are reported apart.
    if (std::isfinite(result.unseen) && result.unseen > budget.total())
        text += format(
            "not counted: a highlight as bright as the scene allows that all samples missed might add %.2g\n",
            result.unseen);
    return text;
}

// Prints a warning with the reason if the target was not reached.
void warnAboutError(const converge::Target& target, const converge::Result& result, const std::string& start,
                    std::ostream& err) {
    if (result.reached() || result.stop == converge::Stop::Interrupted) return;
    // Few pixels with any error tell too little to bound it.
    const bool bounded = std::isfinite(result.budget.total());
    err << start << format("target %.3g not reached: ", target.error)
        << (bounded ? format("error is at most %.3g", result.budget.total()) : "the error has no bound")
        << " after " << counted(result.samplesPerPixel, "sample") << " per pixel (" << helpOf(*result.stop)
        << (bounded ? ")" : "); too few pixels show any error") << '\n';
}

// A loss below half a step of an 8-bit image is invisible. The sRGB curve's slope of up to 12.92 makes the
// steps of dark colours smaller, but a loss of this size there comes from a bright branch.
constexpr double kVisible = 1.0 / 255;

double meanOf(const LostBranches& lost, const Region& region) {
    return lost.sum / static_cast<double>(region.pixels());
}

// Numbers that are not finite become null.
nlohmann::json lostJson(const LostBranches& lost, const Region& region) {
    return {{"branches", lost.count}, {"meanBound", meanOf(lost, region)}, {"greatestBound", lost.greatest}};
}

std::string boundText(const LostBranches& lost, const Region& region) {
    if (!std::isfinite(lost.greatest)) return "no bound on their light is known";
    return format("a pixel lacks at most %.3g, on average at most %.3g", lost.greatest, meanOf(lost, region));
}

nlohmann::json samplesJson(const SampleTotals& totals) {
    const double mean =
        totals.done > 0 ? static_cast<double>(totals.sum) / static_cast<double>(totals.done) : 0;
    return {{"min", totals.least}, {"mean", mean}, {"max", totals.most}};
}

// Multiplies the layer "color" by `scale`, unless it is 0.
void expose(std::vector<Layer>& layers, float scale) {
    if (scale == 0 || scale == 1) return;
    for (Layer& layer : layers)
        if (layer.name == "color")
            for (size_t i = 0; i < layer.image.pixels.size(); ++i)
                if (layer.image.channels < 4 || i % 4 < 3) layer.image.pixels[i] *= scale;
}

nlohmann::json statsJson(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                         const Request& request) {
    const render::StageTimes& t = outcome.drawn.times;
    const Written& written = outcome.written;
    nlohmann::json json = drawnJson(outcome.drawn);
    json.update(imageJson(outcome));
    json.update({{"scene", command.scene.scene.string()},
                 {"complete", outcome.complete},
                 {"samplesPerPixel", request.samplesPerPixel},
                 {"sampler", nameOf(samplerOf(request))},
                 {"samplesTaken", samplesJson(written.totals)},
                 {"maxDepth", depthOf(loaded.packed, request)},
                 {"intersector", nameOf(command.scene.methods.triangles)},
                 {"sphere", nameOf(command.scene.methods.spheres)},
                 {"minContribution", command.scene.limits.minContribution},
                 {"submissions", t.submissions},
                 {"slices", t.slices},
                 {"resumes", t.resumes},
                 {"seconds",
                  {{"load", loaded.loadSeconds},
                   {"pack", loaded.packSeconds},
                   {"upload", t.upload},
                   {"compile", t.compile},
                   {"trace", t.trace},
                   {"device", t.device},
                   {"readback", t.readback},
                   {"write", written.seconds},
                   {"total", outcome.totalSeconds},
                   {"longestSubmission", t.longestSubmission}}}});
    visitKinds(loaded.packed, [&](const KindCount& kind) {
        if (kind.kind != shared::PrimitiveKind::Instance) json[kind.array] = kind.count;
    });
    if (!written.hash.empty()) json["hash"] = written.hash;
    if (!outcome.drawn.traversal.empty()) json["traversal"] = outcome.drawn.traversal;
    if (command.part)
        json.update(
            {{"part", command.part->number}, {"parts", command.part->of}, {"pixels", written.totals.done}});
    if (written.bands > 0) json["bands"] = written.bands;
    if (outcome.ranks > 0) json["ranks"] = outcome.ranks;
    if (outcome.converged) json["error"] = errorJson(command.target, *outcome.converged);
    const glm::ivec2 first = outcome.flaws.firstNotFinite;
    if (first.x >= 0) json["firstNotFinite"] = {first.x, first.y};
    return json;
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
    out << ", write " << formatSeconds(outcome.written.seconds) << "; " << formatSeconds(outcome.totalSeconds)
        << " in all\n";
}

void printSummary(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                  std::ostream& out) {
    if (command.part)
        out << "wrote " << shown(outcome.written.files.front())
            << format(" (part %d of %d, ", command.part->number, command.part->of)
            << counted(outcome.written.totals.done, "pixel") << ")\n";
    else
        printFiles(outcome, out);
    if (outcome.converged) out << errorSummary(command.target, *outcome.converged);
    printDevice(outcome.drawn, out);
    if (outcome.ranks > 0) out << "ranks: " << outcome.ranks << '\n';
    if (!command.part) {
        out << "hash: " << outcome.written.hash;
        if (outcome.drawn.arithmetic && !outcome.drawn.sharesBits())
            out << " (this device " << outcome.drawn.arithmetic->text() << ')';
        out << '\n';
    }
    printTimes(outcome, loaded, out);
}

}  // namespace

nlohmann::json imageJson(const Outcome& outcome) {
    const TreeLosses& losses = outcome.flaws.losses;
    return {{"files", filesJson(outcome.written.files)},
            {"width", outcome.region.width()},
            {"height", outcome.region.height()},
            {"notFinite", outcome.flaws.notFinite},
            {"lost",
             {{"cut", lostJson(losses.cut, outcome.region)},
              {"maxDepth", lostJson(losses.depth, outcome.region)},
              {"waiting", lostJson(losses.room, outcome.region)},
              {"crowdedMedia", losses.crowdedMedia}}}};
}

void warnOf(const Outcome& outcome, bool losses, const std::string& start, std::ostream& err) {
    const auto& [notFinite, firstNotFinite, lost] = outcome.flaws;
    if (notFinite > 0)
        err << start << counted(notFinite, "pixel") << " not finite (NaN or infinite), the first at "
            << firstNotFinite.x << ',' << firstNotFinite.y
            << "; shown black. Is a light of falloff inverseSquare almost on a surface, or far too "
               "bright?\n";
    if (!losses) return;
    const auto& [cut, depth, room, crowdedMedia] = lost;
    const auto branches = [](uint64_t count) {
        return std::to_string(count) + (count == 1 ? " branch" : " branches");
    };
    if (cut.count > 0)
        err << start << "--min-contribution cut " << branches(cut.count) << "; "
            << boundText(cut, outcome.region) << '\n';
    if (depth.greatest > kVisible)
        err << start << branches(depth.count) << " beyond maxDepth not followed (increase --max-depth); "
            << boundText(depth, outcome.region) << '\n';
    if (room.count > 0)
        err << start << "dropped " << branches(room.count) << ", as at most " << shared::kMaxWaiting
            << " can wait; " << boundText(room, outcome.region) << '\n';
    if (crowdedMedia > 0)
        err << start << "ignored " << counted(crowdedMedia, "surface") << ": a ray can be inside at most "
            << shared::kMaxMedia << " dielectrics\n";
}

void SampleTotals::add(const Picture& picture) {
    for (size_t i = 0; i < picture.done.size(); ++i) {
        if (!picture.done[i]) continue;
        const uint32_t taken = picture.samples.empty() ? picture.samplesPerPixel : picture.samples[i];
        least = done == 0 ? taken : std::min(least, taken);
        most = std::max(most, taken);
        sum += taken;
        ++done;
    }
}

nlohmann::json drawnJson(const DrawingFacts& drawn) {
    return {{"backend", nameOf(drawn.backend)},
            {"device", drawn.device},
            {"driver", drawn.driver},
            {"reproducible", drawn.sharesBits()}};
}

nlohmann::json filesJson(const std::vector<std::filesystem::path>& files) {
    nlohmann::json json = nlohmann::json::array();
    for (const std::filesystem::path& file : files) json.push_back(file.string());
    return json;
}

void printFiles(const Outcome& outcome, std::ostream& out) {
    for (const auto& file : outcome.written.files)
        out << "wrote " << shown(file) << " (" << outcome.region.width() << "x" << outcome.region.height()
            << ")\n";
}

void printDevice(const DrawingFacts& drawn, std::ostream& out) {
    if (!drawn.device.empty()) out << "device: " << drawn.device << ", " << drawn.driver << '\n';
}

// Mirrors that face each other omit branches in every image: that alone is no reason to warn.
bool reportsLosses(const RenderCommand& command, const LoadedScene& loaded) {
    return loaded.packed.features.transmission || command.scene.limits.minContribution > 0;
}

void warnAboutPicture(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                      std::ostream& err) {
    const std::string start = warningOf(command.scene.scene);
    warnOf(outcome, reportsLosses(command, loaded), start, err);
    if (outcome.converged) warnAboutError(command.target, *outcome.converged, start, err);
    if (outcome.advice) err << start << *outcome.advice << '\n';
}

float scaleOf(const std::filesystem::path& output, std::optional<double> exposure) {
    if (output == "-" || lowerExtension(output) == ".png")
        return static_cast<float>(std::exp2(exposure.value_or(0)));
    refuseIf(exposure && isWritableImagePath(output),
             "--exposure: " + output.string() + " holds linear floats, which need none; use .png");
    return 0;
}

std::vector<std::string> namesOf(const std::vector<Aov>& aovs) {
    std::vector<std::string> names;
    for (const Aov aov : aovs) names.emplace_back(nameOf(aov));
    return names;
}

bool goesByRows(const std::filesystem::path& output, const std::vector<Aov>& aovs, const Region& region,
                uint64_t bytesPerPixel, uint64_t further, bool wanted) {
    const bool able = output != "-" && canWriteRows(output, namesOf(aovs));
    refuseIf(wanted && !able,
             output.string() + ": bands go into .png (layers color and alpha alone), .exr and .pfm");
    const uint64_t available = availableMemory();
    if (!wanted && region.pixels() * bytesPerPixel + further <= available) return false;
    if (!able) checkMemory(region.width(), region.height(), bytesPerPixel, available);
    return able;
}

PictureFile::PictureFile(const std::filesystem::path& output, const Region& region,
                         const std::vector<Aov>& aovs, std::optional<double> exposure, bool byRows)
    : output_(output), scale_(scaleOf(output, exposure)), left_(region.height()) {
    if (byRows) rows_.emplace(output, region.width(), left_, makeLayers(Picture(), aovs));
}

void PictureFile::add(const Picture& rows, std::vector<Layer> layers) {
    const Stopwatch writing;
    left_ -= rows.region.height();
    written_.totals.add(rows);
    hash_.add(rows.color);
    expose(layers, scale_);
    if (rows_) {
        ++written_.bands;
        rows_->add(layers);
    } else {
        layers_ = std::move(layers);
    }
    written_.seconds += writing.seconds();
}

void PictureFile::fill(const Picture& row, std::vector<Layer> layers) {
    if (left_ == 0 || written_.totals.done == 0) return;
    const Stopwatch writing;
    hash_.fill(left_, row.color);
    expose(layers, scale_);
    rows_->fill(layers);
    written_.seconds += writing.seconds();
}

Written PictureFile::finish(std::ostream& out, const PictureNotes& notes) {
    if (written_.totals.done == 0)
        throw Error(ErrorKind::Interrupted,
                    "interrupted before any part of the image was finished; nothing written");
    const Stopwatch writing;
    if (rows_) {
        written_.files = rows_->finish();
    } else if (output_ == "-") {
        const Image& image = layers_.front().image;
        const auto bytes = encodePng(image.width, image.height, image.channels, quantizeColor(image));
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        written_.files = {"standard output"};
    } else {
        written_.files = writeLayers(output_, layers_, notes);
    }
    written_.hash = hash_.text();
    written_.seconds += writing.seconds();
    return std::move(written_);
}

Outcome drawInto(PictureFile& file, Drawing& drawing, const RenderCommand& command, const LoadedScene& loaded,
                 const Request& request, const std::optional<converge::Job>& job, int rows) {
    Outcome outcome;
    const Region region = outcome.region = request.region;
    bool alike = !command.quiet;  // all bands so far lack the same
    Request part = request;
    for (int y = region.y0; y < region.y1 && outcome.complete; y += rows) {
        part.region = {region.x0, y, region.x1, std::min(y + rows, region.y1)};
        const auto share = [&](int row) { return static_cast<double>(row - region.y0) / region.height(); };
        const double from = share(y), to = share(part.region.y1);
        part.progress = [&](double done) { request.progress(from + (to - from) * done); };
        if (job)
            outcome.converged = converge::converge([&](const Request& r) { return drawing.draw(r); }, *job);
        Picture band = job ? std::move(outcome.converged->picture) : drawing.draw(part);
        if (alike) {
            const auto reason = pictureAdvice(band, loaded, request, file.scale());
            alike = reason && (y == region.y0 || reason == outcome.advice);
            outcome.advice = alike ? reason : std::nullopt;
        }
        outcome.flaws.add(band);
        outcome.complete = band.complete;
        blackenNotFinite(band);
        file.add(band, makeLayers(band, command.aovs));
    }
    // After an interrupt, rows from here on are blank.
    part.region.y1 = part.region.y0 + 1;
    const Picture blank = blankPicture(part);
    file.fill(blank, makeLayers(blank, command.aovs));
    return outcome;
}

PictureNotes errorNotes(const converge::Target& target, const Outcome& outcome) {
    PictureNotes notes;
    if (!outcome.converged) return notes;
    const nlohmann::json json = errorJson(target, *outcome.converged);
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

void printResult(const Outcome& outcome, const RenderCommand& command, const LoadedScene& loaded,
                 const Request& request, std::ostream& out) {
    if (command.output == "-") {
        out.flush();  // the image
    } else if (command.json) {
        printJson(statsJson(outcome, command, loaded, request), out);
    } else if (!command.quiet) {
        printSummary(outcome, command, loaded, out);
    }
}

}  // namespace glint::app
