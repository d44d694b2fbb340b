// Pictures that crashed, hung or bloated stb_image 2.27 and tinyexr 1.0.1, found by fuzzing and by hand: each
// is refused.
#include "core/image_io.h"
#include "support/support.h"

namespace glint::hostile_test {
TEST(HostilePictures, AreRefused) {
    size_t count = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(test::sourcePath("tests/hostile/pictures"))) {
        SCOPED_TRACE(entry.path().filename().string());
        const std::string message = test::errorOf(ErrorKind::Failed, [&] { readImage(entry.path()); });
        EXPECT_NE(message, "no error");
        ++count;
    }
    EXPECT_GE(count, 64u);
}

}  // namespace glint::hostile_test
