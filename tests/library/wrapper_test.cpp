// glint.hpp: how its views read containers, and how long it keeps settings.
#include "support.h"  // first: its names and those of glint.hpp are ambiguous together

#include <glint/glint.hpp>
#include <span>

// A namespace of its own: glint's modules have other classes of the same names.
namespace glint::library::test::wrapper {
namespace {

using api::Device;
using api::Error;
using api::Out;
using api::Scene;
using api::Settings;
using api::View;

struct Corner {
    float x, y, z;
    uint32_t tag;
};

static_assert(!std::is_constructible_v<View<1>, std::vector<F3>&>, "three numbers are no scalar");
static_assert(!std::is_constructible_v<View<3>, std::vector<std::array<float, 2>>&>, "an element too short");
static_assert(!std::is_constructible_v<Out<3>, const std::vector<F3>&>, "outputs are written");

// The hits of two rays on a square that is given as a mesh of two triangles.
std::vector<double> depths(const View<3>& vertices, const View<3>& indices) {
    Scene scene{Device(selector())};
    scene.addTriangles(vertices, indices);
    scene.commit();
    const std::vector<double> origins = {0.25, 0.25, 5, 0.75, 0.75, 7};
    const std::array<double, 3> down = {0, 0, -1};
    std::vector<double> t(2);
    scene.closest({.origins = origins, .directions = down}, {.t = t});
    return t;
}

TEST(LibraryWrapper, FlatArraysAndStructsAreTheSameMesh) {
    const std::vector<float> flat = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::vector<Corner> corners = {{0, 0, 0, 9}, {1, 0, 0, 9}, {1, 1, 0, 9}, {0, 1, 0, 9}};
    const double builtIn[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<uint32_t> indices = {0, 1, 2, 0, 2, 3};
    const std::vector<double> expected = {5, 7};
    EXPECT_EQ(depths(flat, indices), expected);
    EXPECT_EQ(depths(std::span(flat), std::vector<U3>{{0, 1, 2}, {0, 2, 3}}), expected);
    EXPECT_EQ(depths(corners, indices), expected);
    EXPECT_EQ(depths(builtIn, indices), expected);
}

TEST(LibraryWrapper, FlatArraysCountElements) {
    std::vector<float> numbers(12);
    EXPECT_EQ(View<3>(numbers).raw.count, 4u);
    EXPECT_EQ(View<3>(numbers).raw.stride, 12);
    EXPECT_EQ(View<1>(numbers).raw.count, 12u);
    EXPECT_EQ(Out<4>(numbers).raw.count, 3u);
    numbers.push_back(0);
    EXPECT_THROW(View<3>{numbers}, Error);
    EXPECT_THROW(Out<3>{numbers}, Error);
}

// The caller's Settings are a temporary; the scene outlives the caller's Device.
TEST(LibraryWrapper, SettingsLiveAsLongAsScenes) {
    const auto lines = std::make_shared<std::vector<std::string>>();
    const auto open = [&] {
        Settings settings;
        settings.log = [lines](int, const std::string& text) { lines->push_back(text); };
        return Scene(Device(selector(), std::move(settings)));
    };
    {
        Scene scene = open();
        EXPECT_GT(lines.use_count(), 1);
        const size_t before = lines->size();
        scene.addTriangles(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
        scene.commit();
        EXPECT_GT(lines->size(), before);
    }
    EXPECT_EQ(lines.use_count(), 1);
}

// Assignment releases the memory of the old scene by its own callback.
TEST(LibraryWrapper, AnAssignedSceneReleasesMemoryByItsOwnSettings) {
    const auto bytes = std::make_shared<std::array<int64_t, 2>>();
    const auto make = [&](size_t index) {
        Settings settings;
        settings.memory = [bytes, index](int64_t more) {
            (*bytes)[index] += more;
            return true;
        };
        Scene scene(Device(selector(), std::move(settings)));
        scene.addTriangles(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
        scene.commit();
        return scene;
    };
    Scene scene = make(0);
    EXPECT_GT((*bytes)[0], 0);
    scene = make(1);
    EXPECT_EQ((*bytes)[0], 0);
    EXPECT_GT((*bytes)[1], 0);
}

}  // namespace
}  // namespace glint::library::test::wrapper
