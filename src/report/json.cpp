// A report as JSON and CSV.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/format.h"
#include "report/write.h"

// Null for nothing.
template <typename T>
struct nlohmann::adl_serializer<std::optional<T>> {
    static void to_json(json& json, const std::optional<T>& value) {
        json = nullptr;
        if (value) json = *value;
    }
    static void from_json(const json& json, std::optional<T>& value) {
        value.reset();
        if (!json.is_null()) json.get_to(value.emplace());
    }
};

namespace glint::report {

using Json = nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ErrorMeasures, pixels, notFinite, rmse, relMse, max, percentVisible, bias)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ArithmeticError, all, samePath, otherPath)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Measured, key, family, sampler, spp, depth, minContribution, arithmetic,
                                   total, error, ssim, hidden, samples, asked, bound, seconds, rmse,
                                   deviceSeconds, compile, rays)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SceneReport, path, camera, name, hash, width, height, depth, kappa,
                                   stiffness, truthSamples, truthError, measured, leftOut)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Report, version, device, driver, api, cores, repeats, truthSamples,
                                   complete, scenes)

namespace {

std::string csvText(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

// The fields by their paths; of lists the median.
Json cellsOf(const Measured& m) {
    Json json = m;
    json["seconds"] = m.median();
    json["rmse"] = quartilesOf(m.rmse).median;
    json["deviceSeconds"] = quartilesOf(m.deviceSeconds).median;
    return json.flatten();
}

std::string cellText(const Json& cell) {
    if (cell.is_number()) return format("%.9g", cell.get<double>());
    if (cell.is_boolean()) return cell.get<bool>() ? "yes" : "no";
    return cell.is_string() ? csvText(cell.get<std::string>()) : "";
}

}  // namespace

std::string toJson(const Report& data) {
    // A file name need not be UTF-8; JSON must be.
    return Json(data).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Report fromJson(const std::string& text, const std::string& name) {
    try {
        return Json::parse(text).get<Report>();
    } catch (const Json::exception&) {
        throw Error(ErrorKind::Failed,
                    name + ": not a report of this version; give another folder, or remove it");
    }
}

std::string toCsv(const Report& data) {
    Measured whole;  // has every field
    whole.arithmetic.emplace();
    whole.ssim.emplace();
    const Json columns = cellsOf(whole);
    std::string text = "scene";
    for (const auto& [path, value] : columns.items()) {
        std::string name = path.substr(1);
        std::replace(name.begin(), name.end(), '/', '.');
        text += "," + name;
    }
    text += "\r\n";
    for (const SceneReport& scene : data.scenes)
        for (const Measured& m : scene.measured) {
            const Json cells = cellsOf(m);
            text += csvText(scene.name);
            for (const auto& [path, value] : columns.items())
                text += "," + cellText(cells.value(path, Json()));
            text += "\r\n";
        }
    return text;
}

}  // namespace glint::report
