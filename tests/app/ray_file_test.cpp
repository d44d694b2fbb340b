// The CSV of `glint trace --rays`.
#include "app/ray_file.h"

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "support.h"

namespace glint::app::test::ray_file_test {
std::vector<WorldRay> parse(const std::string& text) {
    std::istringstream in(text);
    return parseRays(in, "r.csv");
}

std::string errorOf(const std::string& text) {
    return glint::test::errorOf(ErrorKind::Scene, [&] { parse(text); });
}

TEST(RayFile, SixToEightNumbers) {
    const auto rays = parse("1,2,3,4,5,6\n1,2,3,4,5,6,0.5\n1,2,3,4,5,6,-0.5,1e3\n");
    ASSERT_EQ(rays.size(), 3u);
    for (const WorldRay& ray : rays) {
        EXPECT_EQ(ray.origin, glm::dvec3(1, 2, 3));
        EXPECT_EQ(ray.direction, glm::dvec3(4, 5, 6));
    }
    EXPECT_EQ(rays[0].tMin, 0.0);
    EXPECT_TRUE(std::isinf(rays[0].tMax));
    EXPECT_EQ(rays[1].tMin, 0.5);
    EXPECT_TRUE(std::isinf(rays[1].tMax));
    EXPECT_EQ(rays[2].tMin, -0.5);
    EXPECT_EQ(rays[2].tMax, 1000.0);
}

TEST(RayFile, CommentsHeaderBlankLinesAndLineEnds) {
    const auto rays = parse(
        "# rays\r\n\r\nox,oy,oz,dx,dy,dz\r\n  1 ,\t2 , 3,4,5,6 # the first\r\n   "
        "\n#1,1,1,1,1,1\n+7,8,9,1e0,1E+0,-1.5");
    ASSERT_EQ(rays.size(), 2u);
    EXPECT_EQ(rays[0].origin, glm::dvec3(1, 2, 3));
    EXPECT_EQ(rays[1].origin, glm::dvec3(7, 8, 9));
    EXPECT_EQ(rays[1].direction, glm::dvec3(1, 1, -1.5));
}

TEST(RayFile, ByteOrderMark) {
    EXPECT_EQ(parse("\xef\xbb\xbf"
                    "1,2,3,4,5,6\n")
                  .size(),
              1u);
    EXPECT_EQ(parse("\xef\xbb\xbfox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n").size(), 1u);
}

TEST(RayFile, LinesOfMoreThan65536BytesAreRefused) {
    const std::string long1 = "1,2,3,4,5,6 #" + std::string(65536 - 13, 'x'), long2 = long1 + "x";
    EXPECT_EQ(parse(long1).size(), 1u);
    EXPECT_EQ(parse(long1 + "\n1,2,3,4,5,6\n" + long1 + "\n").size(), 3u);
    EXPECT_EQ(errorOf(long2), "r.csv:1: a line of more than 65536 bytes");
    EXPECT_EQ(errorOf("1,2,3,4,5,6\n" + long2 + "\n"), "r.csv:2: a line of more than 65536 bytes");
}

TEST(RayFile, EmptyFilesHoldNoRays) {
    for (const char* text : {"", "\n\n", "# nothing\n", "ox,oy,oz,dx,dy,dz,tmin,tmax\n", "\r\n"})
        EXPECT_TRUE(parse(text).empty());
}

TEST(RayFile, NotFiniteNumbersAreRead) {
    const auto rays = parse("nan,2,3,4,5,inf\n1,2,3,4,5,6,0,INF\n1,2,3,4,-inf,6,-nan\n");
    ASSERT_EQ(rays.size(), 3u);
    EXPECT_TRUE(std::isnan(rays[0].origin.x));
    EXPECT_TRUE(std::isinf(rays[0].direction.z));
    EXPECT_TRUE(std::isinf(rays[1].tMax));
    EXPECT_TRUE(std::isnan(rays[2].tMin));
}

TEST(RayFile, FaultsNameFileLineAndText) {
    const std::string form = "expected 6 to 8 numbers ox,oy,oz,dx,dy,dz[,tmin[,tmax]], got ";
    EXPECT_EQ(errorOf("1,2,3,4,5\n"), "r.csv:1: " + form + "5");
    EXPECT_EQ(errorOf("# c\n\n1,2,3,4,5,6\r\n1,2,3,4,5,6,7,8,9\r\n"), "r.csv:4: " + form + "9");
    EXPECT_EQ(errorOf("1 2 3 4 5 6\n"), "r.csv:1: " + form + "1");
    EXPECT_EQ(errorOf("1,2,3,4,5,6\n1,2,x,4,5,6\n"), "r.csv:2: expected a number, got \"x\"");
    EXPECT_EQ(errorOf("1,2,,4,5,6\n"), "r.csv:1: expected a number, got \"\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,6,\n"), "r.csv:1: expected a number, got \"\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,+-6\n"), "r.csv:1: expected a number, got \"+-6\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,++6\n"), "r.csv:1: expected a number, got \"++6\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,+\n"), "r.csv:1: expected a number, got \"+\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,0x10\n"), "r.csv:1: expected a number, got \"0x10\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,1e400\n"),
              "r.csv:1: number out of the range of double precision: \"1e400\"");
    EXPECT_EQ(errorOf("1,2,3,4,5,6\nox,oy,oz,dx,dy,dz\n"), "r.csv:2: expected a number, got \"ox\"");
    EXPECT_EQ(errorOf(std::string("1,2,3,4,5,6\0", 12) + "\n"), "r.csv:1: expected a number, got \"6?\"");
}

using RayFileOnDisk = SmallSceneTest;

TEST_F(RayFileOnDisk, FaultsLeaveStandardOutputEmpty) {
    writeText("r.csv", "0,0,5,0,0,-1\n0,0,5,0,0\n");
    std::filesystem::create_directory("rays");
    const std::pair<const char*, const char*> cases[] = {
        {"no.csv", "no.csv: no such file"},
        {"rays", "rays: is a folder, not a file of rays"},
        {"r.csv", "r.csv:2: expected 6 to 8 numbers ox,oy,oz,dx,dy,dz[,tmin[,tmax]], got 5"}};
    for (const auto& [file, line] : cases)
        expectError({"trace", "a.json", "--backend", "cpu", "--rays", file}, 3, line);
}

}  // namespace glint::app::test::ray_file_test
