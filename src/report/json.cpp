#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/front.h"
#include "report/write.h"

namespace glint::report {

namespace {

using Json = nlohmann::ordered_json;

// Every field is written and read through one list, so that neither forgets any.
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
void visitFields(Visit&& visit, T& q) requires std::is_same_v<std::remove_const_t<T>, Quartiles> {
    visit("q1", q.low);
    visit("median", q.median);
    visit("q3", q.high);
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
    visit("batch", m.batch);
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
    visit("wallSeconds", m.wall);
    visit("deviceSeconds", m.device);
    visit("compileSeconds", m.compile);
    visit("uploadSeconds", m.upload);
    visit("readbackSeconds", m.readback);
    visit("rays", m.rays);
    visit("repeats", m.repeats);
    visit("default", m.isDefault);
    visit("beatenBy", m.beatenBy);
}

template <typename Visit, typename T>
void visitFields(Visit&& visit, T& s) requires std::is_same_v<std::remove_const_t<T>, SceneReport> {
    visit("path", s.path);
    visit("camera", s.camera);
    visit("name", s.name);
    visit("hash", s.hash);
    visit("width", s.width);
    visit("height", s.height);
    visit("maxDepth", s.maxDepth);
    visit("kappa", s.kappa);
    visit("stiffness", s.stiffness);
    visit("contents", s.contents);
    visit("sampler", s.defaultSampler);
    visit("truthSamples", s.truthSamples);
    visit("truthError", s.truthError);
    visit("configurations", s.measured);
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
        if (std::string_view(name) == "camera" && !json.contains(name)) return;  // reports had none at first
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

std::string csvNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), ",%.9g", value);
    return text;
}

std::string csvErrors(const ErrorMeasures& m) {
    std::string line;
    for (const double value :
         {m.rmse, m.relMse, m.max, m.p99, m.percentVisible, m.percentSmall, m.bias, m.rmseError})
        line += csvNumber(value);
    return line;
}

std::string csvHeader() {
    std::string line =
        "scene,key,batch,family,sampler,spp,depth,minContribution,samples,asked,error,ssim,hidden,bound";
    for (const char* kind : {"total", "arithmetic", "samePath", "otherPath"}) {
        for (const char* measure : {"Rmse", "RelMse", "Max", "P99", "PercentAbove255th", "PercentAbove1000th",
                                    "Bias", "RmseStandardError"}) {
            line += std::string(",") + kind + measure;
        }
    }
    return line +
           ",samePathPixels,otherPathPixels,wallQ1,wallMedian,wallQ3,deviceQ1,deviceMedian,deviceQ3,compile,"
           "upload,readback,rays,repeats,default,onFront,beatenBy\r\n";
}

std::string csvLine(const SceneReport& scene, const Measured& m) {
    std::string line;
    for (const std::string& text : {scene.name, m.key, m.batch, m.family}) line += csvText(text) + ',';
    line += m.sampler;
    for (const double value : {static_cast<double>(m.spp), static_cast<double>(m.depth), m.minContribution,
                               m.samples, m.asked, m.error})
        line += csvNumber(value);
    line += m.ssim ? csvNumber(*m.ssim) : ",";
    line += (m.hidden ? ",yes" : ",no") + csvNumber(m.bound);
    line += csvErrors(m.total);
    if (m.arithmetic) {
        const ArithmeticError& a = *m.arithmetic;
        line += csvErrors(a.all) + csvErrors(a.samePath) + csvErrors(a.otherPath);
        line += csvNumber(static_cast<double>(a.samePath.pixels));
        line += csvNumber(static_cast<double>(a.otherPath.pixels));
    } else {
        line += std::string(3 * 8 + 2, ',');
    }
    for (const double value :
         {m.wall.low, m.wall.median, m.wall.high, m.device.low, m.device.median, m.device.high, m.compile,
          m.upload, m.readback, static_cast<double>(m.rays), static_cast<double>(m.repeats)}) {
        line += csvNumber(value);
    }
    line += m.isDefault ? ",yes," : ",no,";
    if (contestOf(m) != Contest::None) line += m.beatenBy.empty() ? "yes" : "no";
    return line + "," + csvText(m.beatenBy) + "\r\n";
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
    std::string text = csvHeader();
    for (const SceneReport& scene : data.scenes)
        for (const Measured& m : scene.measured) text += csvLine(scene, m);
    return text;
}

}  // namespace glint::report
