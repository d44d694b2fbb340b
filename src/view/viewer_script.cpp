// What a script does: the same events as a hand, and some looks behind the window.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <ostream>

#include "core/error.h"
#include "core/image_io.h"
#include "view/viewer.h"

namespace glint::view {

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

void Viewer::failScript(const ScriptCommand& command, const std::string& what) {
    throw Error(ErrorKind::Failed, command.place + ": " + command.name + ": " + what);
}

bool Viewer::settled() const {
    return !moving() && session_->finished() && !saving_.running() && !verifying_.running() &&
           !referring_.running() && !loading_.running() && !packing_.running() && !timeline_.playing() &&
           timeline_.time() == timeAtWork_ && same(model_.edits, editsAtWork_);
}

void Viewer::waitFrames(int frames) {
    const uint64_t until = frames_ + static_cast<uint64_t>(std::max(frames, 0));
    scriptWait_ = [this, until] { return frames_ >= until; };
}

// A command begins when the one before has been waited for and its events have been handled. A key that is
// held repeats itself: where frames are slow something of that waits in every round, and a command that
// releases the key would never begin.
void Viewer::runScript() {
    const auto repeats = [this](const Event& event) {
        return (event.type == Event::Type::Key && event.repeat) ||
               (event.type == Event::Type::Text && !held_.empty());
    };
    if (!std::all_of(queue_.begin(), queue_.end(), repeats)) return;
    if (scriptWait_) {
        if (!scriptWait_()) return;
        scriptWait_ = nullptr;
    }
    if (nextCommand_ < script_.size()) start(script_[nextCommand_++]);
}

void Viewer::start(const ScriptCommand& command) {
    const std::string& name = command.name;
    if (startInput(command) || startExpectation(command)) return;
    if (name == "wait") {
        waitFrames(wholeOf(command, 0));
    } else if (name == "settle") {
        scriptWait_ = [this] { return settled(); };
    } else if (name == "resize") {
        const PixelSize wanted = {wholeOf(command, 0), wholeOf(command, 1)};
        window_.resize(wanted);
        scriptWait_ = [this, wanted] {
            return window_.size() == wanted && session_->width() == wanted.width - left_;
        };
    } else if (name == "minimise") {
        window_.setMinimised(true);
        scriptWait_ = [this, left = wholeOf(command, 0)]() mutable {
            if (left-- > 0) return false;
            window_.setMinimised(false);
            return true;
        };
    } else if (name == "aov") {
        const std::optional<ViewLayer> layer = named<ViewLayer>(command.arguments[0]);
        if (!layer)
            throw Error(ErrorKind::Argument,
                        command.place + ": no such layer: '" + command.arguments[0] + "'");
        model_.settings.layer = *layer;
        takeSettings();
    } else if (name == "set") {
        set(command);
    } else if (name == "reload") {
        scriptWait_ = [this, before = reloads_] { return reloads_ > before; };
    } else if (name == "verify") {
        startVerifying();
        scriptWait_ = [this, &command] {
            if (verifying_.running()) return false;
            if (!model_.verdictPassed) failScript(command, model_.verdict);
            return true;
        };
    } else if (name == "pace") {
        startPace(wholeOf(command, 0));
    } else if (name == "idle") {
        startIdling(numberOf(command, 0));
    } else if (name == "lose-device") {
        throw gpu::DeviceLost("lose-device: as if VK_ERROR_DEVICE_LOST");
    } else if (name == "hints") {
        hinting_ = true;
    } else if (name == "stay") {
        scriptStays_ = true;
    } else {
        startFile(command);
    }
}

bool Viewer::startInput(const ScriptCommand& command) {
    const std::string& name = command.name;
    const double x = left_ + session_->width() / 2, y = session_->height() / 2;
    if (name == "orbit" || name == "pan") {
        const int mods = name == "pan" ? kShift : 0;
        push(cursorAt(x, y));
        push(press(Button::Left, true, mods));
        push(cursorAt(x + numberOf(command, 0), y + numberOf(command, 1)));
        push(press(Button::Left, false, mods));
    } else if (name == "dolly") {
        push(cursorAt(x, y));
        push({.type = Event::Type::Wheel, .y = numberOf(command, 0)});
    } else if (name == "key") {
        push(keyEvent(keyOf(command), true));
        push(keyEvent(keyOf(command), false));
    } else if (name == "hold") {
        push(keyEvent(keyOf(command), true));
        scriptWait_ = [this, until = frames_ + static_cast<uint64_t>(wholeOf(command, 1)),
                       k = keyOf(command)] {
            if (frames_ < until) return false;
            push(keyEvent(k, false));
            return true;
        };
    } else if (name == "click") {
        push(cursorAt(left_ + wholeOf(command, 0), wholeOf(command, 1)));
        push(press(Button::Left, true));
        push(press(Button::Left, false));
    } else if (name == "press") {
        const Gui::Place place = placeOf(command, "@" + command.arguments[0]);
        push(cursorAt(place.x, place.y));
        push({.type = Event::Type::Redraw});
        push(press(Button::Left, true));
        push(press(Button::Left, false));
        waitFrames(4);
    } else if (name == "drop") {
        push({.type = Event::Type::Drop, .files = {command.arguments[0]}});
    } else if (name == "hand") {
        startHand(command);
    } else {
        return false;
    }
    return true;
}

Gui::Place Viewer::placeOf(const ScriptCommand& command, const std::string& word) const {
    double x = 0, y = 0;
    if (std::sscanf(word.c_str(), "@%lf,%lf", &x, &y) == 2) return {left_ + x, y};
    std::string label = word.substr(1);
    std::replace(label.begin(), label.end(), '_', ' ');
    const std::optional<Gui::Place> place = gui_.controlAt(label);
    if (!place) failScript(command, "no control '" + label + "' is to be seen");
    return *place;
}

// Its events have come once a frame has been drawn after its end.
void Viewer::startHand(const ScriptCommand& command) {
    std::vector<std::string> words;
    for (const std::string& word : command.arguments) {
        if (word[0] != '@') {
            words.push_back(word);
            continue;
        }
        const Gui::Place place = placeOf(command, word);
        const PixelSize screen = window_.onScreen(place.x, place.y);
        words.push_back(std::to_string(screen.width));
        words.push_back(std::to_string(screen.height));
    }
    hand_.start(words);
    scriptWait_ = [this, until = uint64_t{0}]() mutable {
        if (!hand_.done()) return false;
        if (until == 0) until = frames_ + 4;
        return frames_ >= until;
    };
}

void Viewer::startFile(const ScriptCommand& command) {
    const std::filesystem::path file = command.arguments[0];
    if (command.name == "screenshot" || command.name == "save") {
        if (!isWritableImagePath(file))
            throw Error(ErrorKind::Argument, command.place + ": expected a .png or .exr file");
        startSaving(file, command.name == "save");
        scriptWait_ = [this, &command, file] {
            if (saving_.running()) return false;
            if (!std::filesystem::exists(file)) failScript(command, lastSaid_);
            return true;
        };
    } else if (command.name == "window") {
        scriptWait_ = [this, file, until = frames_ + 2] {
            if (frames_ < until) return false;
            writeImage(file, toImage(frame_));
            return true;
        };
    } else if (command.name == "copy") {
        std::error_code error;
        std::filesystem::copy_file(file, command.arguments[1],
                                   std::filesystem::copy_options::overwrite_existing, error);
        if (error) failScript(command, error.message());
    }
}

void Viewer::set(const ScriptCommand& command) {
    const std::string& what = command.arguments[0];
    PictureSettings& s = model_.settings;
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
        model_.display.exposure = std::clamp(numberOf(command, 1), -kMostExposure, kMostExposure);
    } else if (what == "tonemap" && named<ToneMap>(command.arguments[1])) {
        model_.display.toneMap = *named<ToneMap>(command.arguments[1]);
    } else if (what == "lens" || what == "focus") {
        const Camera& camera = control_.camera();
        control_.setLens(what == "lens" ? numberOf(command, 1) : camera.lensRadius,
                         what == "focus" ? numberOf(command, 1) : camera.focusDistance);
        touchMotion();
    } else if (what == "fov") {
        control_.zoom(numberOf(command, 1) / control_.camera().fovY);
        touchMotion();
    } else if (what == "glass" && named<TransmissiveShadows>(command.arguments[1])) {
        model_.edits.transmissiveShadows = *named<TransmissiveShadows>(command.arguments[1]);
    } else if (what == "diffuse" && command.arguments.size() == 5) {
        std::vector<Material>& all = model_.edits.materials;
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const Material& m) { return m.name == command.arguments[1]; });
        if (found == all.end()) failScript(command, "there is no such material");
        for (int c = 0; c < 3; ++c)
            found->diffuse[c] = std::clamp(numberOf(command, static_cast<size_t>(c) + 2), 0.0, 1.0);
    } else if (what == "background" && command.arguments.size() == 4) {
        for (int c = 0; c < 3; ++c)
            s.background[c] = static_cast<float>(numberOf(command, static_cast<size_t>(c) + 1));
    } else if (what == "light" && command.arguments.size() == 3) {
        const int light = wholeOf(command, 1);
        if (light < 0 || static_cast<size_t>(light) >= s.lights.size())
            failScript(command, "there is no such light");
        s.lights[static_cast<size_t>(light)].dim = static_cast<float>(numberOf(command, 2));
    } else {
        throw Error(ErrorKind::Argument,
                    command.place + ": cannot set '" + command.rest + "' (docs/guide/window.md)");
    }
    takeSettings();
}

void Viewer::startIdling(double seconds) {
    const auto processor = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
    scriptWait_ = [this, processor, watch = Stopwatch(), frames = frames_, before = processor(),
                   seconds]() mutable {
        if (!scriptIdles_) {  // the rest begins when there is nothing left to trace
            if (!session_->rested()) return false;
            scriptIdles_ = true;
            watch.restart();
            frames = frames_;
            before = processor();
        }
        if (watch.seconds() < seconds) return false;
        char line[120];
        std::snprintf(line, sizeof(line), "idle: %.2f s, %llu frames, %.3f s of processor time",
                      watch.seconds(), static_cast<unsigned long long>(frames_ - frames),
                      processor() - before);
        out_ << line << std::endl;
        scriptIdles_ = false;
        return true;
    };
}

void Viewer::startPace(int frames) {
    struct Run {
        std::vector<double> seconds;
        Stopwatch frame;
        uint64_t last = 0;
        int leastWidth = 1 << 30, leastHeight = 0;
    };
    auto run = std::make_shared<Run>();
    run->last = frames_;
    scriptWait_ = [this, run, frames] {
        if (frames_ != run->last) {
            run->last = frames_;
            run->seconds.push_back(run->frame.seconds());
            run->frame.restart();
            if (session_->facts().width < run->leastWidth) {
                run->leastWidth = session_->facts().width;
                run->leastHeight = session_->facts().height;
            }
        }
        if (static_cast<int>(run->seconds.size()) < frames) {
            control_.orbit(0.01745, 0);
            touchMotion();
            return false;
        }
        // The first frames find the pace, and compile.
        std::vector<double> s(run->seconds.begin() + frames / 4, run->seconds.end());
        std::sort(s.begin(), s.end());
        double sum = 0;
        for (double t : s) sum += t;
        char line[200];
        std::snprintf(line, sizeof(line),
                      "pace: %zu frames, %.1f frames/s, median %.1f ms, 95th percentile %.1f ms, now %d x %d "
                      "(least %d x %d)",
                      s.size(), static_cast<double>(s.size()) / sum, s[s.size() / 2] * 1e3,
                      s[s.size() * 95 / 100] * 1e3, session_->facts().width, session_->facts().height,
                      run->leastWidth, run->leastHeight);
        out_ << line << std::endl;
        return true;
    };
}

}  // namespace glint::view
