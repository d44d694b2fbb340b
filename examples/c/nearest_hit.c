/* Casts rays at a box and a sphere, and prints what they hit: nearest_hit [DEVICE] */
#include <glint/glint.h>
#include <stdio.h>

/* Prints the error of a failed call and returns 1; returns 0 after success. */
static int failed(glint_status status) {
    if (status != GLINT_OK) fprintf(stderr, "%s: %s\n", glint_status_name(status), glint_last_error());
    return status != GLINT_OK;
}

static int fill(glint_scene* scene) {
    /* A ground of two triangles in fp64, far from 0: the scene subtracts an origin first. */
    static const double vertices[4][3] = {
        {1e6 - 5, 0, -5}, {1e6 + 5, 0, -5}, {1e6 + 5, 0, 5}, {1e6 - 5, 0, 5}};
    static const uint32_t indices[2][3] = {{0, 2, 1}, {0, 3, 2}};
    static const double center[3] = {1e6, 1, 0};
    static const float radius = 1;

    GLINT_INIT(glint_triangles, ground);
    ground.vertices.data = vertices;
    ground.vertices.count = 4;
    ground.vertices.type = GLINT_F64;
    ground.indices.data = indices;
    ground.indices.count = 2;
    ground.indices.type = GLINT_U32;
    if (failed(glint_scene_add_triangles(scene, &ground, NULL))) return 1;

    GLINT_INIT(glint_spheres, spheres);
    spheres.centers.data = center;
    spheres.centers.count = 1;
    spheres.centers.type = GLINT_F64;
    spheres.radii.data = &radius;
    spheres.radii.count = 1;
    spheres.radii.type = GLINT_F32;
    if (failed(glint_scene_add_spheres(scene, &spheres, NULL))) return 1;
    return failed(glint_scene_commit(scene));
}

static int cast(const glint_scene* scene) {
    enum { kRays = 3 };
    static const double origins[kRays][3] = {{1e6, 9, 0}, {1e6 + 3, 9, 0}, {1e6 + 8, 9, 0}};
    static const float down[3] = {0, -1, 0}; /* for all rays */
    double t[kRays];
    uint32_t geometry[kRays];
    int i;

    GLINT_INIT(glint_rays, rays);
    rays.origins.data = origins;
    rays.origins.count = kRays;
    rays.origins.type = GLINT_F64;
    rays.directions.data = down;
    rays.directions.count = 1;
    rays.directions.type = GLINT_F32;

    GLINT_INIT(glint_hits, hits); /* outputs without a pointer are not computed */
    hits.t.data = t;
    hits.t.count = kRays;
    hits.t.type = GLINT_F64;
    hits.geometry.data = geometry;
    hits.geometry.count = kRays;
    hits.geometry.type = GLINT_U32;
    if (failed(glint_query_closest(scene, &rays, &hits, NULL))) return 1;
    for (i = 0; i < kRays; ++i) {
        if (geometry[i] == GLINT_NONE) {
            printf("ray %d: nothing\n", i);
        } else {
            printf("ray %d: geometry %u at %.3f\n", i, geometry[i], t[i]);
        }
    }
    return 0;
}

int main(int count, char** arguments) {
    glint_device* device = NULL;
    glint_scene* scene = NULL;
    int bad = failed(glint_device_open(count > 1 ? arguments[1] : NULL, &device)) ||
              failed(glint_scene_create(device, &scene)) || fill(scene) || cast(scene);
    glint_scene_release(scene);
    glint_device_release(device);
    return bad;
}
