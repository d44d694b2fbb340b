#include "view/moments.h"

#include <utility>

#include "core/available_memory.h"
#include "pack/camera_change.h"

namespace glint::view {

Moments::Moments(const std::filesystem::path& path, const Loading& loading, std::optional<double> time)
    : path_(path),
      loading_(loading),
      reader_(path, {loading.allowOutside, availableMemory(), loading.camera}, time),
      time_(time),
      remembers_(reader_.scene().animation.has_value()) {}

Moment Moments::packed(Moment moment) {
    const bool kept = last_ && !moved_ && same(moment.edits, lastEdits_) &&
                      (sameCamera(moment.file->camera, last_->scene.camera) ||
                       keepsArrays(last_->packed, last_->scene, moment.file->camera));
    if (kept) return moment;
    // Trees are kept for whoever asks for the scene again, not for one that is shown once.
    remembers_ = remembers_ || last_ != nullptr;
    moment.scene = packViewScene(path_, edited(*moment.file, moment.edits), loading_.quality,
                                 remembers_ ? &memory_ : nullptr);
    moved_ = false;
    last_ = moment.scene;
    lastEdits_ = moment.edits;
    return moment;
}

Moment Moments::show() {
    auto file = std::make_shared<const Scene>(withOverrides(reader_.scene(), loading_));
    Moment moment = {time_, file, SceneEdits::of(*file), nullptr};
    return packed(std::move(moment));
}

Moment Moments::show(std::optional<double> time, const SceneEdits& edits, const SceneEdits& before) {
    if (time && time != time_) {
        moved_ = reader_.moveTo(*time) == SceneReader::Change::Scene || moved_;
        time_ = time;
    }
    auto file = std::make_shared<const Scene>(withOverrides(reader_.scene(), loading_));
    Moment moment = {time_, file, edits, nullptr};
    moment.edits.follow(before, SceneEdits::of(*file));
    return packed(std::move(moment));
}

}  // namespace glint::view
