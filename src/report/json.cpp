#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "core/error.h"
#include "report/write.h"

// Null for nothing.
template <typename T>
struct nlohmann::adl_serializer<std::optional<T>> {
    template <typename Json>
    static void to_json(Json& json, const std::optional<T>& value) {
        if (value)
            json = *value;
        else
            json = nullptr;
    }
    template <typename Json>
    static void from_json(const Json& json, std::optional<T>& value) {
        value.reset();
        if (!json.is_null()) json.get_to(value.emplace());
    }
};

namespace glint::report {

using Json = nlohmann::ordered_json;

// T is U or const U.
template <typename T, typename U>
concept Is = std::is_same_v<std::remove_const_t<T>, U>;

// JSON and CSV are written, and JSON is read, through one list of the fields.
void visitFields(auto&& visit, Is<ErrorMeasures> auto& m) {
    visit("pixels", m.pixels);
    visit("notFinite", m.notFinite);
    visit("rmse", m.rmse);
    visit("rmseStandardError", m.rmseError);
    visit("relMse", m.relMse);
    visit("max", m.max);
    visit("p99", m.p99);
    visit("percentAbove1/255", m.percentVisible);
    visit("percentAbove1e-3", m.percentSmall);
    visit("bias", m.bias);
}

void visitFields(auto&& visit, Is<ArithmeticError> auto& a) {
    visit("all", a.all);
    visit("samePath", a.samePath);
    visit("otherPath", a.otherPath);
}

void visitFields(auto&& visit, Is<Measured> auto& m) {
    visit("key", m.key);
    visit("family", m.family);
    visit("sampler", m.sampler);
    visit("spp", m.spp);
    visit("depth", m.depth);
    visit("minContribution", m.minContribution);
    visit("arithmetic", m.arithmetic);
    visit("total", m.total);
    visit("error", m.error);
    visit("ssim", m.ssim);
    visit("hidden", m.hidden);
    visit("samples", m.samples);
    visit("asked", m.asked);
    visit("bound", m.bound);
    visit("runSeconds", m.seconds);
    visit("runRmse", m.rmse);
    visit("runDeviceSeconds", m.deviceSeconds);
    visit("compileSeconds", m.compile);
    visit("uploadSeconds", m.upload);
    visit("readbackSeconds", m.readback);
    visit("rays", m.rays);
}

void visitFields(auto&& visit, Is<SceneReport> auto& s) {
    visit("path", s.path);
    visit("camera", s.camera);
    visit("name", s.name);
    visit("hash", s.hash);
    visit("width", s.width);
    visit("height", s.height);
    visit("maxDepth", s.depth);
    visit("kappa", s.kappa);
    visit("stiffness", s.stiffness);
    visit("contents", s.contents);
    visit("truthSamples", s.truthSamples);
    visit("truthError", s.truthError);
    visit("thumbnail", s.thumbnail);
    visit("settings", s.measured);
    visit("leftOut", s.leftOut);
}

void visitFields(auto&& visit, Is<Report> auto& d) {
    visit("glint", d.version);
    visit("device", d.device);
    visit("driver", d.driver);
    visit("api", d.api);
    visit("cores", d.cores);
    visit("repeats", d.repeats);
    visit("truthSamples", d.truthSamples);
    visit("truthBackend", d.truthBackend);
    visit("complete", d.complete);
    visit("scenes", d.scenes);
}

template <typename T>
concept HasFields = requires(T& value) {
    visitFields([](const char*, auto&) {}, value);
};

void to_json(Json& json, const HasFields auto& value) {
    json = Json::object();
    visitFields([&](const char* name, const auto& field) { json[name] = field; }, value);
}
void from_json(const Json& json, HasFields auto& value) {
    visitFields([&](const char* name, auto& field) { json.at(name).get_to(field); }, value);
}

namespace {

std::string csvText(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

// A cell for each number or text of an object, by its path; lists become their median.
void addCells(const Json& json, const std::string& name,
              std::vector<std::pair<std::string, std::string>>& cells) {
    if (json.is_object()) {
        for (const auto& [key, value] : json.items())
            addCells(value, name.empty() ? key : name + "." + key, cells);
    } else if (json.is_array()) {
        addCells(quartilesOf(json.get<std::vector<double>>()).median, name, cells);
    } else if (json.is_number()) {
        char text[32];
        std::snprintf(text, sizeof(text), "%.9g", json.get<double>());
        cells.emplace_back(name, text);
    } else if (json.is_boolean()) {
        cells.emplace_back(name, json.get<bool>() ? "yes" : "no");
    } else if (json.is_string()) {
        cells.emplace_back(name, csvText(json.get<std::string>()));
    }
}

}  // namespace

std::string toJson(const Report& data) {
    // A file name need not be UTF-8; JSON must be.
    return Json(data).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Report fromJson(const std::string& text, const std::string& name) {
    Report data;
    try {
        Json::parse(text).get_to(data);
    } catch (const Json::exception&) {
        throw Error(ErrorKind::Failed,
                    name + ": not a report of this version; give another folder, or remove it");
    }
    return data;
}

std::string toCsv(const Report& data) {
    Measured whole;  // has every field
    whole.arithmetic.emplace();
    whole.ssim.emplace();
    std::vector<std::pair<std::string, std::string>> columns;
    addCells(Json(whole), "", columns);
    std::string text = "scene";
    for (const auto& [name, value] : columns) text += "," + name;
    text += "\r\n";
    for (const SceneReport& scene : data.scenes)
        for (const Measured& m : scene.measured) {
            std::vector<std::pair<std::string, std::string>> cells;
            addCells(Json(m), "", cells);
            text += csvText(scene.name);
            auto cell = cells.begin();
            for (const auto& [name, value] : columns) {
                const bool there = cell != cells.end() && cell->first == name;
                text += "," + (there ? cell->second : "");
                if (there) ++cell;
            }
            text += "\r\n";
        }
    return text;
}

}  // namespace glint::report
