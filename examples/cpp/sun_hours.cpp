// How many hours of sun a square between two towers gets: sun_hours [DEVICE]
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <glint/glint.hpp>
#include <numbers>
#include <vector>

using Point = std::array<double, 3>;

int main(int count, char** arguments) try {
    const glint::Device device(count > 1 ? arguments[1] : "");
    glint::Scene scene(device);
    scene.addJson(R"({"materials": {"wall": {"diffuse": [0.7, 0.7, 0.7]}},
                      "objects": [{"type": "box", "min": [-9, 0, -4], "max": [-5, 12, 4], "material": "wall"},
                                  {"type": "box", "min": [5, 0, -4], "max": [9, 12, 4], "material": "wall"}]})");
    scene.commit();

    // A row of points across the square. The sun moves from east to west, from six to six.
    std::vector<Point> points;
    for (int x = -4; x <= 4; x += 2) points.push_back({double(x), 0.01, 0});
    std::vector<double> hours(points.size());
    for (int quarter = 1; quarter < 48; ++quarter) {
        const double angle = quarter * std::numbers::pi / 48;
        const std::array<Point, 1> towardsSun = {{{std::cos(angle), std::sin(angle), 0}}};
        std::vector<std::uint8_t> shaded(points.size());
        scene.any({.origins = points, .directions = towardsSun}, shaded);
        for (std::size_t i = 0; i < points.size(); ++i) hours[i] += shaded[i] ? 0 : 0.25;
    }
    for (std::size_t i = 0; i < points.size(); ++i)
        std::printf("x = %2.0f: %.2f h\n", points[i][0], hours[i]);
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
