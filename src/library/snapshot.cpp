#include "library/snapshot.h"

#include "library/status.h"
#include "reference/render.h"
#include "scene/frame_model.h"
#include "scene/placement.h"
#include "scene/validate.h"

namespace glint::library {

Snapshot::Part::Part(const glint_device& device, PackedScene scene)
    : packed(std::move(scene)), tracer(packed) {
    if (device.vulkan) queries = std::make_unique<render::RayQueries>(*device.vulkan, packed);
}

Snapshot::Snapshot(glint_device* device, Scene scene)
    : device_(device), scene_(std::move(scene)), part_(*device, packScene(scene_)) {
    warnings_ = scene_.warnings;
    warnings_.insert(warnings_.end(), part_.packed.warnings.begin(), part_.packed.warnings.end());
}

const Snapshot::Part& Snapshot::counting() const {
    if (!part_.packed.features.splitTriangles) return part_;
    const std::lock_guard lock(countingMutex_);
    if (!counting_)
        counting_ = std::make_unique<Part>(*device_, packScene(scene_, 0, BuildQuality::Default, false));
    return *counting_;
}

uint64_t Snapshot::triangles() const {
    const PackStatistics& s = part_.packed.statistics;
    return part_.packed.triangles.size() - s.splitTriangles - s.prototypeTriangles + s.instancedTriangles;
}

Picture Snapshot::render(const shared::Camera& camera, const Request& request) const {
    if (!(*device_).vulkan) return reference::render(part_.packed, camera, request);
    const std::lock_guard lock(pictureMutex_);
    if (!renderer_) {
        render::Options options;
        for (const NamedCamera& named : scene_.cameras) {
            const bool parallel = named.camera.projection == Projection::Orthographic;
            options.also.parallelCamera = options.also.parallelCamera || parallel;
            options.also.thinLens = options.also.thinLens || (!parallel && named.camera.lensRadius > 0);
        }
        renderer_ = std::make_unique<render::Renderer>(*(*device_).vulkan, part_.packed, options);
    }
    return renderer_->render(camera, request);
}

std::shared_ptr<const Snapshot> snapshotOf(const glint_scene* scene) {
    require(scene != nullptr, "scene is NULL");
    const std::lock_guard lock(scene->mutex);
    if (!scene->committed) refuse("the scene has not been committed: glint_scene_commit does it");
    return scene->committed;
}

void commit(glint_scene& scene) {
    Scene made = scene.draft;
    if (made.materials.empty()) made.materials.emplace_back().name = "default";
    if (scene.framed) frameModel(made);
    placeObjects(made);
    validateScene(made, "scene");
    auto snapshot = std::make_shared<const Snapshot>(scene.device, std::move(made));
    const std::lock_guard lock(scene.mutex);
    scene.committed.swap(snapshot);
}

}  // namespace glint::library
