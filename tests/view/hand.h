// Real mouse and keyboard for scripts: the program xdotool moves them through the window system, so that
// what arrives is what a person's hand would send.
#pragma once

#include <future>
#include <string>
#include <vector>

namespace glint::view::test {

class Hand {
  public:
    // Runs `xdotool ARGUMENTS` beside the window.
    void start(std::vector<std::string> arguments);
    // True once it has ended. Throws Error(Failed) if it could not be started, or failed.
    bool done();

  private:
    std::future<int> ended_;
};

}  // namespace glint::view::test
