// A process by a name that others on its host can look up: one that has ended is known at once there, without
// waiting for a lease.
#pragma once

#include <string>

namespace glint::farm {

// Without blanks. Start of the system, namespace of process numbers, number, and when it was started: nothing
// else ever has that name.
const std::string& nameOfThisProcess();
std::string processNamed(int number);

// True if that process was on this host, and has ended. False where that cannot be told.
bool hasEnded(const std::string& process);

}  // namespace glint::farm
