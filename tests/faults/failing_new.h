// An operator new that fails, for whoever is linked with failing_new.cpp. That stands alone: GCC 12 takes the
// free() in an operator delete that it inlines for a mistake.
#pragma once

#include <cstddef>

namespace glint::test {

// Of the allocations of at least so many bytes, in whichever thread, the next `after` succeed and the
// `faults` after them fail.
void failAllocations(size_t least, long after, long faults);
// How many were still to fail.
long stopFailing();

}  // namespace glint::test
