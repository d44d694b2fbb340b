#include "hand.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "core/error.h"

namespace glint::view::test {

namespace {

// Its exit code; -1 if it could not be started. It prints nothing.
int runProgram(std::vector<std::string> words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    pid_t process = 0;
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int error = posix_spawnp(&process, pointers[0], &files, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) return -1;
    int status = 0;
    if (waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
    return WEXITSTATUS(status);
}

// The second program's question is answered after the first one's events, on however busy a machine.
int runHand(std::vector<std::string> words) {
    const int code = runProgram(std::move(words));
    return code == 0 ? runProgram({"xdotool", "getmouselocation"}) : code;
}

}  // namespace

void Hand::start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "xdotool");
    ended_ = std::async(std::launch::async, runHand, std::move(arguments));
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

}  // namespace glint::view::test
