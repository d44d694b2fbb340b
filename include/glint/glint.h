/* libglint: rays against scenes, and pictures of them, on any Vulkan device or on the processor alone.
 *
 * A C API. C++ programs may like glint.hpp better, which wraps it. The tutorial is docs/guide/library.md.
 *
 * - Status: every call that can fail returns a glint_status; glint_last_error() then says in one line what
 * was wrong and what to do, by thread. Outputs are untouched where a call fails before it computes.
 * - Handles: opaque and counted: ..._retain adds an owner, ..._release takes one away (NULL is allowed). A
 *   scene keeps its device alive. One without an owner is gone, like freed memory: no call finds that out.
 * - Structs: those that may grow begin with `size`: set it to sizeof of the struct, as GLINT_INIT does
 * together with zeros everywhere else, which stand for "the default" or "not wanted".
 * - Arrays: views: a pointer, how many elements, the bytes from one to the next (0: they are packed) and the
 *   type of their numbers. One ray's origin is an element of three numbers. An input view with a count of 1
 *   stands for all rays. Strides shorter than a number, or of outputs than an element, are refused. Nothing
 * is copied on the way in but into the device's own buffers. Arrays need to live until the call returns, and
 *   no longer.
 * - Outputs: allocated by the caller. What has no pointer is not wanted, and neither computed nor read back.
 * - Units: right-handed, y up; colours are linear RGB; t is in units of the ray's direction, of any length.
 * - Accuracy: vertices and rays may be fp64 and lie far from 0: a scene has an origin of its own, which is
 *   subtracted in double precision before vertices are rounded to fp32. Device "cpu" traces the same rounded
 *   vertices, with rays and arithmetic in double precision; certified hits use the caller's vertices.
 * - Threads: a device may be used from any thread. Queries and pictures of a committed scene may run in any
 *   number of threads at a time, also while another thread changes or commits the scene: they see the scene
 * as it was last committed when they began. Changes of one scene are made by one thread at a time.
 * - Manners: no call ends the process, prints, handles signals or changes the environment.
 */
#ifndef GLINT_GLINT_H
#define GLINT_GLINT_H

#include <stddef.h>
#include <stdint.h>

/* In front of what the library exports. */
#if defined(__GNUC__)
#define GLINT_API __attribute__((visibility("default")))
#else
#define GLINT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Version, status, errors ---- */

#define GLINT_VERSION_MAJOR 0 /* Of these headers; glint_version() is that of the library. */
#define GLINT_VERSION_MINOR 1 /* Of these headers. */
#define GLINT_VERSION_PATCH 0 /* Of these headers. */

/* Of the library that runs: major * 1000000 + minor * 1000 + patch. */
GLINT_API uint32_t glint_version(void);

/* How a call ended: one of GLINT_OK and GLINT_ERROR_... */
typedef int32_t glint_status;
enum {
    GLINT_OK = 0,              /* it did what was asked */
    GLINT_ERROR_ARGUMENT = 1,  /* what the caller asked for is at fault */
    GLINT_ERROR_SCENE = 2,     /* the scene, or a file it names, is at fault */
    GLINT_ERROR_DEVICE = 3,    /* no usable device, or it failed */
    GLINT_ERROR_MEMORY = 4,    /* of the host; or the caller's settings refuse it */
    GLINT_ERROR_CANCELLED = 5, /* by the caller's callback; outputs hold what was finished */
    GLINT_ERROR_CAPACITY = 6,  /* more hits than there is room for; nothing was written but how many */
    GLINT_ERROR_FAILED = 7     /* anything else */
};

/* What went wrong in this thread's last call that failed; "" before any. Valid until the next one fails. */
GLINT_API const char* glint_last_error(void);

/* "ok", "argument", ...; "unknown" for other numbers. */
GLINT_API const char* glint_status_name(glint_status status);

/* Declares a struct with its size set and all else zero: GLINT_INIT(glint_rays, rays); */
#ifdef __cplusplus
#define GLINT_INIT(type, name) \
    type name = {};            \
    name.size = sizeof(type)
#else
#define GLINT_INIT(type, name) type name = {.size = sizeof(type)}
#endif

/* ---- Arrays ---- */

/* What the numbers of an array are: one of the following. */
typedef int32_t glint_type;
enum {
    GLINT_F32 = 0, /* float */
    GLINT_F64 = 1, /* double */
    GLINT_U32 = 2, /* uint32_t */
    GLINT_U8 = 3,  /* uint8_t */
    GLINT_U64 = 4  /* uint64_t */
};

/* An array that is read. */
typedef struct glint_view {
    const void* data; /* the first element; NULL: there is none */
    uint64_t count;   /* elements */
    int64_t stride;   /* bytes; 0: packed. May be negative. */
    glint_type type;  /* of each number of an element */
    int32_t reserved;
} glint_view;

/* An array that is written. */
typedef struct glint_out {
    void* data;      /* NULL: not wanted */
    uint64_t count;  /* elements that there is room for */
    int64_t stride;  /* as in glint_view */
    glint_type type; /* of each number of an element */
    int32_t reserved;
} glint_out;

/* ---- How a long call behaves ---- */

/* What a call of some length asks and tells. NULL, here or for a callback: nothing. The callbacks must not
 * call glint, and are called until the call returns at the latest. */
typedef struct glint_options {
    uint64_t size;
    /* Asked now and then, from any thread; true ends the call with GLINT_ERROR_CANCELLED. */
    int (*cancelled)(void* user);
    /* Told the part that is done, 0..1, which never falls; from any thread, one call at a time. */
    void (*progress)(void* user, double fraction);
    void* user; /* handed to both */
} glint_options;

/* ---- Devices ---- */

/* What traces: a Vulkan device, or the reference. Safe to use from any thread. */
typedef struct glint_device glint_device;

/* What is known of a device. */
typedef struct glint_device_info {
    uint64_t size;
    uint32_t index;    /* as glint_device_open takes it */
    int32_t usable;    /* 0: refused, and `reason` says why */
    int32_t software;  /* Vulkan on the processor */
    int32_t reference; /* device "cpu": double-precision arithmetic on fp32 vertices, without Vulkan */
    char name[256];    /* "llvmpipe (LLVM 15.0.6, 256 bits)" */
    char reason[256];  /* why it is refused, or a remark */
} glint_device_info;

/* How many there are: Vulkan's, and "cpu" as the last. */
GLINT_API glint_status glint_device_count(uint32_t* count);
/* Of the device with that index, below the count. `info->size` must be set. */
GLINT_API glint_status glint_device_describe(uint32_t index, glint_device_info* info);
/* selector: NULL or "" for the best Vulkan device; a number: the index; "cpu"; else part of the name, any
 * case. */
GLINT_API glint_status glint_device_open(const char* selector, glint_device** device);

enum {
    GLINT_LOG_INFO = 0,   /* what was done */
    GLINT_LOG_WARNING = 1 /* what was ignored or mended */
};

/* What holds for a device and for all that is made with it. Two devices opened in one process share nothing
 * of it. Callbacks may be NULL, must not call glint, and must stay callable until the device is released and
 * everything made with it. */
typedef struct glint_settings {
    uint64_t size;
    uint32_t
        threads; /* that one call uses at most; 0: a processor each. A software device has its own besides */
    uint32_t reserved;
    /* What the device and its scenes may hold at a time, bytes; 0: no limit. Counted are vertices, indices,
     * the arrays that are traced, trees while they are built, and buffers on the device: not code, materials
     * and what the C++ library needs besides. */
    uint64_t max_bytes;
    /* Asked with bytes > 0 before so much of that is taken: 0 refuses it, and the call ends with
     * GLINT_ERROR_MEMORY and leaves everything as it was. Told with bytes < 0 when so much was given back,
     * where no answer is looked at. From any thread. */
    int (*memory)(void* user, int64_t bytes);
    /* Told what was opened, committed, ignored and mended, a line each without its end; level: GLINT_LOG_...
     * From the thread whose call it is. */
    void (*log)(void* user, int32_t level, const char* text);
    void* user; /* handed to both */
} glint_settings;

/* glint_device_open with settings of one's own; NULL: the default ones. */
GLINT_API glint_status glint_device_open_with(const char* selector, const glint_settings* settings,
                                              glint_device** device);
/* Of an open device. `info->size` must be set. */
GLINT_API glint_status glint_device_info_of(const glint_device* device, glint_device_info* info);
/* Adds an owner; NULL is allowed. From any thread. */
GLINT_API void glint_device_retain(glint_device* device);
/* Takes an owner away; the last closes the device once its scenes are gone. NULL is allowed. From any thread.
 */
GLINT_API void glint_device_release(glint_device* device);

/* ---- Scenes ---- */

/* Geometries, and what queries see of them: see glint_scene_commit. */
typedef struct glint_scene glint_scene;

/* An empty scene, to be filled and committed. */
GLINT_API glint_status glint_scene_create(glint_device* device, glint_scene** scene);
/* A scene (.json, .gltf, .glb, .nff) or model (.obj, .ply, .stl) from a file, committed. UTF-8. */
GLINT_API glint_status glint_scene_load(glint_device* device, const char* path, glint_scene** scene);
/* The same, and it may be cancelled, at any time until its end, and tells how far it is: in the first half
 * the file is read, in the second its tree is built, which may take times of any ratio. Cancelled, *scene is
 * NULL, all memory is given back, and the device is as it was. */
GLINT_API glint_status glint_scene_load_with(glint_device* device, const char* path,
                                             const glint_options* options, glint_scene** scene);
/* Adds an owner; NULL is allowed. From any thread. */
GLINT_API void glint_scene_retain(glint_scene* scene);
/* Takes an owner away; the last frees the scene, once no query runs. NULL is allowed. From any thread. */
GLINT_API void glint_scene_release(glint_scene* scene);

/* Geometries are numbered from 0 in the order in which they are added; hits name them by these numbers. */
#define GLINT_NONE 0xffffffffu /* No geometry, primitive or material. */

/* A mesh. */
typedef struct glint_triangles {
    uint64_t size;
    glint_view vertices; /* three numbers each, F32 or F64 */
    glint_view indices;  /* three U32 each; no data: every three vertices are a triangle */
    uint32_t material;   /* 0: the first of the scene, or a grey one */
    uint32_t reserved;
} glint_triangles;

/* A mesh; outward is where its corners go round counter-clockwise. Triangles with a vertex that is not
 * finite, or without area, are left out of the scene with a warning, and keep their numbers; one whose finite
 * vertices reach 1e18 is refused by the commit. */
GLINT_API glint_status glint_scene_add_triangles(glint_scene* scene, const glint_triangles* triangles,
                                                 uint32_t* geometry);

/* Spheres of one material. */
typedef struct glint_spheres {
    uint64_t size;
    glint_view centers; /* three numbers each, finite, below 1e18 */
    glint_view radii;   /* one number each, from 1e-14 to 1e18; a count of 1: all have that one */
    uint32_t material;  /* as in glint_triangles */
    uint32_t reserved;
} glint_spheres;

/* Each is a geometry of its own: *first and so on. */
GLINT_API glint_status glint_scene_add_spheres(glint_scene* scene, const glint_spheres* spheres,
                                               uint32_t* first);

/* Anything that the scene format knows (docs/reference/scene-format.md), as its text: objects, materials and
 * lights are added, and camera, background, image and all else are those of the text. Files it names are
 * relative to `folder` (NULL: the working directory). *first and *count: its geometries; either may be NULL.
 */
GLINT_API glint_status glint_scene_add_json(glint_scene* scene, const char* text, const char* folder,
                                            uint32_t* first, uint32_t* count);

/* The geometry once more, where `transform` puts it: twelve numbers, three rows of a 3 x 4 matrix that is
 * applied to the geometry as it was added. Meshes with several instances are stored once. */
GLINT_API glint_status glint_scene_add_instance(glint_scene* scene, uint32_t geometry,
                                                const double transform[12], uint32_t* instance);
/* Puts a geometry, or an instance, elsewhere; the matrix is applied to it as it was added. */
GLINT_API glint_status glint_scene_set_transform(glint_scene* scene, uint32_t geometry,
                                                 const double transform[12]);
/* Other vertices for a geometry that is a mesh, as many as it has, all finite; else nothing changes.
 * Instances follow. */
GLINT_API glint_status glint_scene_set_vertices(glint_scene* scene, uint32_t geometry,
                                                const glint_view* vertices);

/* The material of that name, among those from files and texts. */
GLINT_API glint_status glint_scene_find_material(const glint_scene* scene, const char* name,
                                                 uint32_t* material);

/* Makes everything added and changed so far what queries see. Where nothing was added, and it was meshes,
 * their instances and planes that changed, the trees stay and their boxes follow, until tests of a ray have
 * become 1.3 times as many; else they are built anew (docs/guide/library.md). The answers are those of a
 * scene made anew, in the same bits. Queries that run go on with the scene that they began with; where they
 * hold it no more, the second commit after it uses its memory again, so a scene that changes takes twice the
 * room. A call that fails leaves what queries see as it was. */
GLINT_API glint_status glint_scene_commit(glint_scene* scene);
/* The same, and it may be cancelled, at any time until its end, and tells how far it is. */
GLINT_API glint_status glint_scene_commit_with(glint_scene* scene, const glint_options* options);

/* Compiles what glint_query_closest and glint_query_any of the committed scene need, so that their first call
 * takes no longer than others. */
GLINT_API glint_status glint_scene_prepare(const glint_scene* scene);

/* What is known of a committed scene. */
typedef struct glint_scene_info {
    uint64_t size;
    uint32_t geometries; /* instances among them */
    uint32_t warnings;   /* see glint_scene_warning */
    uint64_t triangles;  /* instanced ones as often as they are shown */
    double lower[3];     /* the box of everything committed but planes; all zero if there is nothing */
    double upper[3];     /* its other corner */
    uint32_t width;      /* of its picture, pixels, as files and texts say */
    uint32_t height;     /* the same */
    uint32_t refits;     /* commits since its trees were last built, all of which kept them */
    uint32_t reserved;
} glint_scene_info;

/* Of the committed scene. */
GLINT_API glint_status glint_scene_info_of(const glint_scene* scene, glint_scene_info* info);
/* What was ignored or mended, one line each; valid until the next commit, or the scene's end. */
GLINT_API glint_status glint_scene_warning(const glint_scene* scene, uint32_t index, const char** text);

/* ---- Rays ---- */

enum {
    GLINT_RAYS_COHERENT =
        1u, /* neighbours in the array go about the same way: may be faster, changes no answer. In calls of
              4096 rays and more glint looks at some of them, and finds out by itself. */
    /* The rays start on surfaces, at glint_hits.origin: a ray does not hit a surface that is where it starts,
     * as far as rounding can tell, be it its own or another one in that place. For glint_query_closest,
     * without certainty, and glint_query_any. The rule is in docs/design/numerics.md. */
    GLINT_RAYS_LEAVE = 2u
};

/* The points origin + t direction with t_min < t <= t_max and t > 0: what is behind the origin is never met,
 * also where t_min is below 0. A ray that is not finite, or without direction (below 1e-290), hits nothing,
 * nor does one whose interval is empty or has an end that is NaN, nor, unless it is certified, one that
 * starts where fp32 cannot tell (the reference: beyond 1e150). There are as many rays as the larger of the
 * counts of origins and directions, and none if one of them is 0. */
typedef struct glint_rays {
    uint64_t size;
    glint_view origins;    /* three numbers each; a count of 1: all start there */
    glint_view directions; /* three numbers each, of any length (above); a count of 1: all go there */
    glint_view t_min;      /* no data: 0 */
    glint_view t_max;      /* no data: infinite */
    uint32_t flags;        /* GLINT_RAYS_..., any of them */
    uint32_t reserved;
} glint_rays;

/* What of each ray's hit is wanted. On a miss t is infinite, geometry, primitive and material are GLINT_NONE
 * and all else is 0. */
typedef struct glint_hits {
    uint64_t size;
    glint_out hit;       /* U8: 1 or 0 */
    glint_out t;         /* F32 or F64 */
    glint_out geometry;  /* U32 */
    glint_out primitive; /* U32: the triangle's number in its mesh; of a file the face's; else 0 */
    glint_out material;  /* U32 */
    glint_out
        uv; /* two of F32 or F64: of a triangle a, b, c the point is (1 - u - v) a + u b + v c; else 0 */
    glint_out point;  /* three of F32 or F64, world */
    glint_out normal; /* three of F32 or F64: geometric, outward, unit */
    /* Of glint_query_closest alone; where one of the three is wanted, the nearest hit is that of exact
     * arithmetic on the caller's numbers, see there. */
    glint_out sure;    /* U8: 1 if that is proven, else 0 */
    glint_out t_lower; /* F32 or F64: the exact t is not below it */
    glint_out t_upper; /* F32 or F64: the exact t is not above it */
    /* Three of F32 or F64, world: where a ray starts that leaves the hit on the side that the ray came from,
     * `point` moved along the normal by the bound on its rounding error. On the other side, for refracted
     * rays: 2 point - origin. See GLINT_RAYS_LEAVE. */
    glint_out origin;
} glint_hits;

/* The nearest hit of each ray.
 *
 * Where hits->sure, t_lower or t_upper is wanted, answers are certified: of rays and vertices as they were
 * given, in exact arithmetic, whatever is rounded on the way. A device proves what it can; rays that pass
 * edges too closely for that are decided by the host, in double and in the end in whole numbers. sure = 1:
 * the surface named is the nearest (of several at the same t the one that was added first), or the ray meets
 * nothing, and then both bounds are infinite. sure = 0: not decided, which no ray is that may meet triangles
 * and planes alone; then the answer is that of other queries, nothing is met before t_lower, and something is
 * by t_upper, infinite if that is not known either. Spheres are decided but where a ray touches one, or meets
 * it as far as rounding to double tells where it meets something else. Surfaces of other kinds, and such as
 * may have holes, are not. Triangles that the scene leaves out are no part of it; what a transform moves, and
 * is no instance, is moved to the nearest doubles. */
GLINT_API glint_status glint_query_closest(const glint_scene* scene, const glint_rays* rays,
                                           const glint_hits* hits, const glint_options* options);
/* Whether there is a hit: U8, 1 or 0 for each ray. */
GLINT_API glint_status glint_query_any(const glint_scene* scene, const glint_rays* rays, const glint_out* hit,
                                       const glint_options* options);

/* Rays through the middles of the pixels of a pinhole camera that is given by matrices: `origin` (may be
 * NULL) receives where all start, element y * width + x of `directions`, three F32 or F64, where the ray
 * through pixel (x, y) from the upper left corner goes. Their component along the camera's axis is 1, so the
 * t of a hit is its depth along that axis. intrinsics  rows of [fx, skew, cx; 0, fy, cy; 0, 0, 1], in pixels;
 * (0, 0) is the upper left corner of the picture, (0.5, 0.5) the middle of its first pixel. extrinsics  rows
 * of [rotation | shift], from the world to the camera, which looks along its z with y down. */
GLINT_API glint_status glint_pinhole_rays(const double intrinsics[9], const double extrinsics[12],
                                          uint32_t width, uint32_t height, double origin[3],
                                          const glint_out* directions);

/* ---- Counts: closed surfaces are entered and left in turns ---- */

/* How many surfaces each ray crosses in its interval, U32. Of triangles that share the edge or corner that a
 * ray meets it crosses one, or as many more as it goes in and out there: whatever was rounded, a line crosses
 * a closed mesh an even number of times, and a ray an odd number if it starts inside. Holes of alpha-masked
 * surfaces count as holes, transparent surfaces as surfaces. Ask `closest` for what a ray meets first: there
 * edges belong to both. */
GLINT_API glint_status glint_query_count(const glint_scene* scene, const glint_rays* rays,
                                         const glint_out* count, const glint_options* options);

/* All that glint_query_count counts, of each ray nearest first, those at the same t as geometries and
 * primitives are numbered. Those of ray i are elements offsets[i] to offsets[i + 1] - 1 of the arrays of
 * `hits`, whose counts say how much room there is.
 *   offsets  U64, one more than there are rays; may be NULL.
 *   hits     NULL: numbers only.
 *   total    how many hits there are; set, as the offsets are, also where there is no room for them and the
 * call returns GLINT_ERROR_CAPACITY. May be NULL. */
GLINT_API glint_status glint_query_all(const glint_scene* scene, const glint_rays* rays,
                                       const glint_out* offsets, const glint_hits* hits, uint64_t* total,
                                       const glint_options* options);

enum {
    GLINT_OUTSIDE = 0,   /* surfaces go round it an even number of times */
    GLINT_INSIDE = 1,    /* an odd number */
    GLINT_ON_SURFACE = 2 /* so near a surface that rounding decides */
};

/* Where points of three F32 or F64 are, U8 each. Inside is what closed surfaces go round an odd number of
 * times; below a plane is inside. On the surface: so near that rounding to fp32 takes the point through it,
 * 2^-22 of the coordinates' size about the scene's own origin (2^-20 for instances). */
GLINT_API glint_status glint_query_inside(const glint_scene* scene, const glint_view* points,
                                          const glint_out* where, const glint_options* options);

/* ---- Distances ---- */

/* The closest point of all surfaces to each of `points`, three F32 or F64 each, as a hit: t is its distance,
 * `point` the closest point, and geometry, primitive, material, uv and normal are those of the surface there.
 * A point with a coordinate that is not finite, or 1e18 or more from the scene's own origin, has none, as a
 * ray that misses. Scenes may hold meshes, spheres and their instances; others are refused with
 * GLINT_ERROR_ARGUMENT. Holes of alpha-masked surfaces count as surface. A device finds the closest primitive
 * in fp32: the distance may exceed the least by 2^-20 of the coordinates' size about the scene's own origin.
 * Device "cpu" finds it in double. A signed distance is negative where glint_query_inside says GLINT_INSIDE.
 */
GLINT_API glint_status glint_query_closest_point(const glint_scene* scene, const glint_view* points,
                                                 const glint_hits* hits, const glint_options* options);

/* ---- Pictures ---- */

/* A pinhole camera. */
typedef struct glint_camera {
    uint64_t size;
    double eye[3];    /* where it stands, world */
    double target[3]; /* what it looks at, other than eye */
    double up[3];     /* what is up in the picture, not along the way it looks */
    double fov_y;     /* degrees, vertical, in (0, 180) */
} glint_camera;

/* Layers of a picture; pixel (x, y) from the upper left corner is element y * width + x. The layers but color
 * are of each pixel's first sample, with the values of a miss where it hits nothing. */
typedef struct glint_picture {
    uint64_t size;
    uint32_t width;             /* pixels; 0: those of the scene */
    uint32_t height;            /* pixels; 0: those of the scene */
    uint32_t samples;           /* 0: those of the scene; else so many for each pixel */
    int32_t max_depth;          /* reflections in a row, at most 1000; 0: those of the scene, -1: none */
    const glint_camera* camera; /* NULL: the scene's */
    glint_out color;            /* four of F32 or F64: linear RGB, alpha */
    glint_out depth;            /* F32 or F64: the ray's t, whose direction is unit */
    glint_out position;         /* three of F32 or F64, world */
    glint_out normal;           /* three of F32 or F64: shading normal, unit, outward */
    glint_out geometry;         /* U32 */
    glint_out primitive;        /* U32 */
    glint_out material;         /* U32 */
    const char* camera_name;    /* one of the scene's `cameras`, instead of `camera`; NULL: none */
    /* Above 0: as many samples as it takes until color is off by at most so much, as the root mean square
     * over all pixels and channels of linear radiance, whose full scale is 1, with probability `confidence`
     * (0: 0.95). `samples` must then be 0. A grid of samples becomes a low-discrepancy sequence. */
    double error;
    double confidence;    /* between 0.5 and 1; 0: 0.95 */
    uint32_t max_samples; /* for a pixel, where they end all the same; 0: 65536 */
    uint32_t reserved;
    double*
        bound; /* receives what the error is at most: above `error` if max_samples did not do; may be NULL */
} glint_picture;

/* Draws the committed scene. Cancelled: the pixels that were finished are written, the others have zeros. */
GLINT_API glint_status glint_render(const glint_scene* scene, const glint_picture* picture,
                                    const glint_options* options);

#ifdef __cplusplus
}
#endif

#endif
