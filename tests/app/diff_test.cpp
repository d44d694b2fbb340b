// `glint diff`: numbers from their definitions, exit codes 0 and 5, faults.
#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::diff_test {
class Diff : public FolderTest {
  protected:
    // a is 0 everywhere; b has the sample 0.5 in pixel (1, 0) and 0.25 in pixel (0, 1), both in the green
    // channel.
    void SetUp() override {
        Image a(2, 2, 3), b(2, 2, 3);
        b.at(1, 0, 1) = 0.5f;
        b.at(0, 1, 1) = 0.25f;
        writeImage("a.pfm", a);
        writeImage("b.pfm", b);
    }
};

TEST_F(Diff, EqualPictures) {
    const Ran ran = runGlint("diff b.pfm b.pfm");
    EXPECT_EQ(ran.out,
              "RMSE 0, PSNR inf dB, relMSE 0, SSIM -, max 0, mean 0\n"
              "0 of 4 pixels (0.0000 %) differ by more than 0, 0 not finite in one image only\n");
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
}

// RMSE = sqrt((0.5^2 + 0.25^2) / 12) = 0.161374; PSNR = 20 log10(1 / RMSE) = 15.84 dB; mean B - A = 0.75
// / 12; against black, relMSE = 100 RMSE^2. SSIM has windows of 11 x 11 pixels.
TEST_F(Diff, NumbersFollowTheirDefinitions) {
    const Ran ran = runGlint("diff a.pfm b.pfm");
    EXPECT_EQ(ran.out,
              "RMSE 0.161374, PSNR 15.84 dB, relMSE 2.604, SSIM -, max 0.5, mean 0.0625\n"
              "2 of 4 pixels (50.0000 %) differ by more than 0, 0 not finite in one image only\n"
              "  pixel 1,0: 0.5\n"
              "  pixel 0,1: 0.25\n");
    EXPECT_EQ(ran.code, 5);
    EXPECT_HAS(runGlint("diff b.pfm a.pfm").out, "mean -0.0625");
}

TEST_F(Diff, ToleranceDecidesTheExitCode) {
    EXPECT_EQ(runGlint("diff a.pfm b.pfm --tolerance 0.5").code, 0);
    const Ran ran = runGlint("diff a.pfm b.pfm --tolerance 0.25");
    EXPECT_EQ(ran.code, 5);
    EXPECT_HAS(ran.out, "1 of 4 pixels (25.0000 %) differ by more than 0.25");
}

TEST_F(Diff, DifferencePictureIsTheAbsoluteDifference) {
    const Ran ran = runGlint("diff b.pfm a.pfm -o d.pfm");
    EXPECT_EQ(ran.code, 5);
    EXPECT_HAS(ran.out, "wrote d.pfm\n");
    const Image d = readImage("d.pfm");
    EXPECT_EQ(d.at(1, 0, 1), 0.5f);
    EXPECT_EQ(d.at(0, 1, 1), 0.25f);
    EXPECT_EQ(d.at(0, 0, 0), 0.0f);
}

TEST_F(Diff, FaultsAreOneLine) {
    writeImage("c.pfm", Image(3, 2, 3));
    writeText("text.png", "not a picture");
    std::filesystem::create_directory("folder.png");
    const std::pair<std::string, std::string> cases[] = {
        {"c.pfm", "a.pfm, c.pfm: the images differ in size: 2x2 and 3x2"},
        {"no.png", "no.png: no such file"},
        {"folder.png", "folder.png: is a folder, not a file"},
        {"text.png", "text.png: not an image of a known kind (PNG, JPEG, EXR, PFM, HDR or WebP)"}};
    for (const auto& [file, line] : cases) expectError({"diff", "a.pfm", file, "-o", "d.png"}, 1, line);
    EXPECT_FALSE(std::filesystem::exists("d.png"));
}

}  // namespace glint::app::test::diff_test
