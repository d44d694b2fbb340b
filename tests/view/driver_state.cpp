#include "driver.h"

#include <algorithm>

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

std::string pixelText(const Model& m) {
    if (!m.pixel) return "none";
    const Picture& picture = m.session->picture();
    const glm::ivec2 at = *m.pixel;
    const auto color = [&](int c) { return static_cast<double>(picture.color.at(at.x, at.y, c)); };
    const std::string line = format("%d %d  %.6g %.6g %.6g  ", at.x, at.y, color(0), color(1), color(2));
    if (!m.session->hasData()) return line;
    const PixelData& data = picture.at(at.x, at.y);
    return line + objectName(m.scene->scene, data.object) + " " + format("%.6g", data.depth);
}

std::string cameraNames(const Model& m) {
    std::string names;
    for (const NamedCamera* camera : m.cameras()) names += (names.empty() ? "" : ", ") + camera->name;
    return names.empty() ? "none" : names;
}

}  // namespace

std::string Driver::stateOf(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    const Camera& camera = m_.control.camera();
    if (what == "aim") return format("%g", 1e3 * m_.targetSeconds);
    if (what == "camera") return "\"camera\": " + cameraText(camera);
    if (what == "cameras") return cameraNames(m_);
    if (what == "control" && command.arguments.size() > 1) {
        const glm::dvec2 place = placeOf(command, "@" + command.arguments[1]);
        return format("%.0f %.0f", place.x - m_.left, place.y);
    }
    if (what == "covered") return format("%.3f", covered(viewer_));
    if (what == "difference") return onOffText(m_.difference.has_value());
    if (what == "error")
        return m_.settings.until.error > 0 ? inWords(m_.session->goal(), m_.settings.until.error) : "none";
    if (what == "exposure") return format("%g", m_.display.exposure);
    if (what == "fault") return m_.sceneError.empty() ? "none" : m_.sceneError;
    if (what == "figures")
        return m_.comparison.figures ? format("%.6g", m_.comparison.figures->rmse) : "none";
    if (what == "fov") return format("%.6g", camera.fovY);
    if (what == "hints") {
        std::string names;
        for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
            if (m_.hints.wanted(entry.value)) names += (names.empty() ? "" : " ") + std::string(entry.name);
        return names.empty() ? "none" : names;
    }
    if (what == "layer") return std::string(nameOf(m_.settings.layer));
    return stateOfImage(command);
}

std::string Driver::stateOfImage(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    if (what == "object") {
        const std::optional<Pick>& pick = m_.pick;
        return !pick ? "no pick" : pick->hit() ? std::to_string(pick->data.object) : "none";
    }
    if (what == "pick") return m_.pick ? pickTree(*m_.pick) : "none";
    if (what == "picture") return format("%d %d", m_.session->width(), m_.session->height());
    if (what == "pixel") return pixelText(m_);
    if (what == "samples") return std::to_string(m_.session->samples());
    if (what == "size") {
        const PixelSize size = viewer_.window().size();
        return format("%d %d", size.width, size.height);
    }
    if (what == "submissions") return std::to_string(m_.session->times().submissions);
    if (what == "time") return m_.time ? describe(*m_.time) : "none";
    if (what == "tip") return viewer_.gui().tip().empty() ? "none" : viewer_.gui().tip();
    if (what == "playing") return onOffText(m_.timeline.playing());
    if (what == "built") return std::to_string(m_.moments->treesBuilt());
    if (what == "tree") return format("%.9g", m_.scene->packed.statistics.sahCost);
    if (what == "tonemap") return std::string(nameOf(m_.display.toneMap));
    if (what == "depth") return std::to_string(m_.settings.maxDepth);
    if (what == "verdict") return m_.verdict.empty() ? "none" : m_.verdictPassed ? "passed" : "failed";
    if (what == "waiting") {
        const std::string waiting = m_.waitingComparison();
        return waiting.empty() ? "none" : waiting;
    }
    if (what == "warnings") return std::to_string(m_.warnings.size());
    if (what == "toast") {
        std::string all;
        for (const Toast& toast : m_.toasts.shown()) all += (all.empty() ? "" : " | ") + toast.text;
        return all.empty() ? "none" : all;
    }
    fail(command, "nothing has this name");
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
