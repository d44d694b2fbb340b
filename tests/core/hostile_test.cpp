// Pictures that crashed, hung or bloated stb_image 2.27 and tinyexr 1.0.1, found by fuzzing and by hand: each
// is refused, and soon.
#include <chrono>

#include "core/image_io.h"
#include "support/support.h"

namespace glint::hostile_test {
namespace {

TEST(HostilePictures, AreRefused) {
    size_t count = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (const auto& entry :
         std::filesystem::directory_iterator(test::sourcePath("tests/hostile/pictures"))) {
        SCOPED_TRACE(entry.path().filename().string());
        const std::string message = test::errorOf(ErrorKind::Failed, [&] { readImage(entry.path()); });
        EXPECT_NE(message, "no error");
        ++count;
    }
    EXPECT_GE(count, 64u);
    // All of them in the time that one may take, ten times over for sanitizers and machines at work.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

}  // namespace
}  // namespace glint::hostile_test
