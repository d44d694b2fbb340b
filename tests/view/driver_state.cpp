#include "driver.h"

#include <algorithm>
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

// The part of the image that the panel and other boxes hide, 0..1.
double covered(Viewer& viewer) {
    const int left = viewer.model().left, width = viewer.frame().width, height = viewer.frame().height;
    size_t hidden = 0;
    for (int y = 0; y < height; ++y)
        for (int x = left; x < width; ++x)
            hidden += std::any_of(viewer.gui().windows().begin(), viewer.gui().windows().end(),
                                  [&](const Gui::Rectangle& r) {
                                      return x >= static_cast<int>(r.x0) && x < static_cast<int>(r.x1) &&
                                             y >= static_cast<int>(r.y0) && y < static_cast<int>(r.y1);
                                  })
                          ? 1
                          : 0;
    return static_cast<double>(hidden) / std::max(1.0, static_cast<double>(width - left) * height);
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
    for (const auto* list : {&viewer_.model().file->cameras, &std::as_const(viewer_.model().bookmarks)})
        for (const NamedCamera& camera : *list) names += (names.empty() ? "" : ", ") + camera.name;
    return names.empty() ? "none" : names;
}

std::string Driver::stateOf(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    const Camera& camera = viewer_.model().control.camera();
    if (what == "aim") return text("%g", 1e3 * viewer_.model().targetSeconds);
    if (what == "camera") return cameraJson(camera);
    if (what == "cameras") return cameraNames();
    if (what == "control" && command.arguments.size() > 1) {
        const Gui::Place place = placeOf(command, "@" + command.arguments[1]);
        return text("%.0f", place.x - viewer_.model().left) + " " + text("%.0f", place.y);
    }
    if (what == "covered") return text("%.3f", covered(viewer_));
    if (what == "difference") return onOffText(viewer_.model().difference.has_value());
    if (what == "error")
        return viewer_.model().session->goal()
                   ? inWords(*viewer_.model().session->goal(), viewer_.model().settings.until)
                   : "none";
    if (what == "exposure") return text("%g", viewer_.model().display.exposure);
    if (what == "figures")
        return viewer_.model().comparison.figures ? text("%.6g", viewer_.model().comparison.figures->rmse)
                                                  : "none";
    if (what == "focus") return text("%.6g", camera.focusDistance);
    if (what == "fov") return text("%.6g", camera.fovY);
    if (what == "hints") {
        std::string names;
        for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
            if (viewer_.model().hints.wanted(entry.value))
                names += (names.empty() ? "" : " ") + std::string(entry.name);
        return names.empty() ? "none" : names;
    }
    if (what == "layer") return std::string(nameOf(viewer_.model().settings.layer));
    return stateOfImage(command);
}

std::string Driver::stateOfImage(const ScriptCommand& command) const {
    const std::string& what = command.arguments[0];
    const Camera& camera = viewer_.model().control.camera();
    if (what == "lens") return text("%.6g", camera.lensRadius);
    if (what == "limit") return std::to_string(viewer_.model().settings.sampleLimit);
    if (what == "panel") return onOffText(viewer_.model().panelVisible);
    if (what == "pick") return viewer_.model().pick ? pickTree(*viewer_.model().pick) : "none";
    if (what == "picture")
        return std::to_string(viewer_.model().session->width()) + " " +
               std::to_string(viewer_.model().session->height());
    if (what == "recent")
        return viewer_.model().recent.list().empty() ? "none"
                                                     : viewer_.model().recent.list().front().string();
    if (what == "pixel") return pixelText(viewer_.model().pixel);
    if (what == "samples") return std::to_string(viewer_.model().session->samples());
    if (what == "scroll") return text("%.0f", viewer_.model().helpScroll);
    if (what == "submissions") return std::to_string(viewer_.model().session->times().submissions);
    if (what == "time") return viewer_.model().time ? describe(*viewer_.model().time) : "none";
    if (what == "progress") return text("%.4f", viewer_.model().session->progress());
    if (what == "tip") return viewer_.gui().tip().empty() ? "none" : viewer_.gui().tip();
    if (what == "playing") return onOffText(viewer_.model().timeline.playing());
    if (what == "rate") return text("%g", viewer_.model().timeline.rate());
    if (what == "built") return std::to_string(viewer_.model().moments->treesBuilt());
    if (what == "tree") return text("%.9g", viewer_.model().scene->packed.statistics.sahCost);
    if (what == "tonemap") return std::string(nameOf(viewer_.model().display.toneMap));
    if (what == "depth") return std::to_string(viewer_.model().settings.maxDepth);
    if (what == "verdict")
        return viewer_.model().verdict.empty() ? "none" : viewer_.model().verdictPassed ? "passed" : "failed";
    if (what == "waiting") {
        const std::string waiting = viewer_.model().waitingComparison();
        return waiting.empty() ? "none" : waiting;
    }
    if (what == "warnings") return std::to_string(viewer_.model().warnings.size());
    if (what == "toast") {
        std::string all;
        for (const Toast& toast : viewer_.model().toasts.shown())
            all += (all.empty() ? "" : " | ") + toast.text;
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
        found = !viewer_.model().pick         ? "nothing picked"
                : viewer_.model().pick->hit() ? std::to_string(viewer_.model().pick->data.object)
                                              : "none";
    } else if (name == "expect-size") {
        const PixelSize size = viewer_.window().size();
        found = std::to_string(size.width) + " " + std::to_string(size.height);
    } else if (name == "expect-layer") {
        found = nameOf(viewer_.model().session->settings().layer);
    } else if (name == "expect-error") {
        if (viewer_.model().sceneError.find(wanted) == std::string::npos)
            fail(command, "the message is '" + viewer_.model().sceneError + "'");
        return true;
    } else if (name == "expect-no-error") {
        found = viewer_.model().sceneError;
        wanted.clear();
    } else {
        return false;
    }
    if (found != wanted) fail(command, "it is '" + found + "'");
    return true;
}

}  // namespace glint::view::test
