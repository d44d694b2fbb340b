#include "view/hand.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "core/error.h"

namespace glint::view {

namespace {

// Its exit code; -1 if it could not be started.
int runProgram(std::vector<std::string> words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    pid_t process = 0;
    if (posix_spawnp(&process, pointers[0], nullptr, nullptr, pointers.data(), environ) != 0) return -1;
    int status = 0;
    if (waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
    return WEXITSTATUS(status);
}

}  // namespace

void Hand::start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "xdotool");
    ended_ = std::async(std::launch::async, runProgram, std::move(arguments));
}

bool Hand::done() {
    if (!ended_.valid()) return true;
    if (ended_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    const int code = ended_.get();
    if (code == -1)
        throw Error(ErrorKind::Failed, "xdotool could not be run (Debian package xdotool, X11 alone)");
    if (code != 0) throw Error(ErrorKind::Failed, "xdotool ended with code " + std::to_string(code));
    return true;
}

}  // namespace glint::view
