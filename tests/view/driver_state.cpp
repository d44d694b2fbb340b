#include "driver.h"

#include <functional>
#include <map>

#include "core/error.h"
#include "core/format.h"
#include "core/text_file.h"
#include "import/camera_writer.h"

namespace glint::view::test {

namespace {

constexpr double kPatience = 60;  // seconds

std::string onOffText(bool on) {
    return on ? "on" : "off";
}

// The part of the image that the panel and other boxes hide, 0..1.
double covered(Viewer& viewer) {
    const int left = viewer.model().left, width = viewer.frame().width, height = viewer.frame().height;
    size_t hidden = 0;
    for (int y = 0; y < height; ++y)
        for (int x = left; x < width; ++x) hidden += viewer.gui().covers(x, y, true) ? 1 : 0;
    return static_cast<double>(hidden) / std::max(1.0, static_cast<double>(width - left) * height);
}

// One line for each ray, indented by its depth.
std::string pickTree(const Pick& pick) {
    std::string lines;
    for (const PickRay& ray : pick.rays)
        lines += std::string(2 * ray.depth, ' ') + format("%.1f %% ", 100 * ray.share) + ray.text + '\n';
    return lines;
}

std::string pickedObject(const Pick& pick) {
    return pick.hit() ? std::to_string(pick.data.object) : "";
}

std::string placeText(const glm::dvec2& place, int left) {
    return format("%.0f %.0f", place.x - left, place.y);
}

auto wantedName(const Hints& hints) {
    return [&](const EnumEntry<Hint>& entry) { return hints.wanted(entry.value) ? entry.name : ""; };
}

std::string pixelText(const Model& m) {
    if (!m.pixel) return "";
    const Picture& picture = m.session->picture();
    const glm::ivec2 at = *m.pixel;
    const auto color = [&](int c) { return static_cast<double>(picture.color.at(at.x, at.y, c)); };
    const std::string line = format("%d %d  %.6g %.6g %.6g  ", at.x, at.y, color(0), color(1), color(2));
    if (!m.session->hasData()) return line;
    const PixelData& data = picture.at(at.x, at.y);
    return line + objectName(m.scene->scene, data.object) + " " + format("%.6g", data.depth);
}

// The texts that `textOf` gives for the items, but for empty ones.
template <typename Items, typename TextOf>
std::string joined(const Items& items, const char* separator, const TextOf& textOf) {
    std::string all;
    for (const auto& item : items) {
        const std::string text(textOf(item));
        if (!text.empty()) all += (all.empty() ? "" : separator) + text;
    }
    return all;
}

}  // namespace

std::string Driver::stateOf(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    const Camera& camera = m_.control.camera();
    const std::optional<Pick>& pick = m_.pick;
    const Session& session = *m_.session;
    const PixelSize size = window_.size();
    const double error = m_.settings.until.error;
    const std::map<std::string, std::function<std::string()>> states = {
        {"aim", [&] { return format("%g", 1e3 * m_.targetSeconds); }},
        {"built", [&] { return std::to_string(m_.moments->treesBuilt()); }},
        {"camera", [&] { return "\"camera\": " + cameraText(camera); }},
        {"cameras", [&] { return joined(m_.cameras(), ", ", [](auto* each) { return each->name; }); }},
        {"control", [&] { return placeText(placeOf(command, "@" + command.arguments.at(1)), m_.left); }},
        {"covered", [&] { return format("%.3f", covered(viewer_)); }},
        {"depth", [&] { return std::to_string(m_.settings.maxDepth); }},
        {"difference", [&] { return onOffText(m_.difference.has_value()); }},
        {"error", [&] { return error > 0 ? inWords(session.goal(), error) : ""; }},
        {"exposure", [&] { return format("%g", m_.display.exposure); }},
        {"fault", [&] { return m_.sceneError; }},
        {"figures", [&] { return m_.comparison.figures ? format("%.6g", m_.comparison.figures->rmse) : ""; }},
        {"fov", [&] { return format("%.6g", camera.fovY); }},
        {"hints", [&] { return joined(kEnumEntries<Hint>, " ", wantedName(m_.hints)); }},
        {"layer", [&] { return std::string(nameOf(m_.settings.layer)); }},
        {"object", [&] { return pick ? pickedObject(*pick) : "no pick"; }},
        {"pick", [&] { return pick ? pickTree(*pick) : ""; }},
        {"picture", [&] { return format("%d %d", session.width(), session.height()); }},
        {"pixel", [&] { return pixelText(m_); }},
        {"playing", [&] { return onOffText(m_.timeline.playing()); }},
        {"samples", [&] { return std::to_string(session.samples()); }},
        {"size", [&] { return format("%d %d", size.width, size.height); }},
        {"submissions", [&] { return std::to_string(session.times().submissions); }},
        {"time", [&] { return m_.time ? describe(*m_.time) : ""; }},
        {"tip", [&] { return viewer_.gui().tip(); }},
        {"toast", [&] { return joined(m_.toasts.shown(), " | ", [](auto& toast) { return toast.text; }); }},
        {"tonemap", [&] { return std::string(nameOf(m_.display.toneMap)); }},
        {"tree", [&] { return format("%.9g", m_.scene->packed.statistics.sahCost); }},
        {"verdict", [&] { return m_.verdict.empty() ? ""
                                 : m_.verdictPassed ? "passed"
                                                    : "failed"; }},
        {"waiting", [&] { return m_.waitingComparison(); }},
        {"warnings", [&] { return std::to_string(m_.warnings.size()); }}};
    const auto state = states.find(what);
    if (state == states.end()) fail(command, "nothing has this name");
    const std::string text = state->second();
    return text.empty() ? "none" : text;
}

bool Driver::startExpectation(const ScriptCommand& command) {
    const std::string& name = command.name;
    if (name != "print" && name != "await" && name != "expect") return false;
    const std::string& what = command.arguments[0];
    if (name == "print") {
        out_ << what << ' ' << stateOf(command) << std::endl;
        return true;
    }
    const std::string wanted = command.rest.substr(what.size() + 1);
    const bool part = (what == "toast" || what == "pick" || what == "fault") && wanted != "none";
    const auto holds = [this, &command, wanted, part] {
        const std::string found = stateOf(command);
        return part ? found.find(wanted) != std::string::npos : found == wanted;
    };
    if (name == "await")
        wait_ = [this, &command, holds, watch = Stopwatch()] {
            if (holds()) return true;
            if (watch.seconds() > kPatience) fail(command, "it is '" + stateOf(command) + "'");
            return false;
        };
    else if (!holds())
        fail(command, "it is '" + stateOf(command) + "'");
    return true;
}

}  // namespace glint::view::test
