// What the pictures of a scene are judged by, and what drawing takes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "converge/bounds.h"
#include "core/stopwatch.h"
#include "report/sweep.h"
#include "scene/sampling.h"
#include "verify/stiffness.h"

namespace glint::report {

namespace {

// Seeds that no turn comes to: a picture must not be close to the truth because it shares its samples.
constexpr uint32_t kTruthSeed = 0x40000000;
constexpr int kLeastTruthSamples = 64, kMostTruthSamples = 4096;
// Compiling a kind of pipeline.
constexpr double kCompileSeconds = 0.3;

Configuration plain(int spp, Sampler sampler = Sampler::LowDiscrepancy) {
    Configuration c;
    c.sampler = sampler;
    c.spp = spp;
    return c;
}

Configuration drawnBy(Backend backend) {
    Configuration c;
    c.onReference = backend == Backend::Cpu;
    return c;
}

}  // namespace

const SceneSweep::Truth* SceneSweep::truthOf(const Configuration& c) {
    const auto key = std::make_tuple(c.sampler, c.spp);
    if (const auto found = truths_.find(key); found != truths_.end()) return &found->second;
    Request request = requestFor(plain(c.spp, c.sampler), loaded_.scene.image.seed);
    request.data = request.exact = true;
    const Picture picture = reference::render(loaded_.packed, camera_, request);
    if (!picture.complete) return nullptr;
    Truth truth;
    truth.colors.reserve(picture.done.size());
    truth.paths.reserve(picture.done.size());
    for (size_t i = 0; i < picture.done.size(); ++i) {
        truth.colors.emplace_back(picture.exact[i]);
        truth.paths.push_back(picture.data[i].pathHash);
    }
    return &truths_.emplace(key, std::move(truth)).first->second;
}

double SceneSweep::secondsOf(const Configuration& c) {
    const std::string who = c.onReference ? "the reference" : c.on;
    if (const auto known = seconds_.find(who); known != seconds_.end()) return known->second;
    const Request request = requestFor(plain(1), loaded_.scene.image.seed);
    Configuration drawn;
    drawn.on = c.on;
    render::Renderer* renderer = c.onReference ? nullptr : &rendererOf(drawn);
    if (renderer) renderer->render(camera_, request);  // compiles
    const Stopwatch watch;
    if (renderer)
        renderer->render(camera_, request);
    else
        reference::render(loaded_.packed, camera_, request);
    return seconds_[who] = watch.seconds();
}

int SceneSweep::truthSamples(const SceneReport& report) {
    int samples = report.truthSamples > 0 ? report.truthSamples : limits_.truthSamples;
    if (samples == 0) {
        const double allowed = limits_.truthSeconds / secondsOf(drawnBy(limits_.truth));
        samples = kLeastTruthSamples;
        while (2 * samples <= allowed && samples < kMostTruthSamples) samples *= 2;
    }
    return std::max(2, samples / 2 * 2);
}

Picture SceneSweep::drawHalfOfTruth(int samples, uint32_t seed) {
    Request request = requestFor(plain(samples / 2), seed);
    // Progress counts work done since the last call.
    request.progress = [this, last = 0.0](double done) mutable {
        limits_.worked((done - last) / 2 * kTruthWork);
        last = done;
    };
    request.exact = limits_.truth == Backend::Cpu;
    return limits_.truth == Backend::Cpu ? reference::render(loaded_.packed, camera_, request)
                                         : rendererOf({}).render(camera_, request);
}

// Two halves of different seeds: their mean is the picture, and their difference tells its error
// (converge/bounds.h).
bool SceneSweep::drawTruth(SceneReport& report) {
    if (report.stiffness.empty()) {
        report.kappa = verify::conditionNumber(reference::Tracer(loaded_.packed), camera_,
                                               loaded_.scene.image.width, loaded_.scene.image.height);
        report.stiffness = nameOf(verify::classOf(report.kappa));
    }
    kappa_ = report.kappa;
    if (!converged_.empty()) return true;
    const int samples = truthSamples(report);
    std::vector<glm::dvec3> halves[2];
    for (uint32_t half = 0; half < 2; ++half) {
        const uint32_t seed = loaded_.scene.image.seed + kTruthSeed + half;
        const Picture picture = drawHalfOfTruth(samples, seed);
        if (!picture.complete) return false;
        halves[half].reserve(picture.done.size());
        for (size_t i = 0; i < picture.done.size(); ++i) {
            const float* p = &picture.color.pixels[i * 4];
            halves[half].push_back(picture.exact.empty() ? glm::dvec3(p[0], p[1], p[2])
                                                         : glm::dvec3(picture.exact[i]));
        }
    }
    converged_.reserve(halves[0].size());
    for (size_t i = 0; i < halves[0].size(); ++i) converged_.push_back((halves[0][i] + halves[1][i]) / 2.0);
    convergedImage_ = Image(loaded_.scene.image.width, loaded_.scene.image.height, 3);
    for (size_t i = 0; i < converged_.size(); ++i)
        for (int c = 0; c < 3; ++c)
            convergedImage_.pixels[3 * i + static_cast<size_t>(c)] = static_cast<float>(converged_[i][c]);
    report.truthSamples = samples;
    report.truthError = std::sqrt(converge::meanSquareOf(halves[0], halves[1]).value);
    return true;
}

// By the last measurement of the default sampler, whose error falls with about the power -0.6.
double SceneSweep::predictedSamples(const Configuration& c, const SceneReport& report) const {
    if (c.contrast) return 32;
    if (!c.error) return c.spp;
    for (auto m = report.measured.rbegin(); m != report.measured.rend(); ++m)
        if (m->family == nameOf(Sampler::LowDiscrepancy))
            return std::clamp(2 * m->spp * std::pow(m->error / *c.error, 1 / 0.6), 2.0, kMostErrorSamples);
    return 64;
}

bool SceneSweep::fits(const Batch& batch, const SceneReport& report) {
    const double left = limits_.secondsLeft();
    if (left == std::numeric_limits<double>::infinity()) return true;
    if (left <= 0) return false;
    double seconds = 0;
    for (const Configuration& c : batch.configurations) {
        const double runs = limits_.repeats + 1.0 + (c.spp <= 4 ? 1 : 0);
        seconds += predictedSamples(c, report) * runs * secondsOf(c) + kCompileSeconds;
    }
    if (converged_.empty()) seconds += truthSamples(report) * secondsOf(drawnBy(limits_.truth));
    return seconds <= limits_.secondsLeft();
}

}  // namespace glint::report
