// What a user describes: plain data in double precision, world space, right-handed, y up, colours linear RGB.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace glint {

using Color = glm::dvec3;  // linear RGB radiance or reflectance

struct ImageSettings {
    int width = 800;   // pixels, 1..65536
    int height = 600;  // pixels, 1..65536
    int samplesPerPixel = 1;
};

// The part of the image plane that the picture shows (Shirley & Marschner, Fundamentals of Computer Graphics,
// ch. 4): left, right along u, bottom, top along v, from where the view direction meets the plane. The plane
// of a perspective camera lies at unit distance along the view direction, that of an orthographic one holds
// the eye.
struct ViewWindow {
    double left = -1, right = 1, bottom = -1, top = 1;
};

// Rays from the eye through the image plane, or parallel rays from the image plane.
enum class Projection { Perspective, Orthographic };

struct Camera {
    Projection projection = Projection::Perspective;
    glm::dvec3 eye{0, 0, 5};
    glm::dvec3 target{0, 0, 0};
    glm::dvec3 up{0, 1, 0};
    // Of the image plane, either side. Absent: the view direction. Given: an oblique camera, neither zero nor
    // perpendicular to the view direction.
    std::optional<glm::dvec3> planeNormal;
    double fovY = 40;                  // perspective: degrees, vertical, in (0, 180)
    double height = 4;                 // orthographic: of the window, > 0
    std::optional<ViewWindow> window;  // overrides fovY and height; its aspect need not be the picture's
    // Camera rays have unit directions, so these bound the distance from where a ray starts: the eye, or the
    // image plane of an orthographic camera. 0 <= near < far.
    double nearT = 0;
    double farT = std::numeric_limits<double>::infinity();
};

struct PointLight {
    glm::dvec3 position{0};
    Color intensity{1};
    bool inverseSquare = false;  // falloff: intensity / distance^2 instead of intensity
};

struct DirectionalLight {
    glm::dvec3 direction{0, -1, 0};  // the way the light travels; need not be unit length, not zero
    Color intensity{1};
};

// A point light behind a round opening: full light up to `angle` from the axis, none from angle + penumbra
// on.
struct SpotLight {
    glm::dvec3 position{0};
    glm::dvec3 direction{0, -1, 0};  // the axis, the way the light travels; need not be unit length, not zero
    double angle = 30;               // degrees, >= 0
    double penumbra = 0;             // degrees, >= 0; angle + penumbra in [kMinSpotAngle, 180]
    Color intensity{1};
    bool inverseSquare = false;
};

using Light = std::variant<PointLight, DirectionalLight, SpotLight>;

// L = ambient Ia + sum Ii [diffuse max(0, n.l) + specular max(0, n.h)^shininess] + mirror L_reflected
// (Blinn 1977; Whitted 1980)
struct Material {
    std::string name;
    Color ambient{0.8};
    Color diffuse{0.8};
    Color specular{0};
    double shininess = 32;  // >= 0
    Color mirror{0};        // each channel in [0, 1]
};

// Polygons already split into triangles. `corners` index `positions`; `normalCorners` index `normals` and is
// either empty (no vertex normals at all) or as long as `corners`, with kNoIndex thrice for a triangle
// without normals.
struct Mesh {
    static constexpr uint32_t kNoIndex = 0xffffffffu;
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;  // need not be unit length
    std::vector<glm::uvec3> corners;  // one per triangle
    std::vector<glm::uvec3> normalCorners;
    std::vector<uint32_t> faces;      // per triangle: its polygon's index in the file; empty: the identity
    std::vector<uint32_t> materials;  // per triangle, into Scene::materials; empty: the object's material
};

struct SphereShape {
    glm::dvec3 center{0};
    double radius = 1;  // > 0
};
struct PlaneShape {
    glm::dvec3 point{0};
    glm::dvec3 normal{0, 1, 0};  // need not be unit length, not zero
};
struct DiscShape {
    glm::dvec3 center{0};
    glm::dvec3 normal{0, 1, 0};  // need not be unit length, not zero
    double radius = 1;           // > 0
};
struct TriangleShape {
    glm::dvec3 vertices[3];
};
// Planar, concave or not, its outline may cross itself: inside is what it goes round an odd number of times.
struct PolygonShape {
    std::vector<glm::dvec3> vertices;  // counter-clockwise seen from outside, see scene/polygon_plane.h
};
struct MeshShape {
    std::shared_ptr<const Mesh> mesh;
};
using Shape = std::variant<SphereShape, PlaneShape, DiscShape, TriangleShape, PolygonShape, MeshShape>;

// `name` is where the object stands in its file ("/objects/3"), for messages.
struct Object {
    std::string name;
    Shape shape;
    uint32_t material = 0;  // index into Scene::materials
};

struct Scene {
    ImageSettings image;
    Camera camera;
    Color background{0};
    Color ambient{0};  // Ia
    int maxDepth = 5;  // greatest number of reflections followed from a camera ray, 0..1000
    std::vector<Light> lights;
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::vector<std::string> warnings;  // one line each: what was ignored or mended while loading
};

}  // namespace glint
