#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/write.h"

namespace glint::report {

namespace {

using Json = nlohmann::ordered_json;

// JSON and CSV are written, and JSON is read, through one list of the fields.
template <typename Visit, typename T>
void visitFields(Visit&& visit, T& m) requires std::is_same_v<std::remove_const_t<T>, ErrorMeasures> {
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

template <typename Visit, typename T>
void visitFields(Visit&& visit, T& a) requires std::is_same_v<std::remove_const_t<T>, ArithmeticError> {
    visit("all", a.all);
    visit("samePath", a.samePath);
    visit("otherPath", a.otherPath);
}

template <typename Visit, typename T>
void visitFields(Visit&& visit, T& m) requires std::is_same_v<std::remove_const_t<T>, Measured> {
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

template <typename Visit, typename T>
void visitFields(Visit&& visit, T& s) requires std::is_same_v<std::remove_const_t<T>, SceneReport> {
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

template <typename Visit, typename T>
void visitFields(Visit&& visit, T& d) requires std::is_same_v<std::remove_const_t<T>, Report> {
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

struct Writer {
    Json& json;
    template <typename T>
    void operator()(const char* name, const T& value) {
        json[name] = write(value);
    }
    template <typename T>
    static Json write(const T& value) {
        if constexpr (requires(Writer w) { visitFields(w, value); }) {
            Json object = Json::object();
            visitFields(Writer{object}, value);
            return object;
        } else {
            return value;
        }
    }
    template <typename T>
    static Json write(const std::vector<T>& values) {
        Json array = Json::array();
        for (const T& value : values) array.push_back(write(value));
        return array;
    }
    template <typename T>
    static Json write(const std::optional<T>& value) {
        return value ? write(*value) : Json(nullptr);
    }
};

struct Reader {
    const Json& json;
    template <typename T>
    void operator()(const char* name, T& value) {
        read(json.at(name), value);
    }
    template <typename T>
    static void read(const Json& json, T& value) {
        if constexpr (requires(Reader r) { visitFields(r, value); }) {
            visitFields(Reader{json}, value);
        } else {
            json.get_to(value);
        }
    }
    template <typename T>
    static void read(const Json& json, std::vector<T>& values) {
        values.clear();
        for (const Json& item : json) read(item, values.emplace_back());
    }
    template <typename T>
    static void read(const Json& json, std::optional<T>& value) {
        value.reset();
        if (!json.is_null()) read(json, value.emplace());
    }
};

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
    return Writer::write(data).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Report fromJson(const std::string& text, const std::string& name) {
    Report data;
    try {
        Reader::read(Json::parse(text), data);
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
    addCells(Writer::write(whole), "", columns);
    std::string text = "scene";
    for (const auto& [name, value] : columns) text += "," + name;
    text += "\r\n";
    for (const SceneReport& scene : data.scenes)
        for (const Measured& m : scene.measured) {
            std::vector<std::pair<std::string, std::string>> cells;
            addCells(Writer::write(m), "", cells);
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
