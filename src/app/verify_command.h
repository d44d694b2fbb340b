// Results of `glint verify`: text for people, JSON and JUnit files for programs, images of scenes that fail.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "verify/verify.h"

namespace glint::app {

// The verdict on a scene, its figures, and the worst pixels with the answers of device and reference;
// `manySamples`: and their samples.
void printReport(const std::string& scene, const verify::Report& report, bool manySamples, std::ostream& out);

// The same verdict and numbers, and the differing pixels that the report keeps.
nlohmann::json reportJson(const verify::Report& report);

// Version of the JSON file's layout (docs/guide/verify.md). A change that breaks readers increments it.
inline constexpr int kVerifyJsonVersion = 2;

enum class SceneStatus { Passed, Failed, Error, Skipped };
constexpr auto entriesOf(SceneStatus) {
    return std::to_array<EnumEntry<SceneStatus>>({{SceneStatus::Passed, "passed"},
                                                  {SceneStatus::Failed, "failed"},
                                                  {SceneStatus::Error, "error"},
                                                  {SceneStatus::Skipped, "skipped"}});
}

struct SceneResult {
    std::string scene;
    SceneStatus status = SceneStatus::Passed;
    std::string message;        // the verdict, the error, or why the scene was skipped
    std::string brief = {};     // the figures for --brief
    std::string details = {};   // the text report; empty without one
    nlohmann::json facts = {};  // figures and differing pixels; null without a report
    double seconds = 0;
};

std::string jsonText(const std::vector<SceneResult>& results, const std::string& device,
                     const std::string& driver);
std::string junitText(const std::vector<SceneResult>& results);

}  // namespace glint::app
