#include "view/view_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/available_memory.h"
#include "pack/primitives.h"
#include "pack/scene_arrays.h"

namespace glint::view {

namespace {

Loading withMemory(Loading loading) {
    loading.memory = availableMemory();
    return loading;
}

// Calls ball(centre, radius) for what `object` is made of. Of an instance there is nothing here.
void visitBalls(const PackedScene& p, uint32_t object, const KindPacker::VisitBall& ball) {
    visitPrimitiveArrays(p, [&](shared::PrimitiveKind kind, const auto& array) {
        for (uint32_t i = 0; i < array.size(); ++i) {
            if constexpr (requires { array[i].anchorNormal; })
                if (array[i].anchorNormal != glm::vec3(0)) continue;  // as good as endless
            uint32_t owner;
            if constexpr (requires { array[i].object; })
                owner = array[i].object;
            else
                owner = p.triangleSurfaces[i].object;
            if (owner == object) packerOf(kind).balls(p, i, ball);
        }
    });
}

}  // namespace

std::shared_ptr<const ViewScene> packViewScene(const std::filesystem::path& path, Scene scene,
                                               BuildQuality quality, TreeMemory* memory) {
    auto loaded = std::make_shared<ViewScene>();
    loaded->path = path;
    loaded->scene = std::move(scene);
    loaded->packed = packScene(loaded->scene, {quality, true, memory});
    for (const Material& m : loaded->scene.materials) loaded->also.mirrors |= m.mirror != Color(0);
    loaded->also.parallelCamera = loaded->also.thinLens = true;  // the panel may ask for them
    return loaded;
}

Ball boundsOf(const ViewScene& scene) {
    const PackedScene& p = scene.packed;
    if (p.environment.root != shared::kNone) {
        const glm::dvec3 lo(p.boundsLo), hi(p.boundsHi);
        // Even a single point needs a distance for the eye.
        return {p.origin + 0.5 * (lo + hi), std::max(0.5 * glm::length(hi - lo), 1e-6)};
    }
    const Camera& c = scene.scene.camera;
    return {c.target, 0.5 * glm::length(c.eye - c.target)};
}

Ball boundsOf(const ViewScene& scene, uint32_t object, const glm::dvec3& hit, double distance) {
    const PackedScene& p = scene.packed;
    Extent box;
    visitBalls(p, object, [&](const glm::dvec3& point, double radius) {
        box.include(point - radius);
        box.include(point + radius);
    });
    if (box.empty()) return {hit, std::max(0.1 * distance, 1e-6)};
    const glm::dvec3 center = box.center();
    double reach = 1e-6;
    visitBalls(p, object, [&](const glm::dvec3& point, double radius) {
        reach = std::max(reach, glm::length(point - center) + radius);
    });
    return {p.origin + center, reach};
}

Moments::Moments(const std::filesystem::path& path, const Loading& loading, std::optional<double> time)
    : path_(path),
      loading_(withMemory(loading)),
      reader_(path, loading_, time),
      time_(time),
      remembers_(reader_.scene().animation.has_value()) {}

Moment Moments::show(std::optional<double> time, const SceneEdits& edits, const SceneEdits& before) {
    if (time && time != time_) {
        moved_ = reader_.moveTo(*time) == SceneReader::Change::Scene || moved_;
        time_ = time;
    }
    auto file = std::make_shared<const Scene>(reader_.scene());
    Moment moment = {time_, file, edits, nullptr};
    moment.edits.follow(before, SceneEdits::of(*file));
    const bool kept =
        last_ && !moved_ && moment.edits == lastEdits_ &&
        (file->camera == last_->scene.camera || keepsArrays(last_->packed, last_->scene, file->camera));
    if (kept) return moment;
    // Trees are kept if the scene is shown again, not for one that is shown once.
    remembers_ = remembers_ || last_ != nullptr;
    Scene edited = *file;
    edited.materials = moment.edits.materials;
    edited.transmissiveShadows = moment.edits.transmissiveShadows;
    moment.scene = packViewScene(path_, std::move(edited), loading_.quality, remembers_ ? &memory_ : nullptr);
    moved_ = false;
    last_ = moment.scene;
    lastEdits_ = moment.edits;
    return moment;
}

// ---- the timeline ----

namespace {

constexpr double kNear = 1e-6;  // frames: keyframes are written in seconds, and seldom exactly

int whole(double frame) {
    return static_cast<int>(std::clamp(frame, 0.0, double{Timeline::kMostFrames}));
}

}  // namespace

void Timeline::follow(const std::optional<AnimationSpan>& span) {
    span_ = span;
    if (!span_) playing_ = false;
}

void Timeline::setTime(std::optional<double> time) {
    playing_ = false;
    time_ = time;
}

int Timeline::first() const {
    return span_ ? whole(std::floor(span_->start * rate() + kNear)) : 0;
}
int Timeline::last() const {
    return span_ ? std::max(whole(std::ceil(span_->end * rate() - kNear)), first()) : 0;
}
int Timeline::frame() const {
    return time_ ? whole(std::round(*time_ * rate())) : first();
}

void Timeline::play(double now) {
    if (!span_ || first() == last()) return;
    if (!time_ || frame() >= last() || frame() < first()) goTo(first());
    playing_ = true;
    position_ = *time_;
    since_ = now;
}

// A loop ends where it begins, so its last frame is left out: it is the first one, or is over at once.
bool Timeline::advance(double now) {
    if (!playing_) return false;
    position_ += now - std::exchange(since_, now);
    const double begin = first() / rate(), end = last() / rate();
    if (loops)
        position_ = begin + std::fmod(position_ - begin, std::max(end - begin, 1 / rate()));
    else if (position_ >= end)
        playing_ = false;
    const int frame = std::min(whole(std::floor(position_ * rate() + kNear)), last());
    return std::exchange(time_, frame / rate()) != frame / rate();
}

void Timeline::goTo(int frame) {
    if (!span_) return;
    setTime(std::clamp(frame, first(), last()) / rate());
}

void Timeline::step(int frames) {
    if (!time_) return goTo(frames > 0 ? first() : last());
    const double at = *time_ * rate();
    goTo(whole(frames > 0 ? std::floor(at + kNear) + frames : std::ceil(at - kNear) + frames));
}

// ---- names ----

std::string objectName(const Scene& scene, uint32_t object) {
    return object < scene.objects.size() ? scene.objects[object].name : "?";
}

std::string materialName(const Scene& scene, uint32_t material) {
    if (material >= scene.materials.size()) return "?";
    const std::string& name = scene.materials[material].name;
    return name.empty() ? "(no name)" : name;
}

}  // namespace glint::view
