#include <unistd.h>

#include <csignal>
#include <iostream>

#include "app/cli.h"
#include "app/exit_code.h"

namespace {

// Until a command has something to save (installInterruptHandler), Ctrl-C and kill end the program at once.
extern "C" void quit(int) {
    constexpr char kMessage[] = "glint: interrupted\n";
    [[maybe_unused]] const auto ignored = write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1);
    _exit(static_cast<int>(glint::app::ExitCode::Interrupted));
}

// Signals that the parent process has set to be ignored (nohup) stay ignored.
void quitOn(int signal) {
    if (std::signal(signal, quit) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

int main(int argc, char** argv) {
    quitOn(SIGINT);
    quitOn(SIGTERM);
    return glint::app::run({argv + std::min(argc, 1), argv + argc}, std::cout, std::cerr);
}
