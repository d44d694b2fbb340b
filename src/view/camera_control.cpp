#include "view/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <tuple>

#include "scene/cameras.h"
#include "scene/frame_model.h"

namespace glint::view {

namespace {

constexpr double kRadian = glm::pi<double>() / 180;
constexpr double kLeastFov = 1, kGreatestFov = 170;
// Between an oblique camera's view direction and its plane's normal: at 0.2 (78 degrees) things are drawn out
// to five times their size.
constexpr double kLeastPlaneCosine = 0.2;
// The view direction keeps this far from `up`, where left and right would swap (and the camera's frame has no
// solution).
constexpr double kLeastPoleAngle = 0.5 * kRadian;

// The axis that the scene's camera has as its up direction; y if that is no axis.
UpAxis upAxisOf(const Camera& home) {
    const glm::dvec3& up = home.up;
    if (up.x == 0 && up.y == 0 && up.z > 0) return UpAxis::Z;
    return up.x > 0 && up.y == 0 && up.z == 0 ? UpAxis::X : UpAxis::Y;
}

}  // namespace

void CameraControl::follow(const Camera& home, double radius) {
    const auto lensOf = [](auto& camera) { return std::tie(camera.lensRadius, camera.focusDistance); };
    const Camera mine = camera_;
    lensOf(camera_) = lensOf(home_);
    if (camera_ == home_) camera_ = home;
    lensOf(camera_) = lensOf(mine) == lensOf(home_) ? lensOf(home) : lensOf(mine);
    home_ = home;
    radius_ = radius;
}

void CameraControl::setLens(double radius, double focusDistance) {
    camera_.lensRadius = std::clamp(radius, 0.0, kGreatestReach * radius_);
    camera_.focusDistance = std::clamp(focusDistance, 0.0, kGreatestReach * radius_);
}

// The film lies at unit distance along the view direction. The plane in focus lies focusDistance times as far
// from the eye along the film's normal (scene.h).
bool CameraControl::focusAt(const glm::dvec3& point) {
    const CameraFrame frame = cameraFrame(camera_);
    const double distance = glm::dot(point - camera_.eye, frame.w) / glm::dot(frame.view, frame.w);
    if (!(distance > 0) || !std::isfinite(distance)) return false;
    camera_.focusDistance = distance;
    return true;
}

// `wanted`, limited to a range that follows from the scene's size. A distance beyond the range may stay.
double CameraControl::reachable(double from, double wanted) const {
    return std::clamp(wanted, std::min(from, kLeastReach * radius_),
                      std::max(from, kGreatestReach * radius_));
}

glm::dvec3 CameraControl::right() const {
    return glm::normalize(glm::cross(camera_.target - camera_.eye, camera_.up));
}

glm::dvec3 CameraControl::upward() const {
    return glm::normalize(glm::cross(right(), camera_.target - camera_.eye));
}

double CameraControl::halfHeight() const {
    if (camera_.window) return 0.5 * std::abs(camera_.window->top - camera_.window->bottom);
    return parallel() ? 0.5 * camera_.height : std::tan(0.5 * camera_.fovY * kRadian);
}

// An image plane that the view direction all but lies in has no picture. The upright plane under the view
// direction has one unless the camera looks straight up or down.
void CameraControl::fixPlane() {
    if (!camera_.planeNormal) return;
    const glm::dvec3 forward = glm::normalize(camera_.target - camera_.eye);
    const glm::dvec3 pole = glm::normalize(camera_.up);
    if (upright_ || std::abs(glm::dot(glm::normalize(*camera_.planeNormal), forward)) < kLeastPlaneCosine) {
        const glm::dvec3 level = forward - glm::dot(forward, pole) * pole;
        camera_.planeNormal = glm::length(level) < kLeastPlaneCosine ? forward : -level;
    }
}

std::string CameraControl::nextProjection() {
    // The size of the image at the target's distance stays.
    const double half = parallel() ? halfHeight() : halfHeight() * distance();
    const bool oblique = camera_.planeNormal.has_value() != parallel();  // of the next one
    camera_.window.reset();
    camera_.projection = parallel() ? Projection::Perspective : Projection::Orthographic;
    camera_.height = 2 * half;
    camera_.fovY = std::clamp(2 * std::atan(half / distance()) / kRadian, kLeastFov, kGreatestFov);
    upright_ = oblique;
    camera_.planeNormal = oblique ? std::optional<glm::dvec3>(camera_.eye - camera_.target) : std::nullopt;
    fixPlane();
    return std::string(oblique ? "oblique " : "") + (parallel() ? "orthographic" : "perspective");
}

// Turns `arm`, from one end of the view direction to the other: by `x` about `up`, and by `y` nearer to `up`,
// short of reaching it.
glm::dvec3 CameraControl::turned(const glm::dvec3& arm, double x, double y) const {
    const glm::dvec3 pole = glm::normalize(camera_.up);
    const double angle = std::acos(std::clamp(glm::dot(pole, glm::normalize(arm)), -1.0, 1.0));
    const double allowed = std::clamp(angle - y, kLeastPoleAngle, glm::pi<double>() - kLeastPoleAngle);
    // A positive turn about arm x pole takes the arm towards the pole.
    const glm::dvec3 axis = glm::normalize(glm::cross(arm, pole));
    return glm::angleAxis(-x, pole) * (glm::angleAxis(angle - allowed, axis) * arm);
}

void CameraControl::orbit(double x, double y) {
    camera_.eye = camera_.target + turned(camera_.eye - camera_.target, x, y);
    fixPlane();
}

void CameraControl::look(double x, double y) {
    camera_.target = camera_.eye + turned(camera_.target - camera_.eye, x, -y);
    fixPlane();
}

void CameraControl::pan(double x, double y) {
    const double unit = 2 * halfHeight() * (parallel() ? 1 : distance());
    const glm::dvec3 step = unit * (-x * right() + y * upward());
    camera_.eye += step;
    camera_.target += step;
}

void CameraControl::dolly(double factor) {
    if (parallel()) {  // the eye's distance changes nothing but what lies behind the image plane
        zoom(factor);
        return;
    }
    const double from = distance();
    camera_.eye = camera_.target + (camera_.eye - camera_.target) * (reachable(from, from * factor) / from);
}

void CameraControl::move(const glm::dvec3& distance) {
    const glm::dvec3 forward = glm::normalize(camera_.target - camera_.eye);
    const glm::dvec3 step = distance.x * right() + distance.y * upward() + distance.z * forward;
    camera_.eye += step;
    camera_.target += step;
}

void CameraControl::zoom(double factor) {
    // Half the picture's height: a tangent, or with parallel rays a length.
    const double from = halfHeight();
    const double least = std::tan(0.5 * kLeastFov * kRadian), most = std::tan(0.5 * kGreatestFov * kRadian);
    const double to = parallel() ? reachable(from, from * factor)
                                 : std::clamp(from * factor, std::min(from, least), std::max(from, most));
    if (camera_.window) {
        ViewWindow& w = *camera_.window;
        for (double* side : {&w.left, &w.right, &w.bottom, &w.top}) *side *= to / from;
    } else if (parallel()) {
        camera_.height = 2 * to;
    } else {
        camera_.fovY = std::clamp(camera_.fovY * factor, kLeastFov, kGreatestFov);
    }
}

// A ball of radius r fills a picture of half angle a from the distance r / sin a; a tenth more leaves a
// margin. Parallel rays need the height alone, and an image plane in front of the ball.
void CameraControl::frame(const Ball& ball) {
    const glm::dvec3 back = glm::normalize(camera_.eye - camera_.target);
    camera_.target = ball.center;
    if (parallel()) {
        zoom(1.1 * ball.radius / halfHeight());
        camera_.eye = ball.center + back * (3 * ball.radius);
    } else {
        camera_.eye = ball.center + back * (1.1 * ball.radius / std::sin(std::atan(halfHeight())));
    }
}

void CameraControl::view(Side side, const Ball& ball) {
    // Right-handed, y up, front towards +z. From above and below, the top of the image is -z and z.
    static constexpr double kOut[6][3] = {{0, 0, 1},  {1, 0, 0}, {0, 0, -1},
                                          {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    const double* out = kOut[static_cast<int>(side)];
    const UpAxis up = upAxisOf(home_);
    glm::dvec3 direction(out[0], out[1], out[2]);
    // Not quite along `up`, so that orbiting can go on from there.
    direction = glm::angleAxis(out[1] * kLeastPoleAngle, glm::dvec3(1, 0, 0)) * direction;
    camera_.target = ball.center;
    camera_.eye = ball.center + fromYUp(direction, up);
    camera_.up = fromYUp({0, 1, 0}, up);
    frame(ball);
    fixPlane();
}

}  // namespace glint::view
