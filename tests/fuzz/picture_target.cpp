// Pictures of every kind.
#include "core/image_io.h"
#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace glint;
    constexpr uint64_t kMost = uint64_t{1} << 22;
    fuzz::expectAnswer(ErrorKind::Failed, [&] { decodeImage({data, size}, "input", kMost); });
    return 0;
}
