// llvmpipe reads LP_NUM_THREADS once a process, so this runs the program itself.
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "support.h"
#include "support/support.h"

namespace glint::render::test::threads_test {
std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string renderWith(int threads, const std::string& scene, const std::filesystem::path& out) {
    std::ostringstream command;
    command << "LP_NUM_THREADS=" << threads << " \"" << GLINT_PROGRAM << "\" render \""
            << glint::test::sourcePath("scenes/" + scene + ".json")
            << "\" -q --size 96x72 --spp 2 --aov "
               "color,alpha,depth,position,normal,uv,object,primitive,bounces -o "
            << out;
    EXPECT_EQ(std::system(command.str().c_str()), 0) << command.str();
    return bytesOf(out);
}

TEST(Threads, PicturesDoNotDependOnTheirNumber) {
    const auto folder = std::filesystem::path(testing::TempDir());
    for (const std::string scene : {"spheres", "triangles", "knot"}) {
        const std::filesystem::path one = folder / (scene + "_threads1.exr"),
                                    eight = folder / (scene + "_threads8.exr");
        const std::string first = renderWith(1, scene, one), second = renderWith(8, scene, eight);
        EXPECT_GT(first.size(), 1000u) << scene;
        EXPECT_TRUE(first == second) << scene << ": " << one << " and " << eight << " differ";
        std::filesystem::remove(one);
        std::filesystem::remove(eight);
    }
}

}  // namespace glint::render::test::threads_test
