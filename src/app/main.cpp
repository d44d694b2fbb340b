#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "app/cli.h"

namespace {

// Only rank 0 prints.
volatile std::sig_atomic_t silent = 0;

// Until a command has something to save (installInterruptHandler), Ctrl-C and kill end the program at once.
extern "C" void quit(int) {
    constexpr char kMessage[] = "glint: interrupted\n";
    [[maybe_unused]] const auto ignored = silent ? 0 : write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1);
    _exit(static_cast<int>(glint::app::ExitCode::Interrupted));
}

// Signals that the parent process has set to be ignored (nohup) stay ignored.
void quitOn(int signal) {
    if (std::signal(signal, quit) == SIG_IGN) std::signal(signal, SIG_IGN);
}

// The next file that is opened, an image for example, would take the place of a stream that the caller has
// closed. With this, writing to that stream fails as on a full disk.
void fillClosedStreams() {
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
        if (::fcntl(fd, F_GETFD) >= 0) continue;
        [[maybe_unused]] const int opened =
            ::open(fd == STDOUT_FILENO ? "/dev/full" : "/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY);
    }
}

}  // namespace

int main(int argc, char** argv) {
    fillClosedStreams();
    silent = glint::app::rankOfLauncher() > 0;
    quitOn(SIGINT);
    quitOn(SIGTERM);
    // Writing beyond the limit of a file's size is then an error like a full disk, and has a message.
    std::signal(SIGXFSZ, SIG_IGN);
    return glint::app::run({argv + std::min(argc, 1), argv + argc}, std::cout, std::cerr);
}
