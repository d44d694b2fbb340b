#include "core/interrupt.h"

#include <csignal>

#include <unistd.h>

#include <atomic>

namespace glint {
namespace {

std::atomic<bool> interruptFlag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only use lock-free atomics");

extern "C" void onInterrupt(int signal) {
    // _exit and not exit: only async-signal-safe functions may be called here (POSIX.1-2017, 2.4.3).
    if (interruptFlag.exchange(true) && signal == SIGINT) {
        _exit(128 + signal);  // as shells report it
    }
}

}  // namespace

void installInterruptHandler() {
    for (int signal : {SIGINT, SIGTERM}) {
        struct sigaction current {};
        sigaction(signal, nullptr, &current);
        if (current.sa_handler == SIG_IGN) {
            continue;
        }
        struct sigaction action {};
        action.sa_handler = onInterrupt;
        action.sa_flags = SA_RESTART;  // a write under way must not fail because of Ctrl-C
        sigemptyset(&action.sa_mask);
        sigaction(signal, &action, nullptr);
    }
}

bool interrupted() {
    return interruptFlag.load(std::memory_order_relaxed);
}

void clearInterrupt() {
    interruptFlag = false;
}

}  // namespace glint
