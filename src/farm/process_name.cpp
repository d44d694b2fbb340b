#include "farm/process_name.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <sstream>

namespace glint::farm {

namespace {

struct State {
    char letter = '?';
    std::string start;  // clock ticks since the system's start; empty: not known
};

// proc_pid_stat(5): the name may hold anything, so what counts stands behind its last parenthesis.
State stateOf(const std::string& pid) {
    std::ifstream file("/proc/" + pid + "/stat");
    std::string text;
    std::getline(file, text, '\0');
    const size_t end = text.rfind(')');
    State state;
    if (end == std::string::npos) return state;
    std::istringstream rest(text.substr(end + 1));
    constexpr int kFieldsBetween = 18;  // state is field 3, starttime 22
    rest >> state.letter;
    std::string skipped;
    for (int i = 0; i < kFieldsBetween; ++i) rest >> skipped;
    rest >> state.start;
    return state;
}

// Empty if it cannot be told.
const std::string& thisSystem() {
    static const std::string name = [] {
        std::ifstream file("/proc/sys/kernel/random/boot_id");
        std::string boot;
        file >> boot;
        struct stat space {};
        if (boot.empty() || ::stat("/proc/self/ns/pid", &space) != 0) return std::string();
        return boot + "/" + std::to_string(space.st_ino);
    }();
    return name;
}

}  // namespace

std::string processNamed(int number) {
    const std::string pid = std::to_string(number);
    const std::string start = stateOf(pid).start;
    return (thisSystem().empty() || start.empty() ? "?" : thisSystem()) + "/" + pid + "/" + start;
}

const std::string& nameOfThisProcess() {
    static const std::string name = processNamed(::getpid());
    return name;
}

bool hasEnded(const std::string& process) {
    if (thisSystem().empty() || !process.starts_with(thisSystem() + "/")) return false;
    const std::string rest = process.substr(thisSystem().size() + 1);
    const size_t slash = rest.find('/');
    pid_t number = 0;
    const auto [last, error] =
        std::from_chars(rest.data(), rest.data() + std::min(slash, rest.size()), number);
    if (slash == std::string::npos || error != std::errc() || last != rest.data() + slash || number <= 0)
        return false;
    if (::kill(number, 0) != 0 && errno == ESRCH) return true;
    const State state = stateOf(rest.substr(0, slash));  // empty where others' processes are hidden
    return state.letter == 'Z' || state.letter == 'X' ||
           (!state.start.empty() && state.start != rest.substr(slash + 1));
}

}  // namespace glint::farm
