#include "driver.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <ostream>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "core/format.h"
#include "core/image_io.h"
#include "core/text_file.h"

namespace glint::view::test {

std::vector<ScriptCommand> parseScript(const std::string& text, const std::string& name) {
    std::vector<ScriptCommand> commands;
    std::istringstream lines(text);
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        line = trimmed(line.substr(0, line.find('#')));
        if (line.empty()) continue;
        ScriptCommand command;
        command.place = name + ":" + std::to_string(number);
        std::istringstream words(line);
        words >> command.name;
        for (std::string word; words >> word;) command.arguments.push_back(word);
        command.rest = trimmed(line.substr(command.name.size()));
        commands.push_back(std::move(command));
    }
    return commands;
}

std::optional<KeyPress> keyNamed(const std::string& name) {
    const auto upper = [](std::string text) {
        for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        return text;
    };
    const std::string wanted = upper(name);
    for (const KeyBinding& b : keyBindings())
        if (b.run != nullptr && wanted == upper(b.name)) return KeyPress{b.key, b.mods};
    return std::nullopt;
}

Driver::Driver(Viewer& viewer, std::vector<ScriptCommand> script, std::ostream& out, bool stays)
    : viewer_(viewer),
      m_(viewer.model()),
      input_(viewer.input()),
      window_(viewer.window()),
      out_(out),
      script_(std::move(script)),
      stays_(stays) {}

namespace {

double numberOf(const ScriptCommand& command, size_t argument) {
    return std::stod(command.arguments.at(argument));
}
int wholeOf(const ScriptCommand& command, size_t argument) {
    return std::stoi(command.arguments.at(argument));
}

Event cursorAt(double x, double y) {
    return {.type = Event::Type::Cursor, .x = x, .y = y};
}

Event press(bool down) {
    return {.type = Event::Type::Button, .code = GLFW_MOUSE_BUTTON_LEFT, .down = down};
}

Event keyEvent(const KeyPress& k, bool down) {
    return {.type = Event::Type::Key, .code = k.key, .mods = k.mods, .down = down};
}

// As GLFW reports files that a file manager drops onto the window.
void drop(GLFWwindow* window, const std::vector<std::string>& files) {
    const GLFWdropfun dropped = glfwSetDropCallback(window, nullptr);
    glfwSetDropCallback(window, dropped);
    std::vector<const char*> names;
    for (const std::string& file : files) names.push_back(file.c_str());
    dropped(window, static_cast<int>(names.size()), names.data());
}

// Exit code of xdotool. The X server answers the second program after delivering the first one's events.
int runHand(const std::string& words) {
    return std::system(("xdotool" + words + " >/dev/null && xdotool getmouselocation >/dev/null").c_str());
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
        m_.warned |= !scripted && !stays_;  // the end of a script drops what is unsaved
        viewer_.setRestless(!idles_ && (scripted || script_.empty()));
        if (!scripted && !stays_ && !std::exchange(closed, true)) window_.push({.type = Event::Type::Close});
        ++rounds_;
    } while (viewer_.step());
    viewer_.close();
}

// A command starts after the one before it is over and its events are handled, but for repetitions of a held
// key: in slow frames the queue always holds one, and no command would release the key.
void Driver::advance() {
    const auto repeats = [this](const Event& event) {
        return (event.type == Event::Type::Key && event.repeat) ||
               (event.type == Event::Type::Text && input_.flies());
    };
    if (!std::all_of(window_.events.begin(), window_.events.end(), repeats)) return;
    if (wait_ && !wait_()) return;
    wait_ = nullptr;
    if (next_ < script_.size()) start(script_[next_++]);
}

void Driver::start(const ScriptCommand& command) {
    const std::string& name = command.name;
    if (startInput(command) || startExpectation(command) || startFile(command)) return;
    if (name == "wait") {
        waitFrames(wholeOf(command, 0));
    } else if (name == "settle") {
        wait_ = [this] { return settled(m_); };
    } else if (name == "resize") {
        const PixelSize wanted = {wholeOf(command, 0), wholeOf(command, 1)};
        glfwSetWindowSize(window_.handle(), wanted.width, wanted.height);  // X11: units are pixels
        wait_ = [this, wanted] {
            return window_.size() == wanted && m_.session->width() == wanted.width - m_.left;
        };
    } else if (name == "minimise") {
        glfwIconifyWindow(window_.handle());
        wait_ = [this, left = wholeOf(command, 0)]() mutable {
            if (left-- > 0) return false;
            glfwRestoreWindow(window_.handle());
            return true;
        };
    } else if (name == "aov") {
        m_.settings.layer = named<ViewLayer>(command.arguments.at(0)).value();
        takeSettings(m_);
    } else if (name == "set") {
        set(command);
    } else if (name == "reload") {
        wait_ = [this, before = m_.reloads] { return m_.reloads > before; };
    } else if (name == "idle") {
        startIdling(numberOf(command, 0));
    } else if (name == "lose-device") {
        viewer_.recover(gpu::DeviceLost("lose-device: as if VK_ERROR_DEVICE_LOST"));
    } else if (name == "stay") {
        stays_ = true;
    } else {
        fail(command, "no such command");
    }
}

bool Driver::startInput(const ScriptCommand& command) {
    const std::string& name = command.name;
    const double x = m_.left + m_.session->width() / 2, y = m_.session->height() / 2;
    if (name == "orbit") {
        window_.push(cursorAt(x, y));
        window_.push(press(true));
        window_.push(cursorAt(x + numberOf(command, 0), y + numberOf(command, 1)));
        window_.push(press(false));
    } else if (name == "key") {
        window_.push(keyEvent(keyNamed(command.arguments.at(0)).value(), true));
        window_.push(keyEvent(keyNamed(command.arguments.at(0)).value(), false));
    } else if (name == "click") {
        window_.push(cursorAt(m_.left + wholeOf(command, 0), wholeOf(command, 1)));
        window_.push(press(true));
        window_.push(press(false));
    } else if (name == "press") {
        const glm::dvec2 place = placeOf(command, "@" + command.arguments[0]);
        window_.push(cursorAt(place.x, place.y));
        window_.push({.type = Event::Type::Redraw});
        window_.push(press(true));
        window_.push(press(false));
        waitFrames(4);
    } else if (name == "drop") {
        drop(window_.handle(), command.arguments);
    } else if (name == "hand") {
        startHand(command);
    } else {
        return false;
    }
    return true;
}

glm::dvec2 Driver::placeOf(const ScriptCommand& command, const std::string& word) const {
    double x = 0, y = 0;
    if (std::sscanf(word.c_str(), "@%lf,%lf", &x, &y) == 2) return {m_.left + x, y};
    std::string label = word.substr(1);
    std::replace(label.begin(), label.end(), '_', ' ');
    const std::optional<glm::dvec2> place = viewer_.gui().controlAt(label);
    if (!place) fail(command, "no control '" + label + "' is to be seen");
    return *place;
}

// Its events have come once a frame has been drawn after its end.
void Driver::startHand(const ScriptCommand& command) {
    std::string words;
    for (const std::string& word : command.arguments) {
        words += ' ';
        if (word[0] != '@') {
            words += word;
            continue;
        }
        const glm::dvec2 place = placeOf(command, word);
        int left = 0, top = 0;
        glfwGetWindowPos(window_.handle(), &left, &top);
        words +=
            std::to_string(left + std::lround(place.x)) + " " + std::to_string(top + std::lround(place.y));
    }
    hand_ = std::async(std::launch::async, runHand, std::move(words));
    wait_ = [this, &command, until = uint64_t{0}]() mutable {
        if (until > 0) return viewer_.frames() >= until;
        if (hand_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
        if (hand_.get() != 0) fail(command, "xdotool failed (Debian package xdotool, X11 alone)");
        until = viewer_.frames() + 4;
        return false;
    };
}

bool Driver::startFile(const ScriptCommand& command) {
    const std::string& name = command.name;
    if (name != "screenshot" && name != "save" && name != "window" && name != "copy") return false;
    const std::filesystem::path file = command.arguments.at(0);
    if (name == "copy") {
        std::filesystem::copy_file(file, command.arguments.at(1),
                                   std::filesystem::copy_options::overwrite_existing);
    } else if (name == "window") {
        wait_ = [this, file, until = viewer_.frames() + 2] {
            if (viewer_.frames() < until) return false;
            writeImage(file, toImage(viewer_.frame()));
            return true;
        };
    } else {
        save(m_, file, name == "save");
        wait_ = [this, &command, file] {
            if (m_.saving.running()) return false;
            if (!std::filesystem::exists(file)) fail(command, m_.lastError);
            return true;
        };
    }
    return true;
}

void Driver::set(const ScriptCommand& command) {
    const std::string& what = command.arguments[0];
    const std::string& first = command.arguments.at(1);
    const auto colorFrom = [&](size_t at) {
        return Color(numberOf(command, at), numberOf(command, at + 1), numberOf(command, at + 2));
    };
    PictureSettings& s = m_.settings;
    std::vector<Material>& materials = s.edits.materials;
    const std::map<std::string, std::function<void()>> settings = {
        {"background", [&] { s.background = glm::vec3(colorFrom(1)); }},
        {"depth", [&] { s.maxDepth = wholeOf(command, 1); }},
        {"diffuse",
         [&] {
             const auto found = std::ranges::find(materials, first, &Material::name);
             if (found == materials.end()) fail(command, "there is no such material");
             setDiffuse(*found, colorFrom(2));
         }},
        {"error", [&] { s.until.error = numberOf(command, 1); }},
        {"exposure", [&] { m_.display.exposure = numberOf(command, 1); }},
        {"glass", [&] { s.edits.transmissiveShadows = named<TransmissiveShadows>(first).value(); }},
        {"lens",
         [&] {
             m_.control.setLens(numberOf(command, 1), m_.control.camera().focusDistance);
             m_.touch();
         }},
        {"light", [&] { s.lights.at(std::stoul(first)).dim = static_cast<float>(numberOf(command, 2)); }},
        {"reflections", [&] { s.reflections = first == "on"; }},
        {"samples", [&] { s.sampleLimit = wholeOf(command, 1); }},
        {"shadows", [&] { s.shadows = first == "on"; }},
        {"tonemap", [&] { m_.display.toneMap = named<ToneMap>(first).value(); }}};
    const auto setting = settings.find(what);
    if (setting == settings.end()) fail(command, "cannot be set");
    setting->second();
    takeSettings(m_);
}

void Driver::startIdling(double seconds) {
    wait_ = [this, watch = Stopwatch(), frames = viewer_.frames(), rounds = rounds_, seconds]() mutable {
        if (!idles_) {  // the rest begins when there is nothing left to trace
            if (!m_.session->finished()) return false;
            idles_ = true;
            watch.restart();
            frames = viewer_.frames();
            rounds = rounds_;
        }
        if (watch.seconds() < seconds) return false;
        out_ << format("idle: %.2f s, %llu frames, %llu rounds of the loop", watch.seconds(),
                       static_cast<unsigned long long>(viewer_.frames() - frames),
                       static_cast<unsigned long long>(rounds_ - rounds))
             << std::endl;
        idles_ = false;
        return true;
    };
}

}  // namespace glint::view::test
