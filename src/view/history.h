// Undo and redo of the camera.
#pragma once

#include <optional>
#include <vector>

#include "scene/scene.h"

namespace glint::view {

class CameraHistory {
  public:
    // `camera` is where a movement begins; what had been undone is forgotten. Equal ones in a row count once.
    void remember(const Camera& camera);
    // The camera before or after `now`; empty if there is none.
    std::optional<Camera> undo(const Camera& now);
    std::optional<Camera> redo(const Camera& now);

    static constexpr size_t kMost = 100;

  private:
    std::vector<Camera> before_, after_;
};

}  // namespace glint::view
