// Results of `glint verify` for other programs: JSON and JUnit files, and images of scenes that failed.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "verify/verify.h"

namespace glint::app {

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
    std::string details = {};   // the text report; empty without one
    nlohmann::json facts = {};  // figures and differing pixels; null without a report
    double seconds = 0;
};

// The files that the command line asked for, rewritten after each scene so that an interrupted run keeps the
// results so far. Empty paths and "-" write nothing.
class VerifyFiles {
  public:
    VerifyFiles(std::filesystem::path json, std::filesystem::path junit, std::string device,
                std::string driver);
    void add(SceneResult result);
    std::string json() const;
    size_t count(SceneStatus status) const;
    double seconds() const;

  private:
    std::filesystem::path json_, junit_;
    std::string device_, driver_;
    std::vector<SceneResult> results_;
};

std::string jsonText(const std::vector<SceneResult>& results, const std::string& device,
                     const std::string& driver);
std::string junitText(const std::vector<SceneResult>& results);

// STEM.device.png, STEM.reference.png and STEM.difference.png of the first sample.
void writeArtifacts(const std::filesystem::path& folder, const std::string& stem,
                    const verify::Report& report);

}  // namespace glint::app
