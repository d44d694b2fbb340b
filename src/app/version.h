// Which program this is.
#pragma once

#include <string>

namespace glint::app {

// The commit that the program was built from, as git describes it ("unknown" outside a repository, unless its
// archive says it).
const char* builtCommit();

// What was built in, and which devices Vulkan finds: lines "NAME: VALUE", without an end after the last.
// Never throws.
std::string builtIn();

}  // namespace glint::app
