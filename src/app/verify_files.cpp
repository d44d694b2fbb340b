#include "app/verify_files.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "app/common.h"
#include "app/version.h"
#include "core/file_io.h"
#include "core/image_io.h"
#include "core/text_file.h"
#include "report/write.h"

namespace glint::app {

namespace {

size_t countOf(const std::vector<SceneResult>& results, SceneStatus status) {
    return static_cast<size_t>(
        std::count_if(results.begin(), results.end(), [&](const auto& r) { return r.status == status; }));
}

double secondsOf(const std::vector<SceneResult>& results) {
    double sum = 0;
    for (const SceneResult& result : results) sum += result.seconds;
    return sum;
}

void addTestCase(const SceneResult& result, std::string& out) {
    out += "  <testcase classname=\"glint.verify\" name=\"" + report::escapeMarkup(printable(result.scene)) +
           "\" time=\"" + format("%.3f", result.seconds) + "\">";
    if (result.status != SceneStatus::Passed) {
        const std::string element =
            result.status == SceneStatus::Failed ? "failure" : std::string(nameOf(result.status));
        out += "\n    <" + element + " message=\"" + report::escapeMarkup(printable(result.message)) + "\">" +
               report::escapeMarkup(result.details) + "</" + element + ">\n  ";
    }
    out += "</testcase>\n";
}

}  // namespace

std::string jsonText(const std::vector<SceneResult>& results, const std::string& device,
                     const std::string& driver) {
    nlohmann::json scenes = nlohmann::json::array();
    for (const SceneResult& result : results) {
        nlohmann::json one = result.facts.is_object() ? result.facts : nlohmann::json::object();
        one["scene"] = result.scene;
        one["status"] = std::string(nameOf(result.status));
        one["verdict"] = result.message;
        one["seconds"] = result.seconds;
        scenes.push_back(std::move(one));
    }
    nlohmann::json summary;
    for (const SceneStatus status :
         {SceneStatus::Passed, SceneStatus::Failed, SceneStatus::Error, SceneStatus::Skipped})
        summary[std::string(nameOf(status))] = countOf(results, status);
    const nlohmann::json file = {{"format", "glint.verify"},   {"version", kVerifyJsonVersion},
                                 {"glint", GLINT_VERSION},     {"device", device},
                                 {"driver", driver},           {"summary", std::move(summary)},
                                 {"scenes", std::move(scenes)}};
    std::ostringstream text;
    printJson(file, text);
    return text.str();
}

std::string junitText(const std::vector<SceneResult>& results) {
    const auto attribute = [&](const char* name, SceneStatus status) {
        return std::string(" ") + name + "=\"" + std::to_string(countOf(results, status)) + '"';
    };
    std::string out =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"glint verify\" tests=\"" +
        std::to_string(results.size()) + '"' + attribute("failures", SceneStatus::Failed) +
        attribute("errors", SceneStatus::Error) + attribute("skipped", SceneStatus::Skipped) + " time=\"" +
        format("%.3f", secondsOf(results)) + "\">\n";
    for (const SceneResult& result : results) addTestCase(result, out);
    return out + "</testsuite>\n";
}

VerifyFiles::VerifyFiles(std::filesystem::path json, std::filesystem::path junit, std::string device,
                         std::string driver)
    : json_(std::move(json)),
      junit_(std::move(junit)),
      device_(std::move(device)),
      driver_(std::move(driver)) {}

void VerifyFiles::add(SceneResult result) {
    results_.push_back(std::move(result));
    if (!json_.empty() && json_ != "-") writeTextFile(json_, json());
    if (!junit_.empty()) writeTextFile(junit_, junitText(results_));
}

std::string VerifyFiles::json() const {
    return jsonText(results_, device_, driver_);
}

size_t VerifyFiles::count(SceneStatus status) const {
    return countOf(results_, status);
}

double VerifyFiles::seconds() const {
    return secondsOf(results_);
}

void writeArtifacts(const std::filesystem::path& folder, const std::string& stem,
                    const verify::Report& report) {
    writeImage(folder / (stem + ".device.png"), report.device);
    writeImage(folder / (stem + ".reference.png"), report.reference);
    writeImage(folder / (stem + ".difference.png"), report.difference);
}

}  // namespace glint::app
