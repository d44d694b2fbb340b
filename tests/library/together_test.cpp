// Scenes and devices of several threads in one process.
#include <thread>

#include "support.h"

namespace glint::library::test {
namespace {

using LibraryTogether = LibraryTest;

// As a program may that shows one scene while it loads another.
TEST_F(LibraryTogether, ScenesAreDrawnAtOnce) {
    const std::vector<std::string> names = {"spheres.json", "triangles.json", "knot.json"};
    const auto draw = [](const std::string& name, std::vector<std::array<float, 4>>& color) {
        glint_device* own = nullptr;
        glint_scene* scene = nullptr;
        color.assign(48 * 36, {});
        GLINT_INIT(glint_picture, picture);
        picture.width = 48;
        picture.height = 36;
        picture.samples = 1;
        picture.color = outOf(color);
        const bool drawn = glint_device_open(selector(), &own) == GLINT_OK &&
                           glint_scene_load(own, sceneFile(name).c_str(), &scene) == GLINT_OK &&
                           glint_render(scene, &picture, nullptr) == GLINT_OK;
        const std::string error = drawn ? "" : glint_last_error();
        glint_scene_release(scene);
        glint_device_release(own);
        return error;
    };
    std::vector<std::vector<std::array<float, 4>>> alone(names.size());
    for (size_t i = 0; i < names.size(); ++i) ASSERT_EQ(draw(names[i], alone[i]), "");
    EXPECT_NE(alone[0], alone[1]);
    std::vector<std::string> wrong(2 * names.size());
    {
        std::vector<std::jthread> threads;
        for (size_t thread = 0; thread < wrong.size(); ++thread) {
            threads.emplace_back([&, thread] {
                std::vector<std::array<float, 4>> color;
                for (int turn = 0; turn < 3 && wrong[thread].empty(); ++turn) {
                    wrong[thread] = draw(names[thread % names.size()], color);
                    if (color != alone[thread % names.size()]) wrong[thread] += "another picture";
                }
            });
        }
    }
    for (const std::string& what : wrong) EXPECT_EQ(what, "");
}

}  // namespace
}  // namespace glint::library::test
