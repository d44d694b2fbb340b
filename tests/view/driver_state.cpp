#include "driver.h"

#include <cstdio>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/text_file.h"

namespace glint::view::test {

namespace {

constexpr double kPatience = 60;  // seconds

std::string text(const char* format, double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof(buffer), format, value);
    return buffer;
}

std::string onOffText(bool on) {
    return on ? "on" : "off";
}

std::string pixelText(const std::optional<PixelFacts>& pixel) {
    if (!pixel) return "none";
    char line[160];
    std::snprintf(line, sizeof(line), "%d %d  %.6g %.6g %.6g  ", pixel->x, pixel->y,
                  static_cast<double>(pixel->linear.x), static_cast<double>(pixel->linear.y),
                  static_cast<double>(pixel->linear.z));
    return line + (pixel->hasData ? pixel->object + " " + text("%.6g", pixel->data.depth) : "");
}

}  // namespace

std::string Driver::cameraNames() const {
    std::string names;
    for (const auto* list : {&viewer_.fileCameras(), &std::as_const(viewer_.bookmarks_)})
        for (const NamedCamera& camera : *list) names += (names.empty() ? "" : ", ") + camera.name;
    return names.empty() ? "none" : names;
}

std::string Driver::stateOf(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    const Camera& camera = viewer_.control_.camera();
    if (what == "aim") return text("%g", 1e3 * viewer_.pace_.target());
    if (what == "camera") return cameraJson(camera);
    if (what == "cameras") return cameraNames();
    if (what == "control" && command.arguments.size() > 1) {
        const Gui::Place place = placeOf(command, "@" + command.arguments[1]);
        return text("%.0f", place.x - viewer_.left_) + " " + text("%.0f", place.y);
    }
    if (what == "covered")
        return text("%.3f", viewer_.gui_.covered(viewer_.left_, viewer_.frame_.width, viewer_.frame_.height));
    if (what == "difference") return onOffText(viewer_.difference_.has_value());
    if (what == "error")
        return viewer_.session_->goal() ? inWords(*viewer_.session_->goal(), viewer_.model_.settings.until)
                                        : "none";
    if (what == "exposure") return text("%g", viewer_.model_.display.exposure);
    if (what == "figures")
        return viewer_.comparison_.figures ? text("%.6g", viewer_.comparison_.figures->rmse) : "none";
    if (what == "focus") return text("%.6g", camera.focusDistance);
    if (what == "fov") return text("%.6g", camera.fovY);
    if (what == "hints") {
        std::string names;
        for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
            if (viewer_.hints_.wanted(entry.value))
                names += (names.empty() ? "" : " ") + std::string(entry.name);
        return names.empty() ? "none" : names;
    }
    if (what == "layer") return std::string(nameOf(viewer_.model_.settings.layer));
    if (what == "lens") return text("%.6g", camera.lensRadius);
    if (what == "limit") return std::to_string(viewer_.model_.settings.sampleLimit);
    if (what == "panel") return onOffText(viewer_.model_.panelVisible);
    if (what == "pick") return viewer_.pick_ ? pickTree(*viewer_.pick_) : "none";
    if (what == "picture")
        return std::to_string(viewer_.session_->width()) + " " + std::to_string(viewer_.session_->height());
    if (what == "recent")
        return viewer_.recent_.list().empty() ? "none" : viewer_.recent_.list().front().string();
    if (what == "pixel") return pixelText(viewer_.model_.pixel);
    if (what == "samples") return std::to_string(viewer_.session_->samples());
    if (what == "scroll") return text("%.0f", viewer_.model_.helpScroll);
    if (what == "submissions") return std::to_string(viewer_.session_->times().submissions);
    if (what == "time") return viewer_.time_ ? describe(*viewer_.time_) : "none";
    if (what == "progress") return text("%.4f", viewer_.session_->progress());
    if (what == "tip") return viewer_.gui_.tip().empty() ? "none" : viewer_.gui_.tip();
    if (what == "playing") return onOffText(viewer_.timeline_.playing());
    if (what == "rate") return text("%g", viewer_.timeline_.rate());
    if (what == "built") return std::to_string(viewer_.moments_->treesBuilt());
    if (what == "tree") return text("%.9g", viewer_.scene_->packed.statistics.sahCost);
    if (what == "tonemap") return std::string(nameOf(viewer_.model_.display.toneMap));
    if (what == "depth") return std::to_string(viewer_.model_.settings.maxDepth);
    if (what == "toast") {
        std::string all;
        for (const Toast& toast : viewer_.toasts_.shown()) all += (all.empty() ? "" : " | ") + toast.text;
        return all.empty() ? "none" : all;
    }
    throw Error(ErrorKind::Argument,
                command.place + ": nothing is called '" + what + "' (tests/view/script.cpp)");
}

bool Driver::startExpectation(const ScriptCommand& command) {
    const std::string& name = command.name;
    std::string wanted = command.rest;
    std::string found;
    if (name == "print") {
        out_ << command.arguments[0] << ' ' << stateOf(command) << std::endl;
        return true;
    }
    if (name == "await") {
        wanted = wanted.substr(command.arguments[0].size() + 1);
        wait_ = [this, &command, wanted, watch = Stopwatch()] {
            if (stateOf(command) == wanted) return true;
            if (watch.seconds() > kPatience) fail(command, "it is '" + stateOf(command) + "'");
            return false;
        };
        return true;
    }
    if (name == "expect") {
        const std::string& what = command.arguments[0];
        found = stateOf(command);
        wanted = wanted.substr(what.size() + 1);
        if ((what == "toast" || what == "pick") && found.find(wanted) != std::string::npos) return true;
    } else if (name == "expect-object") {
        found = !viewer_.pick_         ? "nothing picked"
                : viewer_.pick_->hit() ? std::to_string(viewer_.pick_->data.object)
                                       : "none";
    } else if (name == "expect-size") {
        const PixelSize size = viewer_.window_.size();
        found = std::to_string(size.width) + " " + std::to_string(size.height);
    } else if (name == "expect-layer") {
        found = nameOf(viewer_.session_->settings().layer);
    } else if (name == "expect-error") {
        if (viewer_.model_.sceneError.find(wanted) == std::string::npos)
            fail(command, "the message is '" + viewer_.model_.sceneError + "'");
        return true;
    } else if (name == "expect-no-error") {
        found = viewer_.model_.sceneError;
        wanted.clear();
    } else {
        return false;
    }
    if (found != wanted) fail(command, "it is '" + found + "'");
    return true;
}

}  // namespace glint::view::test
