// Moves a scene's camera around things, or through them.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "scene/scene.h"

namespace glint::view {

// A sphere to aim a camera at.
struct Ball {
    glm::dvec3 center{0};
    double radius = 1;
};

enum class Side { Front, Right, Back, Left, Top, Bottom };

class CameraControl {
  public:
    // `radius`: of the scene; it bounds how near and how far dolly, zoom and frame may go.
    explicit CameraControl(const Camera& home, double radius = 1)
        : camera_(home), home_(home), radius_(radius) {}

    const Camera& camera() const { return camera_; }
    void set(const Camera& camera) {
        camera_ = camera;
        upright_ = false;
    }
    // The camera of a scene that has been loaded again. What the user has moved stays: the view as a whole,
    // and apart from it the lens.
    void follow(const Camera& home, double radius);
    void reset() { set(home_); }

    // Radians; x to the right, y down, as the hand moves. The target stays, or with look the eye.
    void orbit(double x, double y);
    void look(double x, double y);
    // Parts of the picture's height: what is at the target's distance follows the hand.
    void pan(double x, double y);
    // Distance to the target times `factor`, within kLeastReach..kGreatestReach of the scene's radius.
    void dolly(double factor);
    // Eye and target together, in units of the camera's frame: right, up, forward.
    void move(const glm::dvec3& distance);
    // Field of view times `factor`, from 1 to 170 degrees; a `window` grows and shrinks with it.
    void zoom(double factor);
    // Perspective, orthographic, then the oblique ones of both kinds, whose image plane stands upright, so
    // that walls do. What is at the target's distance keeps its size. Returns the new kind's name.
    std::string nextProjection();
    // All of `ball` in view, from the direction at hand or from a side. If the up direction of the scene's
    // camera is the x or the z axis, the sides follow that axis, else y.
    void frame(const Ball& ball);
    void view(Side side, const Ball& ball);
    // A thin lens (scene.h): radius >= 0, 0 for a pinhole; focus distance >= 0, 0 for the target's.
    void setLens(double radius, double focusDistance);
    // Sharp at `point` (world). False where that is not before the eye.
    bool focusAt(const glm::dvec3& point);

    static constexpr double kLeastReach = 1e-5, kGreatestReach = 1e4;  // radii of the scene

    double distance() const { return glm::length(camera_.target - camera_.eye); }

  private:
    glm::dvec3 right() const;
    glm::dvec3 upward() const;  // of the picture, not `up`
    bool parallel() const { return camera_.projection == Projection::Orthographic; }
    double halfHeight() const;  // of the picture: at distance 1, or anywhere with parallel rays
    void fixPlane();            // after a turn: keeps an oblique camera's plane valid
    glm::dvec3 turned(const glm::dvec3& arm, double x, double y) const;

    double reachable(double from, double wanted) const;

    Camera camera_, home_;
    double radius_ = 1;
    bool upright_ = false;  // the image plane follows the view direction
};

}  // namespace glint::view
