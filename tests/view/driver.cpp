#include "driver.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/image_io.h"
namespace glint::view::test {

Driver::Driver(Viewer& viewer, std::vector<ScriptCommand> script, std::ostream& out, bool stays)
    : viewer_(viewer),
      m_(viewer.model()),
      input_(viewer.input()),
      out_(out),
      script_(std::move(script)),
      stays_(stays) {}

namespace {

Event cursorAt(double x, double y) {
    return {.type = Event::Type::Cursor, .x = x, .y = y};
}

Event press(Button button, bool down, int mods = 0) {
    return {.type = Event::Type::Button, .code = static_cast<int>(button), .mods = mods, .down = down};
}

Event keyEvent(const KeyPress& k, bool down) {
    return {.type = Event::Type::Key, .code = k.key, .mods = k.mods, .down = down};
}

KeyPress keyOf(const ScriptCommand& command) {
    const std::optional<KeyPress> k = keyNamed(command.arguments[0]);
    if (!k)
        throw Error(ErrorKind::Argument,
                    command.place + ": no such key: '" + command.arguments[0] + "' (F1 lists them)");
    return *k;
}

bool onOff(const ScriptCommand& command) {
    const std::string& value = command.arguments[1];
    if (value != "on" && value != "off")
        throw Error(ErrorKind::Argument, command.place + ": expected on or off");
    return value == "on";
}

}  // namespace

void Driver::fail(const ScriptCommand& command, const std::string& what) {
    throw Error(ErrorKind::Failed, command.place + ": " + command.name + ": " + what);
}

void Driver::waitFrames(int frames) {
    const uint64_t until = viewer_.frames() + static_cast<uint64_t>(std::max(frames, 0));
    wait_ = [this, until] { return viewer_.frames() >= until; };
}

void Driver::run() {
    viewer_.open();
    bool closed = false;
    do {
        advance();
        const bool scripted = wait_ || next_ < script_.size();
        viewer_.setRestless(!idles_ && (scripted || script_.empty()));
        if (!scripted && !stays_ && !std::exchange(closed, true)) input_.push({.type = Event::Type::Close});
    } while (viewer_.step());
    viewer_.close();
}

// A command starts after the one before it is over and its events are handled. Repetitions of a held key do
// not count: in slow frames the queue always holds one, and a command that releases the key would never
// start.
void Driver::advance() {
    const auto repeats = [this](const Event& event) {
        return (event.type == Event::Type::Key && event.repeat) ||
               (event.type == Event::Type::Text && input_.flies());
    };
    if (!std::all_of(input_.queue().begin(), input_.queue().end(), repeats)) return;
    if (wait_ && !wait_()) return;
    wait_ = nullptr;
    if (next_ < script_.size()) start(script_[next_++]);
}

void Driver::start(const ScriptCommand& command) {
    const std::string& name = command.name;
    if (startInput(command) || startExpectation(command)) return;
    if (name == "wait") {
        waitFrames(wholeOf(command, 0));
    } else if (name == "settle") {
        wait_ = [this] { return viewer_.commands().settled(); };
    } else if (name == "resize") {
        const PixelSize wanted = {wholeOf(command, 0), wholeOf(command, 1)};
        viewer_.window().resize(wanted);
        wait_ = [this, wanted] {
            return viewer_.window().size() == wanted && m_.session->width() == wanted.width - m_.left;
        };
    } else if (name == "minimise") {
        viewer_.window().setMinimised(true);
        wait_ = [this, left = wholeOf(command, 0)]() mutable {
            if (left-- > 0) return false;
            viewer_.window().setMinimised(false);
            return true;
        };
    } else if (name == "aov") {
        const std::optional<ViewLayer> layer = named<ViewLayer>(command.arguments[0]);
        if (!layer)
            throw Error(ErrorKind::Argument,
                        command.place + ": no such layer: '" + command.arguments[0] + "'");
        m_.settings.layer = *layer;
        viewer_.commands().takeSettings();
    } else if (name == "set") {
        set(command);
    } else if (name == "reload") {
        wait_ = [this, before = viewer_.commands().reloads()] {
            return viewer_.commands().reloads() > before;
        };
    } else if (name == "verify") {
        viewer_.commands().perform(Action::Verify);
        wait_ = [this, &command] {
            if (m_.verifyProgress >= 0) return false;
            if (!m_.verdictPassed) fail(command, m_.verdict);
            return true;
        };
    } else if (name == "idle") {
        startIdling(numberOf(command, 0));
    } else if (name == "lose-device") {
        viewer_.recover(gpu::DeviceLost("lose-device: as if VK_ERROR_DEVICE_LOST"));
    } else if (name == "stay") {
        stays_ = true;
    } else {
        startFile(command);
    }
}

bool Driver::startInput(const ScriptCommand& command) {
    const std::string& name = command.name;
    const double x = m_.left + m_.session->width() / 2, y = m_.session->height() / 2;
    if (name == "orbit" || name == "pan") {
        const int mods = name == "pan" ? kShift : 0;
        input_.push(cursorAt(x, y));
        input_.push(press(Button::Left, true, mods));
        input_.push(cursorAt(x + numberOf(command, 0), y + numberOf(command, 1)));
        input_.push(press(Button::Left, false, mods));
    } else if (name == "dolly") {
        input_.push(cursorAt(x, y));
        input_.push({.type = Event::Type::Wheel, .y = numberOf(command, 0)});
    } else if (name == "key") {
        input_.push(keyEvent(keyOf(command), true));
        input_.push(keyEvent(keyOf(command), false));
    } else if (name == "hold") {
        input_.push(keyEvent(keyOf(command), true));
        wait_ = [this, until = viewer_.frames() + static_cast<uint64_t>(wholeOf(command, 1)),
                 k = keyOf(command)] {
            if (viewer_.frames() < until) return false;
            input_.push(keyEvent(k, false));
            return true;
        };
    } else if (name == "click") {
        input_.push(cursorAt(m_.left + wholeOf(command, 0), wholeOf(command, 1)));
        input_.push(press(Button::Left, true));
        input_.push(press(Button::Left, false));
    } else if (name == "press") {
        const Gui::Place place = placeOf(command, "@" + command.arguments[0]);
        input_.push(cursorAt(place.x, place.y));
        input_.push({.type = Event::Type::Redraw});
        input_.push(press(Button::Left, true));
        input_.push(press(Button::Left, false));
        waitFrames(4);
    } else if (name == "drop") {
        input_.push({.type = Event::Type::Drop, .files = {command.arguments[0]}});
    } else if (name == "hand") {
        startHand(command);
    } else {
        return false;
    }
    return true;
}

Gui::Place Driver::placeOf(const ScriptCommand& command, const std::string& word) const {
    double x = 0, y = 0;
    if (std::sscanf(word.c_str(), "@%lf,%lf", &x, &y) == 2) return {m_.left + x, y};
    std::string label = word.substr(1);
    std::replace(label.begin(), label.end(), '_', ' ');
    const std::optional<Gui::Place> place = viewer_.gui().controlAt(label);
    if (!place) fail(command, "no control '" + label + "' is to be seen");
    return *place;
}

// Its events have come once a frame has been drawn after its end.
void Driver::startHand(const ScriptCommand& command) {
    std::vector<std::string> words;
    for (const std::string& word : command.arguments) {
        if (word[0] != '@') {
            words.push_back(word);
            continue;
        }
        const Gui::Place place = placeOf(command, word);
        const PixelSize screen = viewer_.window().onScreen(place.x, place.y);
        words.push_back(std::to_string(screen.width));
        words.push_back(std::to_string(screen.height));
    }
    hand_.start(words);
    wait_ = [this, until = uint64_t{0}]() mutable {
        if (!hand_.done()) return false;
        if (until == 0) until = viewer_.frames() + 4;
        return viewer_.frames() >= until;
    };
}

void Driver::startFile(const ScriptCommand& command) {
    const std::filesystem::path file = command.arguments[0];
    if (command.name == "screenshot" || command.name == "save") {
        if (!isWritableImagePath(file))
            throw Error(ErrorKind::Argument, command.place + ": expected a .png or .exr file");
        viewer_.commands().save(file, command.name == "save");
        wait_ = [this, &command, file] {
            if (m_.saveProgress >= 0) return false;
            if (!std::filesystem::exists(file)) fail(command, viewer_.commands().lastError());
            return true;
        };
    } else if (command.name == "window") {
        wait_ = [this, file, until = viewer_.frames() + 2] {
            if (viewer_.frames() < until) return false;
            writeImage(file, toImage(viewer_.frame()));
            return true;
        };
    } else if (command.name == "copy") {
        std::error_code error;
        std::filesystem::copy_file(file, command.arguments[1],
                                   std::filesystem::copy_options::overwrite_existing, error);
        if (error) fail(command, error.message());
    }
}

void Driver::set(const ScriptCommand& command) {
    const std::string& what = command.arguments[0];
    PictureSettings& s = m_.settings;
    if (what == "depth") {
        s.maxDepth = std::max(wholeOf(command, 1), 0);
    } else if (what == "shadows") {
        s.shadows = onOff(command);
    } else if (what == "reflections") {
        s.reflections = onOff(command);
    } else if (what == "samples") {
        s.sampleLimit = std::max(wholeOf(command, 1), 1);
    } else if (what == "error") {
        s.until.error = std::max(numberOf(command, 1), 0.0);
    } else if (what == "exposure") {
        m_.display.exposure = std::clamp(numberOf(command, 1), -kMostExposure, kMostExposure);
    } else if (what == "tonemap" && named<ToneMap>(command.arguments[1])) {
        m_.display.toneMap = *named<ToneMap>(command.arguments[1]);
    } else if (what == "lens") {
        CameraControl& control = m_.control;
        control.setLens(numberOf(command, 1), control.camera().focusDistance);
        m_.touch();
    } else if (what == "glass" && named<TransmissiveShadows>(command.arguments[1])) {
        s.edits.transmissiveShadows = *named<TransmissiveShadows>(command.arguments[1]);
    } else if (what == "diffuse" && command.arguments.size() == 5) {
        std::vector<Material>& all = s.edits.materials;
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const Material& m) { return m.name == command.arguments[1]; });
        if (found == all.end()) fail(command, "there is no such material");
        Color diffuse;
        for (int c = 0; c < 3; ++c)
            diffuse[c] = std::clamp(numberOf(command, static_cast<size_t>(c) + 2), 0.0, 1.0);
        setDiffuse(*found, diffuse);
    } else if (what == "background" && command.arguments.size() == 4) {
        for (int c = 0; c < 3; ++c)
            s.background[c] = static_cast<float>(numberOf(command, static_cast<size_t>(c) + 1));
    } else if (what == "light" && command.arguments.size() == 3) {
        const int light = wholeOf(command, 1);
        if (light < 0 || static_cast<size_t>(light) >= s.lights.size())
            fail(command, "there is no such light");
        s.lights[static_cast<size_t>(light)].dim = static_cast<float>(numberOf(command, 2));
    } else {
        throw Error(ErrorKind::Argument,
                    command.place + ": cannot set '" + command.rest + "' (tests/view/script.cpp)");
    }
    viewer_.commands().takeSettings();
}

void Driver::startIdling(double seconds) {
    const auto processor = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
    wait_ = [this, processor, watch = Stopwatch(), frames = viewer_.frames(), before = processor(),
             seconds]() mutable {
        if (!idles_) {  // the rest begins when there is nothing left to trace
            if (!m_.session->rested()) return false;
            idles_ = true;
            watch.restart();
            frames = viewer_.frames();
            before = processor();
        }
        if (watch.seconds() < seconds) return false;
        char line[120];
        std::snprintf(line, sizeof(line), "idle: %.2f s, %llu frames, %.3f s of processor time",
                      watch.seconds(), static_cast<unsigned long long>(viewer_.frames() - frames),
                      processor() - before);
        out_ << line << std::endl;
        idles_ = false;
        return true;
    };
}

}  // namespace glint::view::test
