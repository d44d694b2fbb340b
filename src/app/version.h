// Which program this is.
#pragma once

namespace glint::app {

// The commit that the program was built from, as git describes it ("unknown" outside a repository).
const char* builtCommit();

}  // namespace glint::app
