#include "library/snapshot.h"

#include <set>
#include <utility>

#include "library/status.h"
#include "pack/scene_arrays.h"
#include "reference/render.h"
#include "scene/frame_model.h"
#include "scene/placement.h"
#include "scene/validate.h"

namespace glint::library {

std::vector<ObjectPlacement> placementsOf(const Scene& draft) {
    std::vector<ObjectPlacement> placements;
    for (const Object& object : draft.objects) {
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        placements.push_back({shape != nullptr ? shape->mesh : nullptr, object.transform});
    }
    return placements;
}

namespace {

uint64_t bytesOf(const PackedScene& packed) {
    uint64_t bytes = 0;
    visitArrays(packed, [&](const char*, const auto& array) { bytes += array.size() * sizeof(array[0]); });
    return bytes;
}

// Memory of packing: for each primitive its rows, its share of the nodes, its box, its source and two entries
// of the builder.
uint64_t packingBytes(const Scene& scene) {
    constexpr uint64_t kRows = 112, kBuilding = 176;
    std::set<const Mesh*> seen;
    uint64_t primitives = 0;
    for (const Object& object : scene.objects) {
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (shape == nullptr || seen.insert(shape->mesh.get()).second)
            primitives += shape == nullptr ? 1 : shape->mesh->corners.size();
    }
    return primitives * (kRows + kBuilding);
}

}  // namespace

Snapshot::Part::Part(const glint_device& device, const Context& context, const Scene& scene, bool split)
    : context_(device.context), charge_(context.charge(packingBytes(scene))), moving_(scene, split, context) {
    charge_ = {};
    charge_ = context.charge(bytesOf(packed));
    prepare(device);
}

Snapshot::Part::Part(const glint_device& device, const Part& other)
    : context_(device.context), charge_(context_.charge(bytesOf(other.packed))), moving_(other.moving_) {
    prepare(device);
}

void Snapshot::Part::prepare(const glint_device& device) {
    if (device.vulkan) queries = std::make_unique<render::RayQueries>(*device.vulkan, packed);
}

const reference::Tracer& Snapshot::Part::tracer() const {
    const std::lock_guard lock(tracerMutex_);
    if (!tracer_) {
        tracerCharge_ = context_.charge(2 * bytesOf(packed));  // the same in double
        tracer_ = std::make_unique<reference::Tracer>(packed);
    }
    return *tracer_;
}

bool Snapshot::Part::update(const glint_device& device, const Context& context, const Scene& scene,
                            const std::vector<bool>& moved) {
    tracer_ = nullptr;
    tracerCharge_ = {};
    if (!moving_.update(scene, moved, context)) return false;
    if (queries && !queries->update()) prepare(device);
    return true;
}

Snapshot::Snapshot(glint_device* device, const Context& context, Scene placed,
                   std::vector<ObjectPlacement> placements, uint64_t tree)
    : device_(device),
      scene_(std::move(placed)),
      placements_(std::move(placements)),
      tree_(tree),
      part_(*device, context, scene_, true) {
    warnings_ = scene_.warnings;
    warnings_.insert(warnings_.end(), part_.packed.warnings.begin(), part_.packed.warnings.end());
}

Snapshot::Snapshot(const Snapshot& other, glint_device* device)
    : device_(device),
      scene_(other.scene_),
      placements_(other.placements_),
      tree_(other.tree_),
      refits_(other.refits_),
      part_(*device, other.part_),
      warnings_(other.warnings_) {}

bool Snapshot::update(const Context& context, Scene placed, std::vector<ObjectPlacement> placements,
                      uint32_t refits) {
    counting_ = nullptr;
    certain_ = nullptr;
    renderer_ = nullptr;
    std::vector<bool> moved(placements.size());
    for (size_t i = 0; i < moved.size(); ++i) moved[i] = placements[i] != placements_[i];
    scene_ = std::move(placed);
    placements_ = std::move(placements);
    refits_ = refits;
    return part_.update(*device_, context, scene_, moved);
}

const Snapshot::Part& Snapshot::counting() const {
    if (!part_.packed.features.splitTriangles) return part_;
    const std::lock_guard lock(countingMutex_);
    if (!counting_) counting_ = std::make_unique<Part>(*device_, device_->context, scene_, false);
    return *counting_;
}

const reference::certain::Tracer& Snapshot::certain() const {
    const std::lock_guard lock(certainMutex_);
    if (!certain_) certain_ = std::make_unique<reference::certain::Tracer>(scene_, part_.packed);
    return *certain_;
}

uint64_t Snapshot::triangles() const {
    const PackStatistics& s = part_.packed.statistics;
    return part_.packed.triangles.size() - s.splitTriangles - s.prototypeTriangles + s.instancedTriangles;
}

Picture Snapshot::render(const Request& request) const {
    if (!device_->vulkan) return reference::render(part_.packed, request, device_->context);
    const std::lock_guard lock(pictureMutex_);
    if (!renderer_) {
        render::Options options;
        for (const NamedCamera& named : scene_.cameras) {
            const bool parallel = named.camera.projection == Projection::Orthographic;
            options.also.parallelCamera = options.also.parallelCamera || parallel;
            options.also.thinLens = options.also.thinLens || hasLens(named.camera);
        }
        renderer_ = std::make_unique<render::Renderer>(*device_->vulkan, part_.packed, options);
    }
    return renderer_->render(request);
}

std::shared_ptr<const Snapshot> Retired::owned(const std::shared_ptr<Retired>& retired,
                                               std::unique_ptr<Snapshot> snapshot) {
    // The constructor of shared_ptr calls the deleter if it throws.
    return std::shared_ptr<Snapshot>(
        snapshot.release(), [retired](Snapshot* last) { retired->put(std::unique_ptr<Snapshot>(last)); });
}

void Retired::put(std::unique_ptr<Snapshot> snapshot) {
    const std::lock_guard lock(mutex_);
    if (tree_ != 0 && snapshot->tree() == tree_) kept_.swap(snapshot);
}

std::unique_ptr<Snapshot> Retired::take(uint64_t tree) {
    const std::lock_guard lock(mutex_);
    tree_ = tree;
    if (kept_ && kept_->tree() != tree) kept_ = nullptr;
    return std::move(kept_);
}

void Retired::close() {
    const std::lock_guard lock(mutex_);
    tree_ = 0;
    kept_ = nullptr;
}

std::shared_ptr<const Snapshot> snapshotOf(const glint_scene* scene) {
    require(scene != nullptr, "scene is NULL");
    const std::lock_guard lock(scene->mutex);
    if (!scene->committed) refuse("the scene has not been committed: commit it first");
    return scene->committed;
}

namespace {

// `current` refitted to the placed scene; null if the BVH must be rebuilt.
std::unique_ptr<Snapshot> nextVersion(const Context& context, glint_scene& scene, const Snapshot& current,
                                      const Scene& placed, const std::vector<ObjectPlacement>& placements) {
    std::unique_ptr<Snapshot> next = scene.retired->take(current.tree());
    if (!next) next = std::make_unique<Snapshot>(current, scene.device.get());
    return next->update(context, placed, placements, current.refits() + 1) ? std::move(next) : nullptr;
}

void report(const glint_device& device, const Snapshot& committed) {
    if (device.settings.log == nullptr) return;
    for (const std::string& warning : committed.warnings()) logLine(device, GLINT_LOG_WARNING, warning);
    logLine(device, GLINT_LOG_INFO,
            "committed: " + std::to_string(committed.scene().objects.size()) + " geometries, " +
                std::to_string(committed.triangles()) + " triangles, trees " +
                (committed.refits() > 0 ? "kept" : "built"));
}

}  // namespace

void commit(glint_scene& scene, const Context& context) {
    Scene made = scene.draft;
    if (made.materials.empty()) made.materials.emplace_back().name = "default";
    if (scene.framed) frameModel(made);
    placeObjects(made);
    scene.framed ? validateFramedScene(made, "scene") : validateScene(made, "scene");
    const std::vector<ObjectPlacement> placements = placementsOf(scene.draft);
    std::unique_ptr<Snapshot> next;
    // Only the thread that changes the scene exchanges the pointer.
    if (scene.committed && !scene.grown)
        next = nextVersion(context, scene, *scene.committed, made, placements);
    if (!next) {
        scene.retired->close();
        next = std::make_unique<Snapshot>(scene.device.get(), context, std::move(made), placements,
                                          ++scene.trees);
    }
    scene.grown = false;
    auto snapshot = Retired::owned(scene.retired, std::move(next));
    const auto seen = snapshot;
    {
        const std::lock_guard lock(scene.mutex);
        scene.committed.swap(snapshot);
    }
    report(*scene.device, *seen);
}

}  // namespace glint::library

glint_scene::glint_scene(glint_device* usedDevice)
    : device(usedDevice), retired(std::make_shared<glint::library::Retired>()) {}
glint_scene::~glint_scene() {
    retired->close();
}
