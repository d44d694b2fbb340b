// Scenes and models: the whole way from the file to a scene that was checked. GLINT_FUZZ_INPUT is the file's
// name, GLINT_FUZZ_SCENE that of the scene to read, which may be another one that names it.
#include "import/load.h"
#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace glint;
    fuzz::write(GLINT_FUZZ_INPUT, {data, size});
    LoadOptions options;
    options.memory = uint64_t{64} << 20;
    fuzz::expectAnswer(ErrorKind::Scene, [&] { loadScene(fuzz::folder() / GLINT_FUZZ_SCENE, options); });
    return 0;
}
