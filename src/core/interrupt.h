// Ctrl-C and kill: finish the slice at hand, save what there is, end with ErrorKind::Interrupted.
#pragma once

namespace glint {

// From this call on, SIGINT and SIGTERM only set a flag; long loops query it by interrupted(). A second
// SIGINT ends the process at once with exit code 130. Signals that the parent process ignores stay ignored
// (nohup, and background jobs of a shell script). A second call has no further effect.
void installInterruptHandler();

// True once SIGINT or SIGTERM has arrived. Cheap enough for an inner loop; callable from any thread.
bool interrupted();

// Forgets an interrupt that has arrived; meant for tests.
void clearInterrupt();

}  // namespace glint
