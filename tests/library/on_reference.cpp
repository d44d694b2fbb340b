#include "library/support.h"

const bool glint::library::test::kOnDevice = false;
