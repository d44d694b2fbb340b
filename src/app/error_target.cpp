#include "app/error_target.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/error.h"
#include "core/wording.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "reference/tracer.h"
#include "scene/limits.h"
#include "verify/stiffness.h"

namespace glint::app {

namespace {

constexpr int kMostErrorSamples = 1 << 20;

std::string format(const char* form, double value) {
    char text[48];
    std::snprintf(text, sizeof(text), form, value);
    return text;
}

double confidenceOf(const std::string& text) {
    const double value = parseNotNegative(text);
    if (!(value > 0.5 && value < 1))
        throw Error(ErrorKind::Argument, "a confidence lies between 0.5 and 1, such as 0.95");
    return value;
}

// The condition number times the unit of the arithmetic, and what storing as fp32 takes.
double roundingOf(const LoadedScene& loaded, const Request& request, Backend backend) {
    const reference::Tracer tracer(loaded.packed, request);
    return verify::roundingError(tracer, cameraOf(loaded), request.width, request.height,
                                 backend == Backend::Cpu ? 0x1p-53 : verify::kFloatUnit);
}

// As short as it can be read back from: 0.999999999 is not 1.
std::string probability(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

const char* limitOf(converge::Stop stop) {
    switch (stop) {
        case converge::Stop::Samples:
            return "--max-spp";
        case converge::Stop::Seconds:
            return "--max-seconds";
        case converge::Stop::Fixed:
            return "more would not help: what is cut off or rounded comes to as much";
        case converge::Stop::Reached:
        case converge::Stop::Interrupted:
            break;
    }
    return "";
}

// A picture without any reflection has no code for them either, and so no account of what is missing.
void checkDepthIsKnown(const ErrorTarget& target, const LoadedScene& loaded) {
    const auto reflects = [](const Material& m) {
        return m.mirror != Color(0) || m.transmission != Color(0);
    };
    const auto& materials = loaded.scene.materials;
    if (target.withinDepth || loaded.scene.maxDepth > 0 ||
        std::none_of(materials.begin(), materials.end(), reflects))
        return;
    throw Error(
        ErrorKind::Argument,
        "--error: with maxDepth 0 nobody counts what mirrors would show; --max-depth 1 or more counts "
        "what lies beyond, --within-depth takes the depth as it is");
}

}  // namespace

void addError(OptionTable& table, ErrorTarget& target) {
    table.value("--error", "E",
                "take samples until the picture's error is at most E (linear radiance, full scale 1)",
                [&](const std::string& t) { target.error = parsePositive(t); });
    table.value("--confidence", "P",
                "probability with which --error is to hold, above 0.5 and below 1 (default 0.95)",
                [&](const std::string& t) { target.confidence = confidenceOf(t); });
    table.flag(
        "--within-depth",
        "the truth that --error means ends at the scene's depth; otherwise what may lie beyond is counted",
        target.withinDepth);
}

void addErrorTarget(OptionTable& table, ErrorTarget& target) {
    addError(table, target);
    table.choice<converge::Measure>(
        "--measure",
        "what --error is of: the root mean square over the picture (default), or each pixel by itself",
        target.measure);
    table.value("--max-seconds", "S", "stop there with the best picture so far, if --error takes longer",
                [&](const std::string& t) { target.maxSeconds = parsePositive(t); });
    table.whole("--max-spp", "N", "stop there, if --error takes more samples of a pixel (default 65536)", 2,
                kMostErrorSamples, target.maxSamples);
    table.flag("--strict", "exit with code 5 if --error is not reached", target.strict);
}

void checkErrorIsAsked(const ErrorTarget& target) {
    if (target.error) return;
    const char* idle = target.confidence    ? "--confidence"
                       : target.measure     ? "--measure"
                       : target.maxSeconds  ? "--max-seconds"
                       : target.maxSamples  ? "--max-spp"
                       : target.strict      ? "--strict"
                       : target.withinDepth ? "--within-depth"
                                            : nullptr;
    if (idle) throw Error(ErrorKind::Argument, std::string(idle) + ": says nothing without --error");
}

void checkErrorTarget(const ErrorTarget& target, const SceneOptions& scene, const std::vector<Aov>& aovs) {
    checkErrorIsAsked(target);
    if (!target.error) {
        if (std::find(aovs.begin(), aovs.end(), Aov::Error) != aovs.end())
            throw Error(ErrorKind::Argument, "--aov: the layer error is known with --error alone");
        return;
    }
    if (scene.spp)
        throw Error(ErrorKind::Argument,
                    "--spp: --error finds out how many samples it takes; limit them by --max-spp");
    if (scene.adaptive)
        throw Error(ErrorKind::Argument, "--adaptive: --error finds out how many samples it takes");
    if (scene.sampler == Sampler::Grid)
        throw Error(ErrorKind::Argument,
                    "--sampler: a grid tells nothing of its error; --error takes lowDiscrepancy or jittered");
    if (target.measure == converge::Measure::Pixel && scene.sampler)
        throw Error(ErrorKind::Argument, "--sampler: --measure pixel takes independent samples");
}

converge::Job jobOf(const ErrorTarget& target, const LoadedScene& loaded, Backend backend, Request& request,
                    Progress& progress) {
    checkDepthIsKnown(target, loaded);
    converge::Job job;
    job.image = loaded.scene.image;
    job.image.adaptive.reset();
    if (job.image.sampler == Sampler::Grid) job.image.sampler = Sampler::LowDiscrepancy;
    job.target.error = *target.error;
    job.target.confidence = target.confidence.value_or(job.target.confidence);
    job.target.measure = target.measure.value_or(job.target.measure);
    job.target.maxSeconds = target.maxSeconds.value_or(job.target.maxSeconds);
    if (target.maxSamples) job.target.maxSamples = static_cast<uint32_t>(*target.maxSamples);
    if (job.target.measure == converge::Measure::Pixel && job.image.filter == Filter::Mitchell)
        throw Error(
            ErrorKind::Argument,
            "--measure pixel: samples of the mitchell filter have no bound of their own; take another "
            "filter, or --measure rmse");
    if (job.target.measure == converge::Measure::Rmse &&
        regionOf(request).width() * regionOf(request).height() == 1)
        throw Error(ErrorKind::Argument,
                    "--error: the root mean square of one pixel's error has no bound; --measure pixel is for "
                    "single pixels");
    job.target.depthCounts = !target.withinDepth;
    job.radianceBound =
        radianceBound(loaded.packed, environmentOf(loaded.packed, request), lightsOf(loaded.packed, request));
    job.maxDepth = loaded.packed.environment.maxDepth;
    job.rounding = roundingOf(loaded, request, backend);
    job.inDouble = backend == Backend::Cpu;
    // Batches are many, and each would count from 0 to 1.
    request.progress = {};
    request.ledger = true;
    request.samples = SampleSequence(job.image).next(leastSamples(job.image.filter));
    job.request = request;
    const double wanted = *target.error;
    job.report = [&progress, wanted, last = 0.0](const converge::State& state) mutable {
        // Work grows with about the error's -5/3rd power. The bound is far from the error at first.
        const double error = state.estimate > 0 ? state.estimate : state.budget.sampling;
        const double left = std::max(error / wanted, 1.0);
        last = std::max(last, std::min(std::pow(left, -5.0 / 3), 0.99));
        progress.update(last);
    };
    return job;
}

nlohmann::json errorJson(const ErrorTarget& target, const converge::Result& result) {
    const converge::Target defaults;
    const auto number = [](double value) {
        return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
    };
    const converge::ErrorBudget& budget = result.budget;
    const bool pixels = target.measure == converge::Measure::Pixel;
    return {{"asked", *target.error},
            {"measure", nameOf(target.measure.value_or(defaults.measure))},
            {"confidence", target.confidence.value_or(defaults.confidence)},
            {"reached", result.reached()},
            {"stopped", nameOf(result.stop)},
            {"bound", number(budget.total())},
            {"sampling", number(budget.sampling)},
            {"estimate", pixels ? nlohmann::json(nullptr) : number(result.estimate)},
            {"rounding", number(budget.rounding)},
            {"cut", number(budget.cut)},
            {"maxDepth", number(budget.depth)},
            {"maxDepthCounts", budget.depthCounts},
            {"unseen", pixels ? nlohmann::json(nullptr) : number(result.unseen)},
            {"unsettledPixels", result.unsettled},
            {"samplesPerPixel", result.samplesPerPixel},
            {"rounds", result.rounds}};
}

PictureNotes errorNotes(const ErrorTarget& target, const converge::Result& result) {
    const nlohmann::json json = errorJson(target, result);
    PictureNotes notes;
    for (const auto& [key, value] : json.items()) {
        const std::string name = "glint.error." + key;
        if (value.is_string())
            notes.emplace_back(name, value.get<std::string>());
        else if (value.is_boolean())
            notes.emplace_back(name, value.get<bool>() ? 1.0 : 0.0);
        else if (value.is_number())
            notes.emplace_back(name, value.get<double>());
    }
    return notes;
}

std::string errorSummary(const ErrorTarget& target, const converge::Result& result) {
    const converge::Target defaults;
    const converge::ErrorBudget& budget = result.budget;
    const bool pixels = target.measure == converge::Measure::Pixel;
    std::string text = pixels ? "error of each pixel: " : "error (rmse): ";
    text += "at most " + format("%.3g", budget.total()) + " with confidence " +
            probability(target.confidence.value_or(defaults.confidence)) + "; sampling " +
            format("%.2g", budget.sampling) +
            (pixels ? "" : " (about " + format("%.2g", result.estimate) + ")") + ", rounding " +
            format("%.1g", budget.rounding) + ", cut " + format("%.1g", budget.cut) + ", maxDepth " +
            format("%.1g", budget.depth) + (budget.depthCounts ? "; " : " (not counted); ");
    if (pixels)
        text += counted(result.samplesPerPixel, "sample") + " at most for a pixel, ";
    else
        text += counted(result.leastSamples, "sample") + " for a pixel, ";
    if (!pixels && result.samplesPerPixel > result.leastSamples)
        text += std::to_string(result.samplesPerPixel) + " where few pixels have most of the error, ";
    text += counted(result.rounds, "round");
    // Full scale is allowed for in the bound; what is brighter is told apart.
    if (!pixels && std::isfinite(result.unseen) && result.unseen > budget.total())
        text +=
            "\nnot counted: a highlight as bright as the scene can have that all samples missed might add " +
            format("%.2g", result.unseen);
    return text;
}

void warnAboutError(const ErrorTarget& target, const converge::Result& result, const std::string& start,
                    std::ostream& err) {
    if (result.reached() || result.stop == converge::Stop::Interrupted) return;
    // Of few pixels, two replicates tell too little to bound anything.
    const bool bounded = std::isfinite(result.budget.total());
    err << start
        << (bounded ? "the error may be " + format("%.3g", result.budget.total()) : "the error has no bound")
        << ", not " << format("%.3g", *target.error) << ", after "
        << counted(result.samplesPerPixel, "sample") << " for a pixel (" << limitOf(result.stop) << ")";
    if (!bounded) err << "; too few pixels show any error to tell; --measure pixel is for few pixels";
    if (target.measure == converge::Measure::Pixel)
        err << "; " << format("%.3g", 100 * result.unsettled) << " % of the pixels are not settled";
    err << '\n';
}

}  // namespace glint::app
