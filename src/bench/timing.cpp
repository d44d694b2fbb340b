#include "bench/timing.h"

#include <sys/resource.h>

#include "core/stopwatch.h"

namespace glint::bench {

namespace {

// Seconds that all threads of the process have run so far.
double processorSeconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

render::StageTimes difference(render::StageTimes after, const render::StageTimes& before) {
    after.compile -= before.compile;
    after.trace -= before.trace;
    after.device -= before.device;
    after.readback -= before.readback;
    after.submissions -= before.submissions;
    after.slices -= before.slices;
    after.resumes -= before.resumes;
    after.pathRays -= before.pathRays;
    after.invocations -= before.invocations;
    render::KernelTimes& a = after.kernels;
    const render::KernelTimes& b = before.kernels;
    a.generate -= b.generate;
    a.primary -= b.primary;
    a.shadow -= b.shadow;
    a.secondary -= b.secondary;
    a.shade -= b.shade;
    a.adapt -= b.adapt;
    a.whole -= b.whole;
    a.mirrored -= b.mirrored;
    a.refracted -= b.refracted;
    return after;
}

}  // namespace

Timing timeImage(const render::Renderer* renderer, const std::function<Picture()>& draw, Picture& picture) {
    const render::StageTimes before = renderer ? renderer->times() : render::StageTimes();
    const double processors = processorSeconds();
    const Stopwatch watch;
    picture = draw();
    Timing timing;
    timing.wall = watch.seconds();
    timing.processors = processorSeconds() - processors;
    if (renderer) timing.stages = difference(renderer->times(), before);
    timing.wall -= timing.stages.compile;
    return timing;
}

}  // namespace glint::bench
