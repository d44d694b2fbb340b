// Results of `glint verify`: text for people, JSON and JUnit files for programs, images of scenes that fail.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "verify/verify.h"

namespace glint::app {

// The verdict on a scene, the numbers behind it, and the worst pixels with what device and reference have
// seen there. `origin`: PackedScene::origin.
void printReport(const std::string& scene, const verify::Report& report, const verify::Options& options,
                 const glm::dvec3& origin, std::ostream& out);

// In one line: "ok", or "FAILED: " and why.
std::string verdict(const verify::Report& report);

// The same verdict and numbers, and the differing pixels that the report keeps.
nlohmann::json reportJson(const verify::Report& report);

// The figures for --brief.
std::string briefFigures(const verify::Report& report);

// Version of the JSON file's layout (docs/guide/verify.md). A change that breaks readers increments it.
inline constexpr int kVerifyJsonVersion = 2;
// The JSON file lists at most this many differing pixels of a scene, the worst first.
inline constexpr size_t kListedPixels = 1000;

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

size_t countOf(const std::vector<SceneResult>& results, SceneStatus status);
double secondsOf(const std::vector<SceneResult>& results);

std::string jsonText(const std::vector<SceneResult>& results, const std::string& device,
                     const std::string& driver);
std::string junitText(const std::vector<SceneResult>& results);

// STEM.device.png, STEM.reference.png and STEM.difference.png of the first sample.
void writeArtifacts(const std::filesystem::path& folder, const std::string& stem,
                    const verify::Report& report);

}  // namespace glint::app
