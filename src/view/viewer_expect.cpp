// What a script may ask about the window.
#include <cstdio>
#include <ostream>

#include "core/error.h"
#include "core/text_file.h"
#include "view/viewer.h"

namespace glint::view {

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

std::string Viewer::stateOf(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    const Camera& camera = control_.camera();
    if (what == "aim") return text("%g", 1e3 * pace_.target());
    if (what == "camera") return cameraJson(camera);
    if (what == "cameras") return cameraNames();
    if (what == "control" && command.arguments.size() > 1) {
        const Gui::Place place = placeOf(command, "@" + command.arguments[1]);
        return text("%.0f", place.x - left_) + " " + text("%.0f", place.y);
    }
    if (what == "covered") return text("%.3f", gui_.covered(left_, frame_.width, frame_.height));
    if (what == "difference") return onOffText(difference_.has_value());
    if (what == "error") return session_->goal() ? inWords(*session_->goal(), model_.settings.until) : "none";
    if (what == "exposure") return text("%g", model_.display.exposure);
    if (what == "figures") return comparison_.figures ? text("%.6g", comparison_.figures->rmse) : "none";
    if (what == "focus") return text("%.6g", camera.focusDistance);
    if (what == "fov") return text("%.6g", camera.fovY);
    if (what == "hints") {
        std::string names;
        for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
            if (hinting_ && hints_.wanted(entry.value))
                names += (names.empty() ? "" : " ") + std::string(entry.name);
        return names.empty() ? "none" : names;
    }
    if (what == "layer") return std::string(nameOf(model_.settings.layer));
    if (what == "lens") return text("%.6g", camera.lensRadius);
    if (what == "limit") return std::to_string(model_.settings.sampleLimit);
    if (what == "panel") return onOffText(model_.panelVisible);
    if (what == "pick") return pick_ ? pickTree(*pick_) : "none";
    if (what == "picture")
        return std::to_string(session_->width()) + " " + std::to_string(session_->height());
    if (what == "recent") return recent_.list().empty() ? "none" : recent_.list().front().string();
    if (what == "pixel") return pixelText(model_.pixel);
    if (what == "samples") return std::to_string(session_->samples());
    if (what == "scroll") return text("%.0f", model_.helpScroll);
    if (what == "submissions") return std::to_string(session_->times().submissions);
    if (what == "time") return time_ ? describe(*time_) : "none";
    if (what == "progress") return text("%.4f", session_->progress());
    if (what == "tip") return gui_.tip().empty() ? "none" : gui_.tip();
    if (what == "playing") return onOffText(timeline_.playing());
    if (what == "rate") return text("%g", timeline_.rate());
    if (what == "built") return std::to_string(moments_->treesBuilt());
    if (what == "tree") return text("%.9g", scene_->packed.statistics.sahCost);
    if (what == "tonemap") return std::string(nameOf(model_.display.toneMap));
    if (what == "depth") return std::to_string(model_.settings.maxDepth);
    if (what == "toast") {
        std::string all;
        for (const Toast& toast : toasts_.shown()) all += (all.empty() ? "" : " | ") + toast.text;
        return all.empty() ? "none" : all;
    }
    throw Error(ErrorKind::Argument,
                command.place + ": nothing is called '" + what + "' (docs/guide/window.md)");
}

bool Viewer::startExpectation(const ScriptCommand& command) {
    const std::string& name = command.name;
    std::string wanted = command.rest;
    std::string found;
    if (name == "print") {
        out_ << command.arguments[0] << ' ' << stateOf(command) << std::endl;
        return true;
    }
    if (name == "await") {
        wanted = wanted.substr(command.arguments[0].size() + 1);
        scriptWait_ = [this, &command, wanted, watch = Stopwatch()] {
            if (stateOf(command) == wanted) return true;
            if (watch.seconds() > kPatience) failScript(command, "it is '" + stateOf(command) + "'");
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
        found = !pick_ ? "nothing picked" : pick_->hit() ? std::to_string(pick_->data.object) : "none";
    } else if (name == "expect-size") {
        const PixelSize size = window_.size();
        found = std::to_string(size.width) + " " + std::to_string(size.height);
    } else if (name == "expect-layer") {
        found = nameOf(session_->settings().layer);
    } else if (name == "expect-error") {
        if (model_.sceneError.find(wanted) == std::string::npos)
            failScript(command, "the message is '" + model_.sceneError + "'");
        return true;
    } else if (name == "expect-no-error") {
        found = model_.sceneError;
        wanted.clear();
    } else {
        return false;
    }
    if (found != wanted) failScript(command, "it is '" + found + "'");
    return true;
}

}  // namespace glint::view
