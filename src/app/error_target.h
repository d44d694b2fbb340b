// `glint render --error`: its options, and the words about what was reached.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/option_groups.h"
#include "converge/converge.h"
#include "core/image.h"
#include "core/progress.h"
#include "pack/loaded_scene.h"
#include "trace/request.h"

namespace glint::app {

struct ErrorTarget {
    std::optional<double> error;
    std::optional<double> confidence, maxSeconds;
    std::optional<int> maxSamples;
    std::optional<converge::Measure> measure;
    bool strict = false;
    bool withinDepth = false;
};

// The error, its confidence and what it counts.
void addError(OptionTable& table, ErrorTarget& target);
// And when to end without it.
void addErrorTarget(OptionTable& table, ErrorTarget& target);

// Throws Error(Argument) for options that say nothing without --error.
void checkErrorIsAsked(const ErrorTarget& target);
// And for those that say something else than it.
void checkErrorTarget(const ErrorTarget& target, const SceneOptions& scene, const std::vector<Aov>& aovs);

// What the scene's picture takes; `request` becomes one that such a picture's batches are like. `backend` is
// who computes, for the rounding. `progress` must outlive the job.
converge::Job jobOf(const ErrorTarget& target, const LoadedScene& loaded, Backend backend, Request& request,
                    Progress& progress);

nlohmann::json errorJson(const ErrorTarget& target, const converge::Result& result);
// The same for a picture's file: glint.error.asked and so on; true is 1, what is not finite is left out.
PictureNotes errorNotes(const ErrorTarget& target, const converge::Result& result);
std::string errorSummary(const ErrorTarget& target, const converge::Result& result);
// Says on `err` that the target was not reached, and why; nothing if it was.
void warnAboutError(const ErrorTarget& target, const converge::Result& result, const std::string& start,
                    std::ostream& err);

}  // namespace glint::app
