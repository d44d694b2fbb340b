#include "app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <stdexcept>
#include <string_view>

#include "core/device_layout.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/text_file.h"
#include "report/plan.h"
#include "scene/limits.h"

namespace glint::app {

namespace {

// Numbers too large for 64 bits become the largest one, so that range checks refuse them.
std::optional<int64_t> wholeNumber(std::string_view text) {
    int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size()) return std::nullopt;
    if (error != std::errc::result_out_of_range) return value;
    return text.front() == '-' ? std::numeric_limits<int64_t>::min() : std::numeric_limits<int64_t>::max();
}

std::optional<double> number(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

// A number that fits.
double numberWhere(const std::function<bool(double)>& fits, const std::string& wanted,
                   const std::string& text) {
    const auto value = number(text);
    if (!value || !fits(*value)) refuse(wanted, text);
    return *value;
}

// Exactly `count` whole numbers, clamped to the range of int.
std::vector<int> wholeNumbers(const std::string& text, char separator, size_t count,
                              const std::string& wanted) {
    std::vector<int> values;
    for (const std::string& part : split(text, separator)) {
        const auto value = wholeNumber(part);
        if (!value) refuse(wanted, text);
        values.push_back(static_cast<int>(
            std::clamp<int64_t>(*value, std::numeric_limits<int>::min(), std::numeric_limits<int>::max())));
    }
    if (values.size() != count) refuse(wanted, text);
    return values;
}

// The parts of "a, b", each of which must be one of `known`.
std::vector<std::string> namesIn(const std::string& text, const std::string& what,
                                 std::span<const std::string_view> known) {
    std::vector<std::string> names;
    for (const std::string& part : split(text, ',')) {
        const std::string name = trimmed(part);
        refuseIf(std::ranges::find(known, name) == known.end(),
                 "unknown " + what + " " + quoted(name) + " (" + suggestion(name, known, "known") + ")");
        names.push_back(name);
    }
    return names;
}

// A whole number from `least` to `greatest`.
int64_t wholeWithin(const std::string& text, int64_t least, int64_t greatest) {
    const auto value = wholeNumber(text);
    if (!value || *value < least || *value > greatest)
        refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(greatest), text);
    return *value;
}

uint32_t parseSeed(const std::string& text) {
    return static_cast<uint32_t>(wholeWithin(text, 0, std::numeric_limits<uint32_t>::max()));
}

double parseConfidence(const std::string& text) {
    return numberWhere([](double p) { return p > 0.5 && p < 1; }, "a number between 0.5 and 1, such as 0.95",
                       text);
}

// "NAME" or "NAME,RADIUS"
FilterChoice parseFilter(const std::string& text) {
    const std::vector<std::string> parts = split(text, ',');
    const auto filter = named<Filter>(parts[0]);
    const std::optional<double> radius = parts.size() == 2 ? number(parts[1]) : std::nullopt;
    const bool badRadius = parts.size() > 1 && !(radius >= kMinFilterRadius && radius <= kMaxFilterRadius);
    if (!filter || parts.size() > 2 || badRadius)
        refuse(choices<Filter>() + ", and perhaps a radius from 0.01 to 8 pixels as in tent,1.5", text);
    return {*filter, radius};
}

// "MAX" or "MAX,THRESHOLD"
AdaptiveSampling parseAdaptive(const std::string& text) {
    const std::vector<std::string> parts = split(text, ',');
    const auto most = wholeNumber(parts[0]);
    const std::optional<double> threshold =
        parts.size() == 2 ? number(parts[1]) : std::optional(AdaptiveSampling().threshold);
    if (!(most >= 1 && most <= kMaxSamplesPerPixel && threshold > 0 && threshold <= 1) || parts.size() > 2)
        refuse("the most samples of a pixel, from 1 to " + std::to_string(kMaxSamplesPerPixel) +
                   ", and perhaps a threshold above 0, at most 1, as in 64,0.05",
               text);
    return {static_cast<int>(*most), *threshold};
}

void addAllowOutside(OptionTable& table, SceneOptions& options) {
    table.flag("--allow-outside", "allow files outside the scene's folder", options.loading.allowOutside);
}

}  // namespace

void refuse(const std::string& wanted, const std::string& text) {
    throw Error(ErrorKind::Argument, "expected " + wanted + ", got " + quoted(text));
}

void refuseIf(bool wrong, const std::string& line) {
    if (wrong) throw Error(ErrorKind::Argument, line);
}

int parseWhole(const std::string& text, int least, int greatest) {
    return static_cast<int>(wholeWithin(text, least, greatest));
}

Size parseSize(const std::string& text) {
    const auto v = wholeNumbers(text, 'x', 2, "WxH such as 640x480");
    if (std::min(v[0], v[1]) < 1 || std::max(v[0], v[1]) > kMaxImageSize)
        refuse("a width and a height from 1 to " + std::to_string(kMaxImageSize), text);
    return {v[0], v[1]};
}

PartChoice parsePart(const std::string& text) {
    const std::string form = "K/N with 1 <= K <= N, such as 3/8";
    const auto v = wholeNumbers(text, '/', 2, form);
    if (v[1] < 1 || v[1] > kMostParts || v[0] < 1 || v[0] > v[1]) refuse(form, text);
    return {v[0], v[1]};
}

FrameRange parseFrames(const std::string& text) {
    constexpr int kMostFrames = 10'000'000;
    const std::string form = "A:B with 0 <= A <= B, such as 0:240, or one number";
    const auto v = wholeNumbers(text, ':', text.find(':') == std::string::npos ? 1 : 2, form);
    if (v.front() < 0 || v.back() < v.front() || v.back() > kMostFrames) refuse(form, text);
    return {v.front(), v.back()};
}

Region parseCrop(const std::string& text) {
    const auto v = wholeNumbers(text, ',', 4, "x0,y0,x1,y1 such as 0,0,64,64");
    if (v[0] < 0 || v[1] < 0 || v[2] <= v[0] || v[3] <= v[1])
        refuse("x0,y0,x1,y1 with 0 <= x0 < x1 and 0 <= y0 < y1", text);
    return {v[0], v[1], v[2], v[3]};
}

std::pair<int, int> parsePixel(const std::string& text) {
    const auto v = wholeNumbers(text, ',', 2, "x,y such as 320,240");
    // So that the message about the image's size has the numbers that were given.
    if (std::max(std::abs(int64_t{v[0]}), std::abs(int64_t{v[1]})) > kMaxImageSize)
        refuse("x,y below " + std::to_string(kMaxImageSize), text);
    return {v[0], v[1]};
}

std::vector<Aov> parseAovs(const std::string& text) {
    std::vector<Aov> aovs;
    for (const std::string& name : namesIn(text, "layer", kEnumNames<Aov>)) {
        const Aov aov = named<Aov>(name).value();
        refuseIf(std::find(aovs.begin(), aovs.end(), aov) != aovs.end(),
                 "the layer " + quoted(name) + " is given twice");
        aovs.push_back(aov);
    }
    return aovs;
}

std::vector<std::string> parseFamilies(const std::string& text) {
    const std::vector<std::string>& starts = report::familyStarts();
    return namesIn(text, "setting", std::vector<std::string_view>(starts.begin(), starts.end()));
}

SceneFeatures parseFeatures(const std::string& text) {
    static const std::vector<std::string_view> known = {
#define GLINT_NAME(ID, NAME, field) #field,
        GLINT_FEATURES(GLINT_NAME)
#undef GLINT_NAME
    };
    SceneFeatures features;
    for (const std::string& name : namesIn(text, "feature", known)) {
#define GLINT_SET(ID, NAME, field) \
    if (name == #field) features.field = true;
        GLINT_FEATURES(GLINT_SET)
#undef GLINT_SET
    }
    return features;
}

double parseNotNegative(const std::string& text) {
    return numberWhere([](double v) { return v >= 0; }, "a number from 0 up", text);
}

double parsePositive(const std::string& text) {
    return numberWhere([](double v) { return v > 0; }, "a number above 0", text);
}

double parseReal(const std::string& text, double least, double greatest) {
    return numberWhere([=](double v) { return v >= least && v <= greatest; },
                       "a number from " + describe(least) + " to " + describe(greatest), text);
}

const std::string& parseName(const std::string& text) {
    refuseIf(text.empty(), "the name is empty");
    return text;
}

void OptionTable::read(const std::string& names, const std::string& form, const std::string& help,
                       const std::function<void(const std::string& text)>& use) {
    // "--output" of "-o,--output".
    const auto named = [name = names.substr(names.rfind(',') + 1), use](const std::string& text) {
        try {
            use(text);
        } catch (const Error& e) {
            throw Error(e.kind(), name + ": " + e.what());
        }
    };
    command_.add_option_function<std::string>(names, named, help)
        ->type_name(form)
        ->required(!names.starts_with('-'));
}

void OptionTable::files(const std::string& name, const std::string& help,
                        std::vector<std::filesystem::path>& target) {
    const auto use = [name, &target](const std::vector<std::string>& list) {
        for (const std::string& text : list) refuseIf(text.empty(), name + ": the name is empty");
        target.assign(list.begin(), list.end());
    };
    command_.add_option_function<std::vector<std::string>>(name, use, help)->type_name("")->required();
}

CLI::Option& OptionTable::optionNamed(const std::string& name) {
    for (CLI::Option* option : command_.get_options())
        if (option->check_name(name)) return *option;
    throw std::logic_error("no option " + name);
}

void OptionTable::acceptAll() {
    command_.allow_extras();
}

void OptionTable::require(const std::string& option) {
    optionNamed(option).required();
}

void OptionTable::require(const std::string& needed, const std::vector<std::string>& options) {
    for (const std::string& option : options) optionNamed(option).needs(&optionNamed(needed));
}

// Not by CLI11's excludes(), whose message has no remedy. CLI11 counts all options before it looks at values.
void OptionTable::exclude(const std::string& option, const std::string& other, const std::string& remedy) {
    const CLI::Option& first = optionNamed(option);
    optionNamed(other).check(
        [&first, line = option + " excludes " + other + ": " + remedy](const std::string&) {
            refuseIf(first.count() > 0, line);
            return std::string();
        });
}

void OptionTable::requireGpu(const std::vector<std::string>& options) {
    const CLI::Option& backend = optionNamed("--backend");
    for (const std::string& option : options)
        optionNamed(option).check([&backend, line = option + ": needs --backend gpu"](const std::string&) {
            refuseIf(backend.count() > 0 && backend.results().front() == nameOf(Backend::Cpu), line);
            return std::string();
        });
}

void OptionTable::flag(const std::string& names, const std::string& help, bool& target, bool value) {
    command_.add_flag_callback(
        names, [&target, value] { target = value; }, help);
}

void addScene(OptionTable& table, SceneOptions& options, const std::string& more) {
    table.name("SCENE", "", "scene (.json .gltf .glb .nff) or model (.obj .ply .stl)" + more, options.scene);
    addAllowOutside(table, options);
}

void addScenes(OptionTable& table, std::vector<std::filesystem::path>& scenes, SceneOptions& options) {
    table.files("SCENE", "scenes or models", scenes);
    addAllowOutside(table, options);
}

void addSceneOverrides(OptionTable& table, SceneOptions& options, const std::string& defaultSize) {
    table.value("--size", "WxH", "size in pixels (default: " + defaultSize + ")", options.size, parseSize);
    table.whole("--spp", "N", "samples per pixel (default: the scene's)", 1, kMaxSamplesPerPixel,
                options.spp);
    table.whole("--max-depth", "N", "most reflections and refractions in a row (default: the scene's)", 0,
                kMaxBounces, options.limits.depth);
    table.choice<BuildQuality>("--build-quality", "effort for the BVH: " + explainedChoices<BuildQuality>(),
                               options.buildQuality);
    addCamera(table, options);
    table.value("--time", "SECONDS", "time in the scene's animation (default: the file as it is)",
                options.time, parseNotNegative);
}

void addCameraName(OptionTable& table, SceneOptions& options) {
    table.name("--camera", "NAME", "camera of the scene (glint info lists them)", options.loading.camera);
}

void addCamera(OptionTable& table, SceneOptions& options) {
    addCameraName(table, options);
    table.choice<UpAxis>("--up", "axis that points up in a model without a camera (default y)",
                         options.loading.up);
}

void addMethods(OptionTable& table, SceneOptions& options) {
    table.choice<TriangleMethod>(
        "--intersector",
        "triangle test (default watertight); the others are textbook methods, for comparison",
        options.methods.triangles);
    table.choice<SphereMethod>(
        "--sphere", "sphere test (default robust); the others are textbook methods, for comparison",
        options.methods.spheres);
}

void addMinContribution(OptionTable& table, SceneOptions& options) {
    table.value("--min-contribution", "X",
                "cut reflected and refracted rays that add less than X to a pixel (default 0)",
                options.limits.minContribution, parseNotNegative);
}

void addSampling(OptionTable& table, SceneOptions& options) {
    table.choice<Sampler>("--sampler", "placement of samples (default: the scene's)", options.sampler);
    table.value("--filter", "NAME[,RADIUS]", choices<Filter>() + "; radius in pixels (default: the scene's)",
                options.filter, parseFilter);
    table.value("--seed", "N", "seed of the random samplers (default: the scene's)", options.seed, parseSeed);
    table.value("--adaptive", "MAX[,THRESHOLD]",
                "take up to MAX samples in pixels whose samples differ (threshold 0 to 1, default 0.05)",
                options.adaptive, parseAdaptive);
}

void addExposure(OptionTable& table, std::optional<double>& stops) {
    table.real("--exposure", "STOPS", "multiply the colours of a .png by 2^STOPS (default 0)", -100, 100,
               stops);
}

void addError(OptionTable& table, converge::Target& target) {
    table.value("--error", "E",
                "take samples until the root mean square error is at most E (linear, full scale 1)",
                target.error, parsePositive);
    table.value("--confidence", "P", "probability that --error holds, above 0.5 and below 1 (default 0.95)",
                target.confidence, parseConfidence);
    table.flag("--within-depth", "do not count reflections beyond the scene's depth as error",
               target.depthCounts, false);
    table.require("--error", {"--confidence", "--within-depth"});
}

void addBackend(OptionTable& table, DeviceChoice& device) {
    table.choice<Backend>(
        "--backend", "gpu (default), or cpu: the double-precision reference, without Vulkan", device.backend);
}

void addDevice(OptionTable& table, DeviceChoice& device) {
    table.name("--device", "NAME|INDEX",
               "part of a device's name, or its index in glint devices (default: the best)", device.selector);
    table.read("--threads", "N", "host threads, also of lavapipe (default: one per processor)",
               [](const std::string& text) {
                   limitThreads(static_cast<unsigned>(parseWhole(text, 1, 1024)));
                   setenv("LP_NUM_THREADS", text.c_str(), 1);
               });
    table.flag("--validation", "run the Vulkan validation layer; its messages are errors", device.validation);
}

void addTraversal(OptionTable& table, DeviceChoice& device) {
    table.choice<render::Traversal>(
        "--traversal", "one ray per lane (lane) or 32 rays together (packet); default auto chooses",
        device.traversal);
}

void addProgress(OptionTable& table, ProgressMode& mode) {
    table.choice<ProgressMode>("--progress", "on standard error (default auto: a bar on a terminal)", mode);
}

void addStats(OptionTable& table, const std::string& help, bool& json) {
    table.read("--stats", "json", help, [&](const std::string& text) {
        if (text != "json") refuse("json", text);
        json = true;
    });
}

}  // namespace glint::app
