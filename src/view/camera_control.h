// Moves a scene's camera the way a person does: around things, or through them.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "scene/scene.h"

namespace glint::view {

// What a camera can be aimed at.
struct Ball {
    glm::dvec3 center{0};
    double radius = 1;
};

enum class Side { Front, Right, Back, Left, Top, Bottom };

class CameraControl {
  public:
    explicit CameraControl(const Camera& home) : camera_(home), home_(home) {}

    const Camera& camera() const { return camera_; }
    void setHome(const Camera& home) { home_ = home; }  // the camera itself stays
    void reset() {
        camera_ = home_;
        upright_ = false;
    }

    // Radians; x to the right, y down, as the hand moves. The target stays, or with look the eye.
    void orbit(double x, double y);
    void look(double x, double y);
    // Parts of the picture's height: what is at the target's distance follows the hand.
    void pan(double x, double y);
    // Distance to the target times `factor`.
    void dolly(double factor);
    // Eye and target together, in units of the camera's frame: right, up, forward.
    void move(const glm::dvec3& distance);
    // Field of view times `factor`, from 1 to 170 degrees; a `window` grows and shrinks with it.
    void zoom(double factor);
    // Perspective, orthographic, then the oblique ones of both kinds, whose image plane stands upright, so
    // that walls do. What is at the target's distance keeps its size. Returns the new kind's name.
    std::string nextProjection();
    // All of `ball` in view, from the direction at hand or from a side.
    void frame(const Ball& ball);
    void view(Side side, const Ball& ball);

    double distance() const { return glm::length(camera_.target - camera_.eye); }

  private:
    glm::dvec3 right() const;
    glm::dvec3 upward() const;  // of the picture, not `up`
    bool parallel() const { return camera_.projection == Projection::Orthographic; }
    double halfHeight() const;  // of the picture: at distance 1, or anywhere with parallel rays
    void setHalfHeight(double half);
    void mendPlane();  // after a turn: keeps an oblique camera's plane where it can be
    glm::dvec3 turned(const glm::dvec3& arm, double x, double y) const;

    Camera camera_, home_;
    bool upright_ = false;  // the image plane follows the view direction
};

// The camera as a scene file writes it: "camera": {...}
std::string cameraJson(const Camera& camera);

}  // namespace glint::view
