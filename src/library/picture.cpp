// Renders into the caller's buffers.
#include <algorithm>
#include <cmath>
#include <utility>

#include "converge/converge.h"
#include "core/error.h"
#include "core/text_file.h"
#include "library/ray_reader.h"
#include "library/snapshot.h"
#include "library/status.h"
#include "library/views.h"
#include "pack/pack_samples.h"
#include "reference/sensitivity.h"
#include "scene/cameras.h"
#include "scene/limits.h"
#include "scene/sampling.h"
#include "scene/validate.h"

namespace glint::library {

namespace {

using glm::dvec3;

int atMost(int most, uint32_t given, const char* what) {
    if (given > static_cast<uint32_t>(most))
        refuse(std::string("glint_render: picture.") + what + " must be at most " + std::to_string(most) +
               ", but is " + std::to_string(given));
    return static_cast<int>(given);
}

ImageSettings settingsOf(const glint_picture& picture, const Scene& scene) {
    ImageSettings image = scene.image;
    if (picture.width > 0) image.width = atMost(kMaxImageSize, picture.width, "width");
    if (picture.height > 0) image.height = atMost(kMaxImageSize, picture.height, "height");
    if (picture.samples > 0) {
        image.samplesPerPixel = atMost(kMaxSamplesPerPixel, picture.samples, "samples");
        image.adaptive.reset();
    }
    const std::string wrong = samplingConflict(image);
    if (!wrong.empty()) refuse("glint_render: " + wrong);
    return image;
}

dvec3 threeOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

Camera cameraNamed(const std::string& name, const Scene& scene) {
    for (const NamedCamera& known : scene.cameras)
        if (known.name == name) return known.camera;
    const std::string names = cameraNames(scene, 20);
    refuse("glint_render: no camera \"" + printable(name) + "\" (" +
           (names.empty() ? "none of the scene has a name" : "there are " + names) + ")");
}

Camera cameraFor(const glint_picture& picture, const Scene& scene) {
    if (picture.camera_name != nullptr) {
        require(picture.camera == nullptr, "glint_render: picture has both camera and camera_name");
        return cameraNamed(picture.camera_name, scene);
    }
    if (picture.camera == nullptr) return scene.camera;
    const glint_camera given = readStruct(picture.camera, "glint_render: picture.camera");
    Camera camera;
    camera.eye = threeOf(given.eye);
    camera.target = threeOf(given.target);
    camera.up = threeOf(given.up);
    camera.fovY = given.fov_y;
    try {
        validateCamera(camera, {"glint_render", "camera"});
    } catch (const Error& error) {
        refuse(error.what());  // it is no part of the scene
    }
    return camera;
}

struct Layers {
    Output color, depth, position, normal, geometry, primitive, material;
    Layers(const glint_picture& p, uint64_t pixels)
        : color(p.color, Output::Kind::Real, 4, pixels, "picture.color"),
          depth(p.depth, Output::Kind::Real, 1, pixels, "picture.depth"),
          position(p.position, Output::Kind::Real, 3, pixels, "picture.position"),
          normal(p.normal, Output::Kind::Real, 3, pixels, "picture.normal"),
          geometry(p.geometry, Output::Kind::Index, 1, pixels, "picture.geometry"),
          primitive(p.primitive, Output::Kind::Index, 1, pixels, "picture.primitive"),
          material(p.material, Output::Kind::Index, 1, pixels, "picture.material") {}
    bool needData() const {
        return depth.wanted() || position.wanted() || normal.wanted() || geometry.wanted() ||
               primitive.wanted() || material.wanted();
    }
    void write(const Picture& picture) const;
};

void Layers::write(const Picture& picture) const {
    const std::vector<float>& colors = picture.color.pixels;
    for (size_t i = 0; i < picture.done.size(); ++i)
        color.put(i, glm::dvec4(colors[4 * i], colors[4 * i + 1], colors[4 * i + 2], colors[4 * i + 3]));
    for (size_t i = 0; i < picture.data.size(); ++i) {
        const PixelData& data = picture.data[i];
        depth.put(i, data.depth);
        position.put(i, data.position);
        normal.put(i, dvec3(data.normal));
        geometry.putIndex(i, data.object);
        primitive.putIndex(i, data.primitive);
        material.putIndex(i, data.material);
    }
}

converge::Target targetOf(const glint_picture& wanted) {
    converge::Target target;
    target.error = wanted.error;
    if (!(wanted.error > 0) || !std::isfinite(wanted.error))
        refuse("picture.error must be above 0 and finite");
    if (wanted.samples != 0)
        refuse("picture.samples: picture.error finds out how many it takes; max_samples limits them");
    if (wanted.confidence != 0) target.confidence = wanted.confidence;
    if (!(target.confidence > 0.5 && target.confidence < 1))
        refuse("picture.confidence must lie between 0.5 and 1");
    if (wanted.max_samples != 0) target.maxSamples = wanted.max_samples;
    if (target.maxSamples < 2 || target.maxSamples > 1u << 20)
        refuse("picture.max_samples must be from 2 to 1048576");
    return target;
}

Picture drawToError(const Snapshot& snapshot, const glint_picture& wanted, const Request& request) {
    const PackedScene& packed = snapshot.part().packed;
    converge::Job job = converge::jobFor(packed, request, targetOf(wanted));
    if (converge::missesReflections(snapshot.scene(), *job.request.limits.depth))
        refuse("picture.error cannot bound reflections at depth 0: set max_depth to at least 1");
    job.inDouble = !snapshot.onDevice();
    job.rounding =
        reference::roundingError(packed, job.request, job.inDouble ? 0x1p-53 : reference::kFloatUnit);
    converge::Result result = converge::converge([&](const Request& r) { return snapshot.render(r); }, job);
    if (wanted.bound != nullptr) *wanted.bound = result.budget.total();
    if (result.stop == converge::Stop::Interrupted) result.picture.complete = false;
    return std::move(result.picture);
}

void draw(const Snapshot& snapshot, const glint_picture& wanted, const glint_options* options) {
    const Scene& scene = snapshot.scene();
    Request request = requestOf(settingsOf(wanted, scene), cameraFor(wanted, scene));
    const Layers layers(wanted, regionOf(request).pixels());
    // More is refused in files too (docs/reference/scene-format.md).
    if (wanted.max_depth != 0)
        request.limits.depth = static_cast<uint32_t>(std::clamp(wanted.max_depth, 0, 1000));
    request.data = layers.needData();
    const Context context = contextOf(snapshot.device(), options);
    request.cancelled = context.cancelled;
    request.progress = context.progress;
    const Picture picture =
        wanted.error == 0 ? snapshot.render(request) : drawToError(snapshot, wanted, request);
    layers.write(picture);
    if (!picture.complete) throw Cancelled();
}

}  // namespace

}  // namespace glint::library

using namespace glint::library;

glint_status glint_render(const glint_scene* scene, const glint_picture* picture,
                          const glint_options* options) {
    return guarded([&] {
        const auto snapshot = snapshotOf(scene);
        draw(*snapshot, readStruct(picture, "picture"), options);
    });
}
