// The words of `glint verify`.
#pragma once

#include <glm/glm.hpp>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "verify/verify.h"

namespace glint::app {

// The verdict on a scene, the numbers behind it, and the worst pixels with what device and reference have
// seen there. `origin`: PackedScene::origin.
void printReport(const std::string& scene, const verify::Report& report, const verify::Options& options,
                 const glm::dvec3& origin, std::ostream& out);

// In one line: "ok", or "FAILED: " and why.
std::string verdict(const verify::Report& report);

// The same verdict and numbers, and the differing pixels that the report keeps.
nlohmann::json reportJson(const std::string& scene, const verify::Report& report);

// The figures of one line, of what reportJson gives.
std::string briefFigures(const nlohmann::json& report);

}  // namespace glint::app
