// `glint render --error`: its options, and the job for it.
#pragma once

#include <optional>
#include <string>

#include "app/options.h"
#include "converge/converge.h"
#include "core/progress.h"
#include "pack/loaded_scene.h"
#include "trace/request.h"

namespace glint::app {

struct ErrorTarget {
    std::optional<double> error;
    std::optional<double> confidence, maxSeconds;
    std::optional<int> maxSamples;
    bool strict = false;
    bool withinDepth = false;
};

// --error, --confidence, --within-depth; the last two require the first.
void addError(OptionTable& table, ErrorTarget& target);
// The same, and the limits.
void addErrorTarget(OptionTable& table, ErrorTarget& target);

// The job for the scene's image; `request` becomes like those of its batches. `backend`: for the rounding
// error. `progress` must outlive the job.
converge::Job jobOf(const ErrorTarget& target, const LoadedScene& loaded, Backend backend, Request& request,
                    Progress& progress);

}  // namespace glint::app
