// Drives a window by a script: one command a line, `#` starts a comment. A script makes the same events as a
// user; coordinates are pixels of the image.
//
//   wait N                 let N frames pass
//   settle                 wait until the image is finished, and saving, verifying and loading are done
//   orbit DX DY            drag from the middle of the window
//   key K                  press a key, named as in the list of keys
//   click X Y              pick a pixel
//   press CONTROL          click on a control of the panel, by its label, with _ for blanks
//   hand ARGUMENTS...      real mouse and keys: runs `xdotool ARGUMENTS` and waits for it;
//                          `@X,Y` is a pixel of the image and `@LABEL` a control
//   drop FILE...           drop files onto the window
//   resize W H             the window
//   minimise N             minimise the window for N rounds, then restore it
//   aov NAME               show a layer
//   set WHAT VALUE...      depth N, shadows on|off, reflections on|off, samples N, error E,
//                          exposure STOPS, tonemap NAME, lens RADIUS, background R G B,
//                          light I FACTOR, diffuse MATERIAL R G B, glass colored|full
//   screenshot FILE        render at the scene's own sampling, as Alt+S does, and wait
//   save FILE              save the shown image, as S does, and wait
//   window FILE            save the whole window, with the panel, as PNG
//   copy FROM TO           copy a file, to change a scene on disk
//   reload                 wait until a changed file is loaded or found invalid
//   idle SECONDS           do nothing, and print the numbers of frames and of rounds of the viewer's loop
//   lose-device            behave as if the device were lost
//   stay                   leave the window open at the end of the script
//   print WHAT             print a state: driver_state.cpp lists them
//   expect WHAT VALUE      check that WHAT prints as VALUE; toast, pick and fault must contain VALUE
//   await WHAT VALUE       wait until WHAT prints as VALUE; fails after a minute
#pragma once

#include <functional>
#include <future>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "view/commands.h"
#include "view/viewer.h"

namespace glint::view::test {

struct ScriptCommand {
    std::string name;
    std::vector<std::string> arguments;
    std::string rest;   // of the line after the name
    std::string place;  // "demo.txt:3"
};

std::vector<ScriptCommand> parseScript(const std::string& text, const std::string& name);

struct KeyPress {
    int key = 0;
    int mods = 0;
};

// A key by its name in keyBindings(), in any case. Empty for an unknown name.
std::optional<KeyPress> keyNamed(const std::string& name);

class Driver {
  public:
    // `stays`: the window closes by itself, not at the script's end.
    Driver(Viewer& viewer, std::vector<ScriptCommand> script, std::ostream& out, bool stays = false);

    // Steps the viewer until the script has ended, or with `stay` until the window is closed. Throws
    // Error(Failed) "PLACE: COMMAND: ..." where an expectation is not met.
    void run();

  private:
    void advance();
    void start(const ScriptCommand& command);
    bool startInput(const ScriptCommand& command);
    bool startExpectation(const ScriptCommand& command);
    bool startFile(const ScriptCommand& command);
    void startHand(const ScriptCommand& command);
    void set(const ScriptCommand& command);
    void startIdling(double seconds);
    void waitFrames(int frames);
    std::string stateOf(const ScriptCommand& command) const;
    glm::dvec2 placeOf(const ScriptCommand& command, const std::string& word) const;
    [[noreturn]] static void fail(const ScriptCommand& command, const std::string& what);

    Viewer& viewer_;
    Model& m_;
    const Input& input_;
    Window& window_;
    std::ostream& out_;
    std::vector<ScriptCommand> script_;
    size_t next_ = 0;
    uint64_t rounds_ = 0;         // of the viewer's loop
    std::function<bool()> wait_;  // of the command at hand: true once it is over
    bool stays_ = false, idles_ = false;
    std::future<int> hand_;
};

}  // namespace glint::view::test
