#include "view/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <nlohmann/json.hpp>

namespace glint::view {

namespace {

constexpr double kRadian = glm::pi<double>() / 180;
// The view direction keeps this far from `up`, where left and right would swap (and the camera's frame has no
// solution).
constexpr double kLeastPoleAngle = 0.5 * kRadian;

// Rodrigues' rotation about the unit axis k: v cos a + (k x v) sin a + k (k.v)(1 - cos a).
glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1 - c));
}

}  // namespace

glm::dvec3 CameraControl::right() const {
    return glm::normalize(glm::cross(camera_.target - camera_.eye, camera_.up));
}

glm::dvec3 CameraControl::upward() const {
    return glm::normalize(glm::cross(right(), camera_.target - camera_.eye));
}

double CameraControl::halfHeight() const {
    if (camera_.window) return 0.5 * std::abs(camera_.window->top - camera_.window->bottom);
    return std::tan(0.5 * camera_.fovY * kRadian);
}

// Turns `arm`, from one end of the view direction to the other: by `x` about `up`, and by `y` nearer to `up`,
// short of reaching it.
glm::dvec3 CameraControl::turned(const glm::dvec3& arm, double x, double y) const {
    const glm::dvec3 pole = glm::normalize(camera_.up);
    const double angle = std::acos(std::clamp(glm::dot(pole, glm::normalize(arm)), -1.0, 1.0));
    const double allowed = std::clamp(angle - y, kLeastPoleAngle, glm::pi<double>() - kLeastPoleAngle);
    // A positive turn about arm x pole takes the arm towards the pole.
    const glm::dvec3 axis = glm::normalize(glm::cross(arm, pole));
    return rotated(rotated(arm, axis, angle - allowed), pole, -x);
}

void CameraControl::orbit(double x, double y) {
    camera_.eye = camera_.target + turned(camera_.eye - camera_.target, x, y);
}

void CameraControl::look(double x, double y) {
    camera_.target = camera_.eye + turned(camera_.target - camera_.eye, x, -y);
}

void CameraControl::pan(double x, double y) {
    const double unit = 2 * halfHeight() * distance();
    const glm::dvec3 step = unit * (-x * right() + y * upward());
    camera_.eye += step;
    camera_.target += step;
}

void CameraControl::dolly(double factor) {
    camera_.eye = camera_.target + (camera_.eye - camera_.target) * factor;
}

void CameraControl::move(const glm::dvec3& distance) {
    const glm::dvec3 forward = glm::normalize(camera_.target - camera_.eye);
    const glm::dvec3 step = distance.x * right() + distance.y * upward() + distance.z * forward;
    camera_.eye += step;
    camera_.target += step;
}

void CameraControl::zoom(double factor) {
    if (camera_.window) {
        ViewWindow& w = *camera_.window;
        for (double* side : {&w.left, &w.right, &w.bottom, &w.top}) *side *= factor;
    } else {
        camera_.fovY = std::clamp(camera_.fovY * factor, 1.0, 170.0);
    }
}

// A ball of radius r fills a picture of half angle a from the distance r / sin a; a tenth more leaves a
// margin.
void CameraControl::frame(const Ball& ball) {
    const double sine = std::sin(std::atan(halfHeight()));
    const glm::dvec3 back = glm::normalize(camera_.eye - camera_.target);
    camera_.target = ball.center;
    camera_.eye = ball.center + back * (1.1 * ball.radius / sine);
}

void CameraControl::view(Side side, const Ball& ball) {
    // Right-handed, y up, front towards +z. From above and below the picture's top is -z and z.
    static constexpr double kOut[6][3] = {{0, 0, 1},  {1, 0, 0}, {0, 0, -1},
                                          {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    const double* out = kOut[static_cast<int>(side)];
    const glm::dvec3 direction(out[0], out[1], out[2]);
    camera_.target = ball.center;
    camera_.eye = ball.center + direction;
    camera_.up = {0, 1, 0};
    if (side == Side::Top || side == Side::Bottom) {
        // Not quite along `up`, so that orbiting can go on from there.
        camera_.eye = ball.center +
                      rotated(direction, {1, 0, 0}, side == Side::Top ? kLeastPoleAngle : -kLeastPoleAngle);
    }
    frame(ball);
}

std::string cameraJson(const Camera& camera) {
    const auto vector = [](const glm::dvec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    nlohmann::ordered_json json;
    json["type"] = "perspective";
    json["eye"] = vector(camera.eye);
    json["target"] = vector(camera.target);
    json["up"] = vector(camera.up);
    if (camera.window) {
        const ViewWindow& w = *camera.window;
        json["window"] = {w.left, w.right, w.bottom, w.top};
    } else {
        json["fovY"] = camera.fovY;
    }
    if (camera.nearT > 0) json["near"] = camera.nearT;
    if (std::isfinite(camera.farT)) json["far"] = camera.farT;
    return "\"camera\": " + json.dump();
}

}  // namespace glint::view
