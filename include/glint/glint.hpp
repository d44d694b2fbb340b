// libglint for C++20: wraps glint.h in owning handles, exceptions and views of containers. Header only; needs
// only the standard library. glint.h documents units, ranges and errors.
#ifndef GLINT_GLINT_HPP
#define GLINT_GLINT_HPP

#if __cplusplus < 202002L
#error "glint.hpp needs C++20: compile with -std=c++20, or use glint.h"
#endif

#include <glint/glint.h>
#include <glint/arrays.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace glint {
inline namespace api {

// Callbacks of a long call; both may be empty. They must not throw.
struct Control {
    std::function<bool()> cancelled = {};       // called repeatedly, from any thread; true ends the call
    std::function<void(double)> progress = {};  // called with the finished part, 0..1
};

namespace detail {

class RawOptions {
  public:
    explicit RawOptions(const Control& control) {
        options.size = sizeof(options);
        options.user = const_cast<Control*>(&control);
        if (control.cancelled)
            options.cancelled = [](void* user) { return static_cast<Control*>(user)->cancelled() ? 1 : 0; };
        if (control.progress)
            options.progress = [](void* user, double part) { static_cast<Control*>(user)->progress(part); };
    }
    glint_options options{};
};

// A counted handle.
template <class Handle, void (*retain)(Handle*), void (*release)(Handle*)>
class Owner {
  public:
    Owner() = default;
    explicit Owner(Handle* owned, std::shared_ptr<void> kept = {}) : kept_(std::move(kept)), handle_(owned) {}
    Owner(const Owner& other) : kept_(other.kept_), handle_(other.handle_) { retain(handle_); }
    Owner(Owner&& other) noexcept
        : kept_(std::move(other.kept_)), handle_(std::exchange(other.handle_, nullptr)) {}
    Owner& operator=(Owner other) noexcept {
        std::swap(kept_, other.kept_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Owner() { release(handle_); }
    Handle* get() const noexcept { return handle_; }
    const std::shared_ptr<void>& kept() const noexcept { return kept_; }

  private:
    std::shared_ptr<void> kept_;  // used by the handle's callbacks until it is released
    Handle* handle_ = nullptr;
};

}  // namespace detail

// See glint_device_info.
using DeviceInfo = glint_device_info;
// See glint_scene_info.
using SceneInfo = glint_scene_info;

// Limits and callbacks of a device, see glint_settings. The functions may be empty. They must not throw.
struct Settings {
    unsigned threads = 0;        // threads of one call at most; 0: one for each processor
    std::uint64_t maxBytes = 0;  // memory of the device and its scenes, bytes; 0: no limit
    std::function<bool(std::int64_t bytes)> memory = {};               // false refuses
    std::function<void(int level, const std::string& text)> log = {};  // level: GLINT_LOG_...
};

// A copy is another owner of the same device.
class Device {
  public:
    // The device and its scenes keep a copy of `settings`.
    Device(const std::string& selector, Settings settings) {
        const auto kept = std::make_shared<Settings>(std::move(settings));
        GLINT_INIT(glint_settings, raw);
        raw.threads = kept->threads;
        raw.max_bytes = kept->maxBytes;
        raw.user = kept.get();
        if (kept->memory)
            raw.memory = [](void* user, std::int64_t bytes) {
                return static_cast<Settings*>(user)->memory(bytes) ? 1 : 0;
            };
        if (kept->log)
            raw.log = [](void* user, std::int32_t level, const char* text) {
                static_cast<Settings*>(user)->log(level, text);
            };
        glint_device* opened = nullptr;
        check(glint_device_open_with(selector.c_str(), &raw, &opened));
        owner_ = decltype(owner_)(opened, kept);
    }
    // "" for the best, a number, "cpu", or part of a name.
    explicit Device(const std::string& selector = {}) {
        glint_device* opened = nullptr;
        check(glint_device_open(selector.c_str(), &opened));
        owner_ = decltype(owner_)(opened);
    }

    // Properties of the device.
    DeviceInfo info() const {
        GLINT_INIT(glint_device_info, found);
        check(glint_device_info_of(get(), &found));
        return found;
    }
    // All devices.
    static std::vector<DeviceInfo> list() {
        std::uint32_t count = 0;
        check(glint_device_count(&count));
        std::vector<DeviceInfo> devices(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            devices[i].size = sizeof(DeviceInfo);
            check(glint_device_describe(i, &devices[i]));
        }
        return devices;
    }
    // For calls in C; no owner of it.
    glint_device* get() const noexcept { return owner_.get(); }

  private:
    friend class Scene;
    detail::Owner<glint_device, glint_device_retain, glint_device_release> owner_;
};

// See glint_rays.
struct Rays {
    View<3> origins = {};     // three numbers each
    View<3> directions = {};  // three numbers each, of any length
    View<1> tMin = {};        // default: 0
    View<1> tMax = {};        // default: infinity
    bool coherent = false;    // neighbours go about the same way
    bool leave = false;       // they start on surfaces, at Hits::origin

    // Same data as the struct of the C API.
    glint_rays raw() const {
        GLINT_INIT(glint_rays, rays);
        rays.origins = origins.raw;
        rays.directions = directions.raw;
        rays.t_min = tMin.raw;
        rays.t_max = tMax.raw;
        rays.flags = (coherent ? GLINT_RAYS_COHERENT : 0) | (leave ? GLINT_RAYS_LEAVE : 0);
        return rays;
    }
};

// See glint_hits.
struct Hits {
    Out<1> hit = {};        // 1 or 0
    Out<1> t = {};          // in units of the direction
    Out<1> geometry = {};   // its number
    Out<1> primitive = {};  // the triangle's number in its mesh
    Out<1> material = {};   // its number
    Out<2> uv = {};         // two numbers
    Out<3> point = {};      // three numbers, world
    Out<3> normal = {};     // three numbers: geometric, outward, unit
    Out<1> sure = {};       // uint8_t: 1 if the closest hit is proven
    Out<1> tLower = {};     // at most the exact t
    Out<1> tUpper = {};     // at least the exact t
    Out<3> origin = {};     // three numbers, world: where rays that leave the hit start

    // Same data as the struct of the C API.
    glint_hits raw() const {
        GLINT_INIT(glint_hits, hits);
        hits.hit = hit.raw;
        hits.t = t.raw;
        hits.geometry = geometry.raw;
        hits.primitive = primitive.raw;
        hits.material = material.raw;
        hits.uv = uv.raw;
        hits.point = point.raw;
        hits.normal = normal.raw;
        hits.sure = sure.raw;
        hits.t_lower = tLower.raw;
        hits.t_upper = tUpper.raw;
        hits.origin = origin.raw;
        return hits;
    }
};

// See glint_camera.
struct Camera {
    std::array<double, 3> eye = {};        // the position
    std::array<double, 3> target = {};     // a point in the middle of the image
    std::array<double, 3> up = {0, 1, 0};  // upward direction in the image
    double fovY = 40;                      // degrees, vertical
};

// See glint_picture.
struct Picture {
    std::uint32_t width = 0;           // 0: the scene's
    std::uint32_t height = 0;          // 0: the scene's
    std::uint32_t samples = 0;         // 0: the scene's
    std::int32_t maxDepth = 0;         // 0: the scene's, -1: no reflections
    const Camera* camera = nullptr;    // null: the scene's
    Out<4> color = {};                 // four numbers: linear RGB, alpha
    Out<1> depth = {};                 // t of the unit direction
    Out<3> position = {};              // three numbers, world
    Out<3> normal = {};                // three numbers: shading normal, unit
    Out<1> geometry = {};              // its number
    Out<1> primitive = {};             // its number
    Out<1> material = {};              // its number
    const char* cameraName = nullptr;  // one of the scene's `cameras`, instead of `camera`
    double error = 0;                  // > 0: as many samples as it takes, see glint_picture
    double confidence = 0;             // 0: 0.95
    std::uint32_t maxSamples = 0;      // 0: 65536
    double* bound = nullptr;           // receives what the error is at most
};

using Transform = std::array<double, 12>;  // three rows of four

// See glint_pinhole_rays; returns the origin of all rays.
inline std::array<double, 3> pinholeRays(const std::array<double, 9>& intrinsics, const Transform& extrinsics,
                                         std::uint32_t width, std::uint32_t height,
                                         const Out<3>& directions) {
    std::array<double, 3> origin{};
    check(glint_pinhole_rays(intrinsics.data(), extrinsics.data(), width, height, origin.data(),
                             &directions.raw));
    return origin;
}

// A copy is another owner of the same scene.
class Scene {
  public:
    // Empty, to be filled and committed.
    explicit Scene(const Device& device) {
        glint_scene* made = nullptr;
        check(glint_scene_create(device.get(), &made));
        owner_ = decltype(owner_)(made, device.owner_.kept());
    }
    // From a file, committed. See glint_scene_load_with.
    static Scene load(const Device& device, const std::string& path, const Control& control = {}) {
        const detail::RawOptions options(control);
        glint_scene* loaded = nullptr;
        check(glint_scene_load_with(device.get(), path.c_str(), &options.options, &loaded));
        return Scene(device, loaded);
    }

    // See glint_scene_add_triangles; returns the geometry's number.
    std::uint32_t addTriangles(const View<3>& vertices, const View<3>& indices = {},
                               std::uint32_t material = 0) {
        GLINT_INIT(glint_triangles, triangles);
        triangles.vertices = vertices.raw;
        triangles.indices = indices.raw;
        triangles.material = material;
        std::uint32_t geometry = 0;
        check(glint_scene_add_triangles(get(), &triangles, &geometry));
        return geometry;
    }
    // See glint_scene_add_spheres; returns the first one's number.
    std::uint32_t addSpheres(const View<3>& centers, const View<1>& radii, std::uint32_t material = 0) {
        GLINT_INIT(glint_spheres, spheres);
        spheres.centers = centers.raw;
        spheres.radii = radii.raw;
        spheres.material = material;
        std::uint32_t first = 0;
        check(glint_scene_add_spheres(get(), &spheres, &first));
        return first;
    }
    // See glint_scene_add_json; returns the first geometry's number.
    std::uint32_t addJson(const std::string& text, const std::string& folder = {}) {
        std::uint32_t first = 0;
        check(glint_scene_add_json(get(), text.c_str(), folder.empty() ? nullptr : folder.c_str(), &first,
                                   nullptr));
        return first;
    }
    // See glint_scene_add_instance; returns the instance's number.
    std::uint32_t addInstance(std::uint32_t geometry, const Transform& transform) {
        std::uint32_t instance = 0;
        check(glint_scene_add_instance(get(), geometry, transform.data(), &instance));
        return instance;
    }
    // See glint_scene_set_transform.
    void setTransform(std::uint32_t geometry, const Transform& transform) {
        check(glint_scene_set_transform(get(), geometry, transform.data()));
    }
    // See glint_scene_set_vertices.
    void setVertices(std::uint32_t geometry, const View<3>& vertices) {
        check(glint_scene_set_vertices(get(), geometry, &vertices.raw));
    }
    // The number of the material of that name.
    std::uint32_t material(const std::string& name) const {
        std::uint32_t found = 0;
        check(glint_scene_find_material(get(), name.c_str(), &found));
        return found;
    }
    // See glint_scene_commit_with.
    void commit(const Control& control = {}) {
        const detail::RawOptions options(control);
        check(glint_scene_commit_with(get(), &options.options));
    }

    // See glint_scene_prepare.
    void prepare() const { check(glint_scene_prepare(get())); }

    // Properties of the committed scene.
    SceneInfo info() const {
        GLINT_INIT(glint_scene_info, found);
        check(glint_scene_info_of(get(), &found));
        return found;
    }
    // Warnings about ignored or fixed parts of the scene, one line each. Not while another thread commits.
    std::vector<std::string> warnings() const {
        std::vector<std::string> texts(info().warnings);
        for (std::uint32_t i = 0; i < texts.size(); ++i) {
            const char* text = nullptr;
            check(glint_scene_warning(get(), i, &text));
            texts[i] = text;
        }
        return texts;
    }

    // The closest hit of each ray.
    void closest(const Rays& rays, const Hits& hits, const Control& control = {}) const {
        const glint_rays asked = rays.raw();
        const glint_hits wanted = hits.raw();
        const detail::RawOptions options(control);
        check(glint_query_closest(get(), &asked, &wanted, &options.options));
    }
    // Any hit: writes a uint8_t per ray, 1 if the ray hits anything.
    void any(const Rays& rays, const Out<1>& hit, const Control& control = {}) const {
        const glint_rays asked = rays.raw();
        const detail::RawOptions options(control);
        check(glint_query_any(get(), &asked, &hit.raw, &options.options));
    }

    // How many surfaces each ray crosses.
    void count(const Rays& rays, const Out<1>& crossings, const Control& control = {}) const {
        const glint_rays asked = rays.raw();
        const detail::RawOptions options(control);
        check(glint_query_count(get(), &asked, &crossings.raw, &options.options));
    }
    // All of them: those of ray i are offsets[i] ... offsets[i + 1] - 1. Returns how many there are; without
    // `hits` nothing but the offsets, which may be left out.
    std::uint64_t all(const Rays& rays, const Out<1>& offsets, const Hits* hits = nullptr,
                      const Control& control = {}) const {
        const glint_rays asked = rays.raw();
        const glint_hits wanted = hits != nullptr ? hits->raw() : glint_hits{};
        const detail::RawOptions options(control);
        std::uint64_t total = 0;
        check(glint_query_all(get(), &asked, &offsets.raw, hits != nullptr ? &wanted : nullptr, &total,
                              &options.options));
        return total;
    }
    // GLINT_OUTSIDE, GLINT_INSIDE or GLINT_ON_SURFACE for each point.
    void inside(const View<3>& points, const Out<1>& where, const Control& control = {}) const {
        const detail::RawOptions options(control);
        check(glint_query_inside(get(), &points.raw, &where.raw, &options.options));
    }

    // The closest point of all surfaces to each point, as a hit whose t is the distance.
    void closestPoint(const View<3>& points, const Hits& hits, const Control& control = {}) const {
        const glint_hits wanted = hits.raw();
        const detail::RawOptions options(control);
        check(glint_query_closest_point(get(), &points.raw, &wanted, &options.options));
    }

    // See glint_render.
    void render(const Picture& picture, const Control& control = {}) const {
        GLINT_INIT(glint_camera, camera);
        GLINT_INIT(glint_picture, wanted);
        if (picture.camera != nullptr) {
            for (std::size_t i = 0; i < 3; ++i) {
                camera.eye[i] = picture.camera->eye[i];
                camera.target[i] = picture.camera->target[i];
                camera.up[i] = picture.camera->up[i];
            }
            camera.fov_y = picture.camera->fovY;
            wanted.camera = &camera;
        }
        wanted.camera_name = picture.cameraName;
        wanted.width = picture.width;
        wanted.height = picture.height;
        wanted.samples = picture.samples;
        wanted.max_depth = picture.maxDepth;
        wanted.color = picture.color.raw;
        wanted.depth = picture.depth.raw;
        wanted.position = picture.position.raw;
        wanted.normal = picture.normal.raw;
        wanted.geometry = picture.geometry.raw;
        wanted.primitive = picture.primitive.raw;
        wanted.material = picture.material.raw;
        wanted.error = picture.error;
        wanted.confidence = picture.confidence;
        wanted.max_samples = picture.maxSamples;
        wanted.bound = picture.bound;
        const detail::RawOptions options(control);
        check(glint_render(get(), &wanted, &options.options));
    }

    // For calls in C; no owner of it.
    glint_scene* get() const noexcept { return owner_.get(); }

  private:
    Scene(const Device& device, glint_scene* owned) : owner_(owned, device.owner_.kept()) {}
    detail::Owner<glint_scene, glint_scene_retain, glint_scene_release> owner_;
};

}  // namespace api
}  // namespace glint

#endif
