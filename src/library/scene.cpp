// Creates, loads, commits and describes scenes.
#include "import/load.h"
#include "library/handles.h"
#include "library/ray_reader.h"
#include "library/snapshot.h"
#include "library/status.h"

using namespace glint::library;

glint_status glint_scene_create(glint_device* device, glint_scene** scene) {
    return guarded("glint_scene_create", [&] {
        require(device != nullptr, "device is NULL");
        require(scene != nullptr, "scene is NULL");
        *scene = nullptr;
        *scene = new glint_scene(device);
    });
}

namespace {

// Parts of the load time: reading, then packing and building the BVH.
constexpr double kRead = 0.5, kCommitted = 0.99;

void load(const std::filesystem::path& path, const glint::Context& context, glint_scene& made) {
    context.checkCancelled();
    glint::LoadOptions options{.context = context.part(0, kRead)};
    if (const uint64_t most = made.device->settings.max_bytes) options.memory = most;
    made.draft = glint::loadScene(path, options);
    made.framed = false;
    made.loaded.push_back(context.charge(meshBytes(made.draft)));
    for (const glint::Object& object : made.draft.objects)
        made.added.push_back(object.transform.value_or(glint::Affine{}));
    commit(made, context.part(kRead, kCommitted));
}

}  // namespace

glint_status glint_scene_load(glint_device* device, const char* path, glint_scene** scene) {
    return glint_scene_load_with(device, path, nullptr, scene);
}

glint_status glint_scene_load_with(glint_device* device, const char* path, const glint_options* options,
                                   glint_scene** scene) {
    if (scene != nullptr) *scene = nullptr;
    return guarded([&] {
        require(device != nullptr, "glint_scene_load: device is NULL");
        require(path != nullptr, "glint_scene_load: path is NULL");
        require(scene != nullptr, "glint_scene_load: scene is NULL");
        auto made = std::make_unique<glint_scene>(device);
        const glint::Context context = contextOf(*device, options);
        load(path, context, *made);
        context.report(1);
        *scene = made.release();
    });
}

void glint_scene_retain(glint_scene* scene) {
    if (scene != nullptr) scene->owners.fetch_add(1, std::memory_order_relaxed);
}

void glint_scene_release(glint_scene* scene) {
    if (scene != nullptr && scene->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete scene;
}

glint_status glint_scene_commit(glint_scene* scene) {
    return guarded([&] {
        require(scene != nullptr, "glint_scene_commit: scene is NULL");
        commit(*scene, scene->device->context);
    });
}

glint_status glint_scene_commit_with(glint_scene* scene, const glint_options* options) {
    if (options == nullptr) return glint_scene_commit(scene);
    return guarded([&] {
        require(scene != nullptr, "glint_scene_commit_with: scene is NULL");
        const glint::Context context = contextOf(*scene->device, options);
        commit(*scene, context);
        context.report(1);
    });
}

glint_status glint_scene_prepare(const glint_scene* scene) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        if (snapshot->onDevice()) return snapshot->part().queries->prepare();
        snapshot->part().tracer();
    });
}

glint_status glint_scene_info_of(const glint_scene* scene, glint_scene_info* info) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        const glint::PackedScene& packed = snapshot->part().packed;
        glint_scene_info known{};
        known.geometries = static_cast<uint32_t>(snapshot->scene().objects.size());
        known.warnings = static_cast<uint32_t>(snapshot->warnings().size());
        known.triangles = snapshot->triangles();
        if (packed.boundsLo != packed.boundsHi) {
            for (int axis = 0; axis < 3; ++axis) {
                known.lower[axis] = packed.origin[axis] + static_cast<double>(packed.boundsLo[axis]);
                known.upper[axis] = packed.origin[axis] + static_cast<double>(packed.boundsHi[axis]);
            }
        }
        known.width = static_cast<uint32_t>(snapshot->scene().image.width);
        known.height = static_cast<uint32_t>(snapshot->scene().image.height);
        known.refits = snapshot->refits();
        writeStruct(info, known, "glint_scene_info_of: info");
    });
}

glint_status glint_scene_warning(const glint_scene* scene, uint32_t index, const char** text) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        require(text != nullptr, "glint_scene_warning: text is NULL");
        if (index >= snapshot->warnings().size())
            refuse("glint_scene_warning: there are " + std::to_string(snapshot->warnings().size()) +
                   " warnings");
        *text = snapshot->warnings()[index].c_str();
    });
}

glint_status glint_scene_find_material(const glint_scene* scene, const char* name, uint32_t* material) {
    return guarded("glint_scene_find_material", [&] {
        require(scene != nullptr, "scene is NULL");
        require(name != nullptr, "name is NULL");
        require(material != nullptr, "material is NULL");
        const auto& materials = scene->draft.materials;
        for (uint32_t i = 0; i < materials.size(); ++i) {
            if (materials[i].name != name) continue;
            *material = i;
            return;
        }
        refuse("there is no material \"" + std::string(name) + "\"");
    });
}
