// Which program this is.
#pragma once

#include <string>

namespace glint::app {

// The commit that the program was built from, as git describes it ("unknown" outside a repository, unless its
// archive says it).
const char* builtCommit();

// Build configuration and Vulkan devices: lines "NAME: VALUE" without a final line end. Never throws.
std::string builtIn();

}  // namespace glint::app
