// Reports omitted branches of the ray tree, for people and programs.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trace/picture.h"

namespace glint::app {

// {"cut": {"branches", "meanBound", "greatestBound"}, "maxDepth": ..., "waiting": ..., "crowdedMedia"}.
// Bounds are of a pixel's colour; null where none is known.
nlohmann::json lossesJson(const Picture& picture);

// A line for each kind of loss that may be seen, each after `start`: branches that were cut, that found no
// room, media without room; branches beyond maxDepth if a pixel may lack 1/255 by them.
void warnOfLosses(const Picture& picture, const std::string& start, std::ostream& err);

}  // namespace glint::app
