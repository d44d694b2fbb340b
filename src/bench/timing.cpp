#include "bench/timing.h"

#include "core/stopwatch.h"

namespace glint::bench {

namespace {

render::StageTimes difference(render::StageTimes after, const render::StageTimes& before) {
    using render::KernelTimes;
    using render::StageTimes;
    for (double StageTimes::*time :
         {&StageTimes::compile, &StageTimes::trace, &StageTimes::device, &StageTimes::readback})
        after.*time -= before.*time;
    for (uint64_t StageTimes::*count : {&StageTimes::submissions, &StageTimes::slices, &StageTimes::resumes,
                                        &StageTimes::pathRays, &StageTimes::invocations})
        after.*count -= before.*count;
    for (double KernelTimes::*time : {&KernelTimes::generate, &KernelTimes::primary, &KernelTimes::shadow,
                                      &KernelTimes::secondary, &KernelTimes::shade, &KernelTimes::adapt,
                                      &KernelTimes::whole, &KernelTimes::mirrored, &KernelTimes::refracted})
        after.kernels.*time -= before.kernels.*time;
    return after;
}

}  // namespace

Timing timeImage(const render::Renderer* renderer, const std::function<Picture()>& draw, Picture& picture) {
    const render::StageTimes before = renderer ? renderer->times() : render::StageTimes();
    const ProcessorWatch processors;
    const Stopwatch watch;
    picture = draw();
    Timing timing;
    timing.wall = watch.seconds();
    timing.processors = processors.seconds();
    if (renderer) timing.stages = difference(renderer->times(), before);
    timing.wall -= timing.stages.compile;
    return timing;
}

}  // namespace glint::bench
