// Drives a window by a script (script.h), one command after the other.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hand.h"
#include "script.h"
#include "view/viewer.h"

namespace glint::view::test {

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
    void startFile(const ScriptCommand& command);
    void startHand(const ScriptCommand& command);
    void set(const ScriptCommand& command);
    void startIdling(double seconds);
    void waitFrames(int frames);
    std::string stateOf(const ScriptCommand& command) const;
    std::string stateOfImage(const ScriptCommand& command) const;
    std::string cameraNames() const;
    Gui::Place placeOf(const ScriptCommand& command, const std::string& word) const;
    [[noreturn]] static void fail(const ScriptCommand& command, const std::string& what);

    Viewer& viewer_;
    Model& m_;
    Input& input_;
    std::ostream& out_;
    std::vector<ScriptCommand> script_;
    size_t next_ = 0;
    std::function<bool()> wait_;  // of the command at hand: true once it is over
    bool stays_ = false, idles_ = false;
    Hand hand_;
};

}  // namespace glint::view::test
