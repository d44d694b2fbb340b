#include "script.h"

#include <cctype>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/file_io.h"
#include "view/keys.h"

namespace glint::view::test {

namespace {

constexpr size_t kAny = 100;

struct ScriptWord {
    const char* name;
    const char* form;  // of the arguments
    size_t least, most;
    const char* help;
};

constexpr ScriptWord kWords[] = {
    {"wait", "N", 1, 1, "let N frames pass"},
    {"settle", "", 0, 0, "until the picture is finished, and saving, verifying and loading are done"},
    {"orbit", "DX DY", 2, 2, "drag with the left button from the middle of the window, in pixels"},
    {"pan", "DX DY", 2, 2, "the same with Shift"},
    {"dolly", "STEPS", 1, 1, "turn the wheel; positive is nearer"},
    {"key", "K", 1, 1, "press and release a key, named as in the list of keys"},
    {"hold", "K N", 2, 2, "hold a key for N frames"},
    {"click", "X Y", 2, 2,
     "click there: pixels from the top left corner; prints what `glint trace --pixel` prints"},
    {"press", "CONTROL", 1, 1, "click on a control of the panel, by its label"},
    {"hand", "ARGUMENTS...", 1, kAny,
     "the real mouse and keys: runs `xdotool ARGUMENTS`, where `@X,Y` is a pixel of the picture and `@LABEL` "
     "a "
     "control of the panel, and waits for it"},
    {"drop", "FILE", 1, 1, "drop a file onto the window"},
    {"resize", "W H", 2, 2, "the window"},
    {"minimise", "N", 1, 1, "minimise the window for N rounds, then restore it"},
    {"aov", "NAME", 1, 1, "show a layer: color depth normal uv object primitive material bounces cost"},
    {"set", "WHAT VALUE...", 2, 5,
     "depth N, shadows on|off, reflections on|off, samples N, error E, exposure STOPS, tonemap NAME, "
     "lens RADIUS, background R G B, light I FACTOR, diffuse MATERIAL R G B, "
     "glass colored|full"},
    {"screenshot", "FILE", 1, 1,
     "render the view at the scene's own sampling, as Alt+S does, and wait for it; .png or .exr"},
    {"save", "FILE", 1, 1, "save what is seen, as S does, and wait for it; .png or .exr"},
    {"window", "FILE", 1, 1, "save what the window shows, panel and all, as PNG"},
    {"copy", "FROM TO", 2, 2, "copy a file, to change a scene on disk"},
    {"reload", "", 0, 0, "until a changed file has been noticed and loaded, or found to be at fault"},
    {"verify", "", 0, 0, "check the view as V does, and wait; fails if it does not pass"},
    {"idle", "SECONDS", 1, 1,
     "do nothing for a while, and print how many frames and how much processor time that took"},
    {"lose-device", "", 0, 0, "behave as if the device had been lost"},
    {"stay", "", 0, 0, "leave the window open at the end of the script"},
    {"print", "WHAT", 1, 2,
     "print something that `expect` knows: aim, built, camera, cameras, control LABEL, covered, difference, "
     "error, exposure, fault (of the scene's file), figures, focus, fov, hints, layer, object (picked), "
     "pick, picture, pixel, playing, progress, rate, samples, scroll, size, submissions, time, tip, toast, "
     "tonemap, tree, depth, verdict, waiting, warnings"},
    {"expect", "WHAT VALUE...", 2, kAny, "it prints as VALUE; of toast, pick and fault, it holds VALUE"},
    {"await", "WHAT VALUE...", 2, kAny, "until it prints as VALUE; fails after a minute"},
};

const ScriptWord* wordNamed(const std::string& name) {
    for (const ScriptWord& word : kWords) {
        if (name == word.name) return &word;
    }
    return nullptr;
}

std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

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
        const ScriptWord* known = wordNamed(command.name);
        if (known == nullptr)
            throw Error(ErrorKind::Argument, command.place + ": unknown command '" + command.name +
                                                 "' (tests/view/script.cpp lists all)");
        const size_t given = command.arguments.size();
        if (given < known->least || given > known->most)
            throw Error(ErrorKind::Argument, command.place + ": expected '" +
                                                 trimmed(std::string(known->name) + " " + known->form) + "'");
        commands.push_back(std::move(command));
    }
    return commands;
}

std::vector<ScriptCommand> readScript(const std::filesystem::path& file) {
    const std::vector<uint8_t> bytes = readFile(file);
    return parseScript(std::string(bytes.begin(), bytes.end()), file.string());
}

double numberOf(const ScriptCommand& command, size_t argument) {
    const std::string& text = command.arguments.at(argument);
    try {
        size_t used = 0;
        const double value = std::stod(text, &used);
        if (used == text.size() && std::isfinite(value)) return value;
    } catch (const std::exception&) {  // said below
    }
    throw Error(ErrorKind::Argument, command.place + ": expected a number, got '" + text + "'");
}

int wholeOf(const ScriptCommand& command, size_t argument) {
    const double value = numberOf(command, argument);
    if (value != std::floor(value) || std::abs(value) > 1e6)
        throw Error(ErrorKind::Argument,
                    command.place + ": expected a whole number, got '" + command.arguments[argument] + "'");
    return static_cast<int>(value);
}

std::optional<KeyPress> keyNamed(const std::string& name) {
    const auto upper = [](std::string text) {
        for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        return text;
    };
    const std::string wanted = upper(name);
    for (const KeyBinding& b : keyBindings())
        if (wanted == upper(b.name)) return KeyPress{b.key, b.mods};
    if (wanted.size() == 1 && isFlyKey(wanted[0])) return KeyPress{wanted[0], 0};
    return std::nullopt;
}

}  // namespace glint::view::test
