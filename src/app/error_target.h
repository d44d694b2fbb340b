// `glint render --error`: its options and its results.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/options.h"
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
    bool strict = false;
    bool withinDepth = false;
};

// --error, --confidence, --within-depth.
void addError(OptionTable& table, ErrorTarget& target);
// The same, and the limits.
void addErrorTarget(OptionTable& table, ErrorTarget& target);

// Throws Error(Argument) for options that require --error.
void checkErrorIsAsked(const ErrorTarget& target);
// The same, and for options that contradict --error.
void checkErrorTarget(const ErrorTarget& target, const SceneOptions& scene, const std::vector<Aov>& aovs);

// The job for the scene's image; `request` becomes like those of its batches. `backend`: for the rounding
// error. `progress` must outlive the job.
converge::Job jobOf(const ErrorTarget& target, const LoadedScene& loaded, Backend backend, Request& request,
                    Progress& progress);

// For --stats json: numbers that are not finite are null.
nlohmann::json errorJson(const ErrorTarget& target, const converge::Result& result);
// The same for an image's file: glint.error.asked and so on; true is 1, null is left out.
PictureNotes errorNotes(const ErrorTarget& target, const converge::Result& result);
std::string errorSummary(const ErrorTarget& target, const converge::Result& result);
// Prints a warning with the reason if the target was not reached.
void warnAboutError(const ErrorTarget& target, const converge::Result& result, const std::string& start,
                    std::ostream& err);

}  // namespace glint::app
