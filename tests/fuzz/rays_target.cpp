// Lists of rays.
#include <sstream>

#include "app/ray_file.h"
#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace glint;
    std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
    fuzz::expectAnswer(ErrorKind::Scene, [&] { app::parseRays(text, "input"); });
    return 0;
}
