#include "view/history.h"

#include "view/camera_control.h"

namespace glint::view {

void CameraHistory::remember(const Camera& camera) {
    after_.clear();
    if (!before_.empty() && sameCamera(before_.back(), camera)) return;
    before_.push_back(camera);
    if (before_.size() > kMost) before_.erase(before_.begin());
}

std::optional<Camera> CameraHistory::undo(const Camera& now) {
    while (!before_.empty() && sameCamera(before_.back(), now)) before_.pop_back();
    if (before_.empty()) return std::nullopt;
    const Camera camera = before_.back();
    before_.pop_back();
    after_.push_back(now);
    return camera;
}

std::optional<Camera> CameraHistory::redo(const Camera& now) {
    if (after_.empty()) return std::nullopt;
    const Camera camera = after_.back();
    after_.pop_back();
    before_.push_back(now);
    return camera;
}

}  // namespace glint::view
