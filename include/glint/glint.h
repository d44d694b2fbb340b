/* libglint: casts rays against scenes and renders images, on Vulkan 1.1 devices or on the processor alone.
 *
 * This is the C API; glint.hpp wraps it for C++. The tutorial is docs/guide/library.md.
 *
 * - Status: every call that can fail returns a glint_status. glint_last_error() then states the problem and
 *   the remedy in one line, per thread. A call that fails before it computes leaves its outputs untouched.
 * - Handles are opaque and counted: ..._retain adds an owner, ..._release removes one (NULL is allowed). A
 *   scene keeps its device alive. The last release frees the object; calls do not detect freed handles.
 * - Structs that may grow begin with `size`, which the caller sets to the size of the struct. GLINT_INIT does
 *   so and sets the other members to zero, which means "the default" or "not wanted".
 * - Arrays are views: a pointer, the number of elements, the bytes from one element to the next (0: packed)
 *   and the type of the numbers. The origin of a ray is one element of three numbers. An input view with a
 *   count of 1 stands for all rays. A stride shorter than a number, or for outputs than an element, is an
 *   error. Input is copied only into buffers of the device. Arrays must live until the call returns.
 * - Outputs are allocated by the caller. An output without data is neither computed nor read back.
 * - Units: right-handed, y up; colours are linear RGB; t is in units of the ray's direction, of any length.
 * - Accuracy: vertices and rays may be fp64 and far from 0: each scene has an origin, which is subtracted in
 *   double precision before vertices are rounded to fp32. Device "cpu" traces the same rounded vertices, with
 *   rays and arithmetic in double precision. Certified hits use the caller's vertices.
 * - Threads: any thread may use a device. Any number of threads may query and render a committed scene, also
 *   while another thread changes or commits it: they see the state committed when they began. Only one thread
 *   at a time may change a scene.
 * - No call ends the process, prints, handles signals or changes the environment.
 */
#ifndef GLINT_GLINT_H
#define GLINT_GLINT_H

#include <stddef.h>
#include <stdint.h>

/* Marks exported functions. */
#if defined(__GNUC__)
#define GLINT_API __attribute__((visibility("default")))
#else
#define GLINT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Version, status, errors ---- */

#define GLINT_VERSION_MAJOR 0 /* Version of these headers; glint_version() is the library's. */
#define GLINT_VERSION_MINOR 1 /* Version of these headers. */
#define GLINT_VERSION_PATCH 0 /* Version of these headers. */

/* Version of the loaded library: major * 1000000 + minor * 1000 + patch. */
GLINT_API uint32_t glint_version(void);

/* Result of a call: GLINT_OK or GLINT_ERROR_... */
typedef int32_t glint_status;
enum {
    GLINT_OK = 0,              /* success */
    GLINT_ERROR_ARGUMENT = 1,  /* invalid argument */
    GLINT_ERROR_SCENE = 2,     /* invalid scene, or a file that cannot be read */
    GLINT_ERROR_DEVICE = 3,    /* no usable device, or it failed */
    GLINT_ERROR_MEMORY = 4,    /* out of host memory, or refused by the caller's settings */
    GLINT_ERROR_CANCELLED = 5, /* by the caller's callback; outputs hold the finished part */
    GLINT_ERROR_CAPACITY = 6,  /* more hits than the outputs hold; only their number was written */
    GLINT_ERROR_FAILED = 7     /* any other failure */
};

/* Message of this thread's last failed call, "" before any. Valid until the thread's next failure. */
GLINT_API const char* glint_last_error(void);

/* "ok", "argument", ...; "unknown" for numbers that are no status. */
GLINT_API const char* glint_status_name(glint_status status);

/* Declares a struct with its size set and zeros elsewhere: GLINT_INIT(glint_rays, rays); */
#ifdef __cplusplus
#define GLINT_INIT(type, name) \
    type name = {};            \
    name.size = sizeof(type)
#else
#define GLINT_INIT(type, name) type name = {.size = sizeof(type)}
#endif

/* ---- Arrays ---- */

/* Type of an array's numbers: one of the following. */
typedef int32_t glint_type;
enum {
    GLINT_F32 = 0, /* float */
    GLINT_F64 = 1, /* double */
    GLINT_U32 = 2, /* uint32_t */
    GLINT_U8 = 3,  /* uint8_t */
    GLINT_U64 = 4  /* uint64_t */
};

/* An input array. */
typedef struct glint_view {
    const void* data; /* first element; NULL: no array */
    uint64_t count;   /* number of elements */
    int64_t stride;   /* bytes from one element to the next; 0: packed. May be negative. */
    glint_type type;  /* of each number of an element */
    int32_t reserved;
} glint_view;

/* An output array. */
typedef struct glint_out {
    void* data;      /* NULL: not wanted */
    uint64_t count;  /* room, in elements */
    int64_t stride;  /* as in glint_view */
    glint_type type; /* of each number of an element */
    int32_t reserved;
} glint_out;

/* ---- Options of long calls ---- */

/* Callbacks of a long call. The options and each callback may be NULL. Callbacks must not call glint, and
 * none is called after the call has returned. */
typedef struct glint_options {
    uint64_t size;
    /* Called repeatedly, from any thread; a result other than 0 ends the call with GLINT_ERROR_CANCELLED. */
    int (*cancelled)(void* user);
    /* Called with the finished fraction, 0..1, which never decreases; from any thread, one at a time. */
    void (*progress)(void* user, double fraction);
    void* user; /* passed to the callbacks */
} glint_options;

/* ---- Devices ---- */

/* A Vulkan device, or the reference on the processor. Any thread may use it. */
typedef struct glint_device glint_device;

/* Properties of a device. */
typedef struct glint_device_info {
    uint64_t size;
    uint32_t index;    /* for glint_device_open */
    int32_t usable;    /* 0: unsupported, for `reason` */
    int32_t software;  /* a Vulkan driver that runs on the processor */
    int32_t reference; /* device "cpu": double-precision arithmetic on fp32 vertices, without Vulkan */
    char name[256];    /* "llvmpipe (LLVM 15.0.6, 256 bits)" */
    char reason[256];  /* why it is unsupported, or a remark */
} glint_device_info;

/* Number of devices: Vulkan's, and "cpu" as the last. */
GLINT_API glint_status glint_device_count(uint32_t* count);
/* Properties of the device with this index, 0 to count - 1. `info->size` must be set. */
GLINT_API glint_status glint_device_describe(uint32_t index, glint_device_info* info);
/* selector: NULL or "" for the best Vulkan device, an index, "cpu", or part of a name in any case. */
GLINT_API glint_status glint_device_open(const char* selector, glint_device** device);

enum {
    GLINT_LOG_INFO = 0,   /* progress of work */
    GLINT_LOG_WARNING = 1 /* something was ignored or fixed */
};

/* Settings of a device and of all scenes made with it; devices of one process share none of them. Callbacks
 * may be NULL, must not call glint, and must stay callable until the device and its scenes are released. */
typedef struct glint_settings {
    uint64_t size;
    uint32_t threads; /* most threads of one call; 0: one for each processor. A software device has its own */
    uint32_t reserved;
    /* Most bytes that the device and its scenes may hold at a time; 0: no limit. This counts vertices,
     * indices, traced arrays, BVHs under construction and device buffers, but not code, materials and small
     * allocations. */
    uint64_t max_bytes;
    /* Called with bytes > 0 before that much memory is allocated, of files after they are read: a result of 0
     * refuses it, and the call ends with GLINT_ERROR_MEMORY and changes nothing. Called with bytes < 0 after
     * that much was freed; the result is then ignored. From any thread. */
    int (*memory)(void* user, int64_t bytes);
    /* Called with lines, without their ends, on what was opened, committed, ignored and fixed; level:
     * GLINT_LOG_... In the thread of the call. */
    void (*log)(void* user, int32_t level, const char* text);
    void* user; /* passed to the callbacks */
} glint_settings;

/* glint_device_open with settings; NULL: the defaults. */
GLINT_API glint_status glint_device_open_with(const char* selector, const glint_settings* settings,
                                              glint_device** device);
/* Properties of an open device. `info->size` must be set. */
GLINT_API glint_status glint_device_info_of(const glint_device* device, glint_device_info* info);
/* Adds an owner; NULL is allowed. From any thread. */
GLINT_API void glint_device_retain(glint_device* device);
/* Removes an owner; the last closes the device once its scenes are freed. NULL is allowed. From any
 * thread. */
GLINT_API void glint_device_release(glint_device* device);

/* ---- Scenes ---- */

/* Geometries, and the state that glint_scene_commit made of them for queries. */
typedef struct glint_scene glint_scene;

/* Creates an empty scene, to be filled and committed. */
GLINT_API glint_status glint_scene_create(glint_device* device, glint_scene** scene);
/* Loads and commits a scene (.json, .gltf, .glb, .nff) or a model (.obj, .ply, .stl). path: UTF-8. */
GLINT_API glint_status glint_scene_load(glint_device* device, const char* path, glint_scene** scene);
/* glint_scene_load with options. The first half of the progress is reading, the second building the BVH. If
 * cancelled, *scene is NULL, all memory is freed and the device is unchanged. */
GLINT_API glint_status glint_scene_load_with(glint_device* device, const char* path,
                                             const glint_options* options, glint_scene** scene);
/* Adds an owner; NULL is allowed. From any thread. */
GLINT_API void glint_scene_retain(glint_scene* scene);
/* Removes an owner; the last frees the scene once no query runs. NULL is allowed. From any thread. */
GLINT_API void glint_scene_release(glint_scene* scene);

/* Geometries are numbered from 0 in the order of the calls that add them; hits name them by number. */
#define GLINT_NONE 0xffffffffu /* No geometry, primitive or material. */

/* A triangle mesh. */
typedef struct glint_triangles {
    uint64_t size;
    glint_view vertices; /* three numbers each, F32 or F64 */
    glint_view indices;  /* three U32 each; no data: each three vertices are a triangle */
    uint32_t material;   /* 0: the scene's first material, or grey */
    uint32_t reserved;
} glint_triangles;

/* Adds a mesh. Seen from outside, corners are counter-clockwise. A triangle with a vertex that is not finite,
 * or without area, is ignored with a warning and keeps its number; the commit refuses finite coordinates of
 * 1e18 or more, and scenes less than 1e-14 across. */
GLINT_API glint_status glint_scene_add_triangles(glint_scene* scene, const glint_triangles* triangles,
                                                 uint32_t* geometry);

/* Spheres of one material. */
typedef struct glint_spheres {
    uint64_t size;
    glint_view centers; /* three numbers each, magnitudes below 1e18 */
    glint_view radii;   /* one number each, 1e-14 to 1e18; a count of 1: the same for all */
    uint32_t material;  /* see glint_triangles */
    uint32_t reserved;
} glint_spheres;

/* Adds spheres, one geometry each, numbered from *first. */
GLINT_API glint_status glint_scene_add_spheres(glint_scene* scene, const glint_spheres* spheres,
                                               uint32_t* first);

/* Adds the objects, materials and lights of a text in the scene format (docs/reference/scene-format.md). Its
 * camera, background, image and other settings replace the scene's. `folder`: base of relative file names
 * (NULL: the working directory). *first, *count: its geometries; either may be NULL. */
GLINT_API glint_status glint_scene_add_json(glint_scene* scene, const char* text, const char* folder,
                                            uint32_t* first, uint32_t* count);

/* Adds another instance of a geometry. transform: three rows of a 3 x 4 matrix, applied to the geometry as it
 * was added. A mesh with several instances is stored once. */
GLINT_API glint_status glint_scene_add_instance(glint_scene* scene, uint32_t geometry,
                                                const double transform[12], uint32_t* instance);
/* Replaces the transform of a geometry or instance; the matrix is applied to it as it was added. */
GLINT_API glint_status glint_scene_set_transform(glint_scene* scene, uint32_t geometry,
                                                 const double transform[12]);
/* Replaces the vertices of a mesh, and of its instances. They must be as many as before and finite; otherwise
 * the call fails and changes nothing. */
GLINT_API glint_status glint_scene_set_vertices(glint_scene* scene, uint32_t geometry,
                                                const glint_view* vertices);

/* Number of the material with this name, from files and texts. */
GLINT_API glint_status glint_scene_find_material(const glint_scene* scene, const char* name,
                                                 uint32_t* material);

/* Makes all additions and changes visible to queries. If only meshes, their instances and planes changed, the
 * commit refits the BVH until a ray takes 1.3 times as many tests; otherwise it rebuilds the BVH
 * (docs/guide/library.md). Answers about rays, unless certified, have the same bits as those of a new scene.
 * Running queries finish with the state that they began with; a scene that changes therefore takes twice the
 * memory. If the call fails, queries see the state as before. */
GLINT_API glint_status glint_scene_commit(glint_scene* scene);
/* glint_scene_commit with options. */
GLINT_API glint_status glint_scene_commit_with(glint_scene* scene, const glint_options* options);

/* Compiles the kernels of glint_query_closest and glint_query_any for the committed scene; otherwise their
 * first call does. */
GLINT_API glint_status glint_scene_prepare(const glint_scene* scene);

/* Properties of a committed scene. */
typedef struct glint_scene_info {
    uint64_t size;
    uint32_t geometries; /* with instances */
    uint32_t warnings;   /* number of lines of glint_scene_warning */
    uint64_t triangles;  /* those of instances counted for each instance */
    double lower[3];     /* bounds of everything but planes; 0 for an empty scene */
    double upper[3];     /* upper corner of the bounds */
    uint32_t width;      /* of the scene's image, pixels */
    uint32_t height;     /* the same */
    uint32_t refits;     /* commits since the BVH was last built, each of which refitted it */
    uint32_t reserved;
} glint_scene_info;

/* Properties of the committed scene. `info->size` must be set. */
GLINT_API glint_status glint_scene_info_of(const glint_scene* scene, glint_scene_info* info);
/* Line `index` about something ignored or fixed. Valid until the next commit or the scene's end. */
GLINT_API glint_status glint_scene_warning(const glint_scene* scene, uint32_t index, const char** text);

/* ---- Rays ---- */

enum {
    GLINT_RAYS_COHERENT = 1u, /* neighbours in the array have similar directions: may be faster, same answers.
                                 From 4096 rays on, glint finds out by itself. */
    /* The rays start on surfaces, at glint_hits.origin. They do not hit a surface that contains their start
     * as far as rounding can tell: their own, or another in the same place. Only for glint_query_any and,
     * without certainty, glint_query_closest. The rule is in docs/design/numerics.md. */
    GLINT_RAYS_LEAVE = 2u
};

/* Rays: the points origin + t direction with t_min < t <= t_max and t > 0. Hits behind the origin never
 * count, even if t_min is below 0. A ray misses if it is not finite, if its direction is shorter than 1e-290,
 * if its interval is empty or has a NaN, and, unless it is certified, if it starts beyond fp32's range
 * (device "cpu": beyond 1e150). The number of rays is the larger count of origins and directions, and 0 if
 * either is 0. */
typedef struct glint_rays {
    uint64_t size;
    glint_view origins;    /* three numbers each; a count of 1: the same for all */
    glint_view directions; /* three numbers each, of any length; a count of 1: the same for all */
    glint_view t_min;      /* no data: 0 */
    glint_view t_max;      /* no data: infinity */
    uint32_t flags;        /* sum of GLINT_RAYS_... */
    uint32_t reserved;
} glint_rays;

/* Outputs for each ray. On a miss, t is infinity, geometry, primitive and material are GLINT_NONE, and all
 * others are 0. */
typedef struct glint_hits {
    uint64_t size;
    glint_out hit;       /* U8: 1 or 0 */
    glint_out t;         /* F32 or F64 */
    glint_out geometry;  /* U32 */
    glint_out primitive; /* U32: the triangle's number in its mesh, or the face's in its file; else 0 */
    glint_out material;  /* U32 */
    glint_out uv; /* two of F32 or F64: the point of a triangle a, b, c is (1 - u - v) a + u b + v c, with b
                     and c exchanged if a transform mirrors the triangle; else 0 */
    glint_out point;  /* three of F32 or F64, world */
    glint_out normal; /* three of F32 or F64: geometric, outward, unit */
    /* Only for glint_query_closest: if one of these three is wanted, the closest hit is that of exact
     * arithmetic on the caller's numbers. */
    glint_out sure;    /* U8: 1 if the hit is proven, else 0 */
    glint_out t_lower; /* F32 or F64: the exact t is at least this */
    glint_out t_upper; /* F32 or F64: the exact t is at most this */
    /* Three of F32 or F64, world: start of rays that leave the hit on the side that the ray came from. It is
     * `point`, moved along the normal by the bound on its rounding error; 2 point - origin is on the other
     * side, for refracted rays. See GLINT_RAYS_LEAVE. */
    glint_out origin;
} glint_hits;

/* The closest hit of each ray.
 *
 * If hits->sure, t_lower or t_upper is wanted, hits are certified: those of the rays and vertices as given,
 * in exact arithmetic. The host decides, first in double, then in whole numbers. sure = 1: the hit is the
 * closest (of several at the same t the one added first), or the ray hits nothing, and both bounds are
 * infinity. sure = 0: undecided. The other outputs are then those of an ordinary query; the exact t is at
 * least t_lower and at most t_upper, which is infinity if there may be no hit. Triangles and planes are
 * always decided, spheres unless a ray is tangent, comes from 1e6 radii away, or ties with another; other
 * shapes and alpha-masked surfaces are not. Triangles that the scene ignores do not count. A transform that
 * is not an instance's moves vertices to the nearest doubles. */
GLINT_API glint_status glint_query_closest(const glint_scene* scene, const glint_rays* rays,
                                           const glint_hits* hits, const glint_options* options);
/* Any hit: U8, 1 if the ray hits anything, else 0. */
GLINT_API glint_status glint_query_any(const glint_scene* scene, const glint_rays* rays, const glint_out* hit,
                                       const glint_options* options);

/* Rays through the centres of the pixels of a pinhole camera. `origin` (may be NULL) receives the origin of
 * all rays; element y * width + x of `directions`, three F32 or F64, the direction through pixel (x, y) from
 * the upper left corner. Directions have length 1 along the camera's axis, so the t of a hit is its depth
 * along that axis.
 *   intrinsics  rows of [fx, skew, cx; 0, fy, cy; 0, 0, 1], in pixels. (0, 0) is the upper left corner of
 *               the image, (0.5, 0.5) the centre of its first pixel.
 *   extrinsics  rows of [rotation | shift], from the world to the camera. It looks along its z, with y down.
 */
GLINT_API glint_status glint_pinhole_rays(const double intrinsics[9], const double extrinsics[12],
                                          uint32_t width, uint32_t height, double origin[3],
                                          const glint_out* directions);

/* ---- Counts of crossings ---- */

/* Number of surfaces that each ray crosses in its interval, U32. At a shared edge or corner a ray crosses as
 * many triangles as a ray just beside it: regardless of rounding, a line crosses a closed mesh an even number
 * of times, and a ray that starts inside an odd number. Holes of alpha-masked surfaces are not counted,
 * transparent surfaces are. For closest hits, edges belong to both triangles. */
GLINT_API glint_status glint_query_count(const glint_scene* scene, const glint_rays* rays,
                                         const glint_out* count, const glint_options* options);

/* All crossings that glint_query_count counts, for each ray by t, then by geometry and primitive. Those of
 * ray i are elements offsets[i] to offsets[i + 1] - 1 of the arrays of `hits`, whose counts are their room.
 *   offsets  U64, one more than there are rays; may be NULL.
 *   hits     NULL: offsets and total only.
 *   total    the number of all hits; may be NULL. It and the offsets are also set if the call returns
 *            GLINT_ERROR_CAPACITY for lack of room. */
GLINT_API glint_status glint_query_all(const glint_scene* scene, const glint_rays* rays,
                                       const glint_out* offsets, const glint_hits* hits, uint64_t* total,
                                       const glint_options* options);

enum {
    GLINT_OUTSIDE = 0,   /* closed surfaces enclose the point an even number of times */
    GLINT_INSIDE = 1,    /* an odd number of times */
    GLINT_ON_SURFACE = 2 /* so near a surface that rounding decides */
};

/* Position of each point, three F32 or F64, relative to closed surfaces: U8. Below a plane is inside. On the
 * surface: so near that rounding to fp32 may move the point through it, 2^-22 of the coordinates' size
 * relative to the scene's origin (2^-20 for instances). */
GLINT_API glint_status glint_query_inside(const glint_scene* scene, const glint_view* points,
                                          const glint_out* where, const glint_options* options);

/* ---- Distances ---- */

/* The closest point of all surfaces to each of `points`, three F32 or F64 each, as a hit: t is the distance,
 * `point` the closest point; the other outputs describe the surface there. Points that are not finite, or
 * 1e18 or more from the scene's origin, get the values of a miss. The scene may hold meshes, spheres and
 * their instances; other shapes are an error (GLINT_ERROR_ARGUMENT). Holes of alpha-masked surfaces count as
 * surface. A device finds the closest primitive in fp32: the distance may exceed the least by 2^-20 of the
 * coordinates' size relative to the scene's origin. Device "cpu" finds it in double. For a signed distance,
 * negate t where glint_query_inside returns GLINT_INSIDE. */
GLINT_API glint_status glint_query_closest_point(const glint_scene* scene, const glint_view* points,
                                                 const glint_hits* hits, const glint_options* options);

/* ---- Images ---- */

/* A pinhole camera. */
typedef struct glint_camera {
    uint64_t size;
    double eye[3];    /* position, world */
    double target[3]; /* point that the camera looks at, other than eye */
    double up[3];     /* direction that is up in the image, not parallel to the view */
    double fov_y;     /* degrees, vertical, in (0, 180) */
} glint_camera;

/* An image and its layers; pixel (x, y) from the upper left corner is element y * width + x. Layers other
 * than color describe the first sample of each pixel, with the values of a miss if it hits nothing. */
typedef struct glint_picture {
    uint64_t size;
    uint32_t width;             /* pixels; 0: those of the scene */
    uint32_t height;            /* pixels; 0: those of the scene */
    uint32_t samples;           /* for each pixel; 0: those of the scene */
    int32_t max_depth;          /* consecutive reflections, at most 1000; 0: those of the scene, -1: none */
    const glint_camera* camera; /* NULL: the scene's */
    glint_out color;            /* four of F32 or F64: linear RGB, alpha */
    glint_out depth;            /* F32 or F64: distance along the camera ray */
    glint_out position;         /* three of F32 or F64, world */
    glint_out normal;           /* three of F32 or F64: shading normal, unit, outward */
    glint_out geometry;         /* U32 */
    glint_out primitive;        /* U32 */
    glint_out material;         /* U32 */
    const char* camera_name;    /* name of one of the scene's `cameras`, instead of `camera`; or NULL */
    /* Above 0: target for the error of color, the root mean square over all pixels and channels of linear
     * radiance with full scale 1; samples are added until it holds with probability `confidence`. `samples`
     * must then be 0. A grid of samples is replaced by a low-discrepancy sequence. */
    double error;
    double confidence;    /* 0.5 to 1, exclusive; 0: 0.95 */
    uint32_t max_samples; /* most samples of a pixel; 0: 65536 */
    uint32_t reserved;
    double* bound; /* receives the bound on the error, above `error` if max_samples ended it; may be NULL */
} glint_picture;

/* Renders the committed scene. If cancelled, finished pixels are written and the others are 0. */
GLINT_API glint_status glint_render(const glint_scene* scene, const glint_picture* picture,
                                    const glint_options* options);

#ifdef __cplusplus
}
#endif

#endif
