// The ABI of libglint: programs compiled against an older glint.h run with this one. The lines below stay as
// they are, unless the commit states a reason. New functions, and new members at the end of a struct that
// begins with its size, get new lines.
#include <cstddef>
#include <type_traits>

#include "glint/glint.h"

static_assert(sizeof(void*) == 8);

// A member of a struct, its offset and its type.
#define AT(Struct, member, offset, ...)                   \
    static_assert(offsetof(Struct, member) == (offset) && \
                  std::is_same_v<decltype(Struct::member), __VA_ARGS__>)
// A function and its type.
#define IS(function, ...) static_assert(std::is_same_v<decltype(function), __VA_ARGS__>)

AT(glint_view, data, 0, const void*);
AT(glint_view, count, 8, uint64_t);
AT(glint_view, stride, 16, int64_t);
AT(glint_view, type, 24, glint_type);
AT(glint_view, reserved, 28, int32_t);
static_assert(sizeof(glint_view) == 32);

AT(glint_out, data, 0, void*);
AT(glint_out, count, 8, uint64_t);
AT(glint_out, stride, 16, int64_t);
AT(glint_out, type, 24, glint_type);
AT(glint_out, reserved, 28, int32_t);
static_assert(sizeof(glint_out) == 32);

AT(glint_options, size, 0, uint64_t);
AT(glint_options, cancelled, 8, int (*)(void*));
AT(glint_options, progress, 16, void (*)(void*, double));
AT(glint_options, user, 24, void*);

AT(glint_device_info, size, 0, uint64_t);
AT(glint_device_info, index, 8, uint32_t);
AT(glint_device_info, usable, 12, int32_t);
AT(glint_device_info, software, 16, int32_t);
AT(glint_device_info, reference, 20, int32_t);
AT(glint_device_info, name, 24, char[256]);
AT(glint_device_info, reason, 280, char[256]);

AT(glint_settings, size, 0, uint64_t);
AT(glint_settings, threads, 8, uint32_t);
AT(glint_settings, reserved, 12, uint32_t);
AT(glint_settings, max_bytes, 16, uint64_t);
AT(glint_settings, memory, 24, int (*)(void*, int64_t));
AT(glint_settings, log, 32, void (*)(void*, int32_t, const char*));
AT(glint_settings, user, 40, void*);

AT(glint_triangles, size, 0, uint64_t);
AT(glint_triangles, vertices, 8, glint_view);
AT(glint_triangles, indices, 40, glint_view);
AT(glint_triangles, material, 72, uint32_t);
AT(glint_triangles, reserved, 76, uint32_t);

AT(glint_spheres, size, 0, uint64_t);
AT(glint_spheres, centers, 8, glint_view);
AT(glint_spheres, radii, 40, glint_view);
AT(glint_spheres, material, 72, uint32_t);
AT(glint_spheres, reserved, 76, uint32_t);

AT(glint_scene_info, size, 0, uint64_t);
AT(glint_scene_info, geometries, 8, uint32_t);
AT(glint_scene_info, warnings, 12, uint32_t);
AT(glint_scene_info, triangles, 16, uint64_t);
AT(glint_scene_info, lower, 24, double[3]);
AT(glint_scene_info, upper, 48, double[3]);
AT(glint_scene_info, width, 72, uint32_t);
AT(glint_scene_info, height, 76, uint32_t);
AT(glint_scene_info, refits, 80, uint32_t);
AT(glint_scene_info, reserved, 84, uint32_t);

AT(glint_rays, size, 0, uint64_t);
AT(glint_rays, origins, 8, glint_view);
AT(glint_rays, directions, 40, glint_view);
AT(glint_rays, t_min, 72, glint_view);
AT(glint_rays, t_max, 104, glint_view);
AT(glint_rays, flags, 136, uint32_t);
AT(glint_rays, reserved, 140, uint32_t);

AT(glint_hits, size, 0, uint64_t);
AT(glint_hits, hit, 8, glint_out);
AT(glint_hits, t, 40, glint_out);
AT(glint_hits, geometry, 72, glint_out);
AT(glint_hits, primitive, 104, glint_out);
AT(glint_hits, material, 136, glint_out);
AT(glint_hits, uv, 168, glint_out);
AT(glint_hits, point, 200, glint_out);
AT(glint_hits, normal, 232, glint_out);
AT(glint_hits, sure, 264, glint_out);
AT(glint_hits, t_lower, 296, glint_out);
AT(glint_hits, t_upper, 328, glint_out);
AT(glint_hits, origin, 360, glint_out);

AT(glint_camera, size, 0, uint64_t);
AT(glint_camera, eye, 8, double[3]);
AT(glint_camera, target, 32, double[3]);
AT(glint_camera, up, 56, double[3]);
AT(glint_camera, fov_y, 80, double);

AT(glint_picture, size, 0, uint64_t);
AT(glint_picture, width, 8, uint32_t);
AT(glint_picture, height, 12, uint32_t);
AT(glint_picture, samples, 16, uint32_t);
AT(glint_picture, max_depth, 20, int32_t);
AT(glint_picture, camera, 24, const glint_camera*);
AT(glint_picture, color, 32, glint_out);
AT(glint_picture, depth, 64, glint_out);
AT(glint_picture, position, 96, glint_out);
AT(glint_picture, normal, 128, glint_out);
AT(glint_picture, geometry, 160, glint_out);
AT(glint_picture, primitive, 192, glint_out);
AT(glint_picture, material, 224, glint_out);
AT(glint_picture, camera_name, 256, const char*);
AT(glint_picture, error, 264, double);
AT(glint_picture, confidence, 272, double);
AT(glint_picture, max_samples, 280, uint32_t);
AT(glint_picture, reserved, 284, uint32_t);
AT(glint_picture, bound, 288, double*);

IS(glint_version, uint32_t());
IS(glint_last_error, const char*());
IS(glint_status_name, const char*(glint_status));
IS(glint_device_count, glint_status(uint32_t*));
IS(glint_device_describe, glint_status(uint32_t, glint_device_info*));
IS(glint_device_open, glint_status(const char*, glint_device**));
IS(glint_device_open_with, glint_status(const char*, const glint_settings*, glint_device**));
IS(glint_device_info_of, glint_status(const glint_device*, glint_device_info*));
IS(glint_device_retain, void(glint_device*));
IS(glint_device_release, void(glint_device*));
IS(glint_scene_create, glint_status(glint_device*, glint_scene**));
IS(glint_scene_load, glint_status(glint_device*, const char*, glint_scene**));
IS(glint_scene_load_with, glint_status(glint_device*, const char*, const glint_options*, glint_scene**));
IS(glint_scene_retain, void(glint_scene*));
IS(glint_scene_release, void(glint_scene*));
IS(glint_scene_add_triangles, glint_status(glint_scene*, const glint_triangles*, uint32_t*));
IS(glint_scene_add_spheres, glint_status(glint_scene*, const glint_spheres*, uint32_t*));
IS(glint_scene_add_json, glint_status(glint_scene*, const char*, const char*, uint32_t*, uint32_t*));
IS(glint_scene_add_instance, glint_status(glint_scene*, uint32_t, const double*, uint32_t*));
IS(glint_scene_set_transform, glint_status(glint_scene*, uint32_t, const double*));
IS(glint_scene_set_vertices, glint_status(glint_scene*, uint32_t, const glint_view*));
IS(glint_scene_find_material, glint_status(const glint_scene*, const char*, uint32_t*));
IS(glint_scene_commit, glint_status(glint_scene*));
IS(glint_scene_commit_with, glint_status(glint_scene*, const glint_options*));
IS(glint_scene_prepare, glint_status(const glint_scene*));
IS(glint_scene_info_of, glint_status(const glint_scene*, glint_scene_info*));
IS(glint_scene_warning, glint_status(const glint_scene*, uint32_t, const char**));
IS(glint_query_closest,
   glint_status(const glint_scene*, const glint_rays*, const glint_hits*, const glint_options*));
IS(glint_query_any,
   glint_status(const glint_scene*, const glint_rays*, const glint_out*, const glint_options*));
IS(glint_pinhole_rays,
   glint_status(const double*, const double*, uint32_t, uint32_t, double*, const glint_out*));
IS(glint_query_count,
   glint_status(const glint_scene*, const glint_rays*, const glint_out*, const glint_options*));
IS(glint_query_all, glint_status(const glint_scene*, const glint_rays*, const glint_out*, const glint_hits*,
                                 uint64_t*, const glint_options*));
IS(glint_query_inside,
   glint_status(const glint_scene*, const glint_view*, const glint_out*, const glint_options*));
IS(glint_query_closest_point,
   glint_status(const glint_scene*, const glint_view*, const glint_hits*, const glint_options*));
IS(glint_render, glint_status(const glint_scene*, const glint_picture*, const glint_options*));

static_assert(GLINT_OK == 0);
static_assert(GLINT_ERROR_ARGUMENT == 1);
static_assert(GLINT_ERROR_SCENE == 2);
static_assert(GLINT_ERROR_DEVICE == 3);
static_assert(GLINT_ERROR_MEMORY == 4);
static_assert(GLINT_ERROR_CANCELLED == 5);
static_assert(GLINT_ERROR_CAPACITY == 6);
static_assert(GLINT_ERROR_FAILED == 7);
static_assert(GLINT_F32 == 0);
static_assert(GLINT_F64 == 1);
static_assert(GLINT_U32 == 2);
static_assert(GLINT_U8 == 3);
static_assert(GLINT_U64 == 4);
static_assert(GLINT_LOG_INFO == 0);
static_assert(GLINT_LOG_WARNING == 1);
static_assert(GLINT_RAYS_COHERENT == 1);
static_assert(GLINT_RAYS_LEAVE == 2);
static_assert(GLINT_OUTSIDE == 0);
static_assert(GLINT_INSIDE == 1);
static_assert(GLINT_ON_SURFACE == 2);
static_assert(GLINT_NONE == 0xffffffffu);
