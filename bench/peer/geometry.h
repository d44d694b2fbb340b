// A scene's surfaces in Embree, and what single rays find there.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <deque>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "pack/packed_scene.h"
#include "peer/materials.h"

namespace glint::bench::peer {

struct Ray {
    glm::vec3 origin, direction;
    float tNear = 0, tFar = std::numeric_limits<float>::infinity();
};

// The dielectrics that a ray is inside of.
struct Media {
    static constexpr int kMost = 4;
    uint32_t list[kMost];
    int count = 0;
};

// Triangles, spheres and discs are Embree's; what is flat otherwise is triangles, bodies that a transform
// stretches are its instances, and planes, which no box holds, are tested one by one. Coordinates are
// relative to `origin`.
class Geometry {
  public:
    // Throws std::invalid_argument for surfaces that Embree has nothing for: quadrics, and polygons that
    // cross themselves. Keeps references to both.
    Geometry(const Scene& scene, const Materials& materials, const glm::dvec3& origin);
    ~Geometry();
    Geometry(const Geometry&) = delete;
    Geometry& operator=(const Geometry&) = delete;

    bool intersect(const Ray& ray, Surface& surface) const;
    // The share of light that reaches the end of a ray, which begins in these media: 0 or 1 but for
    // dielectrics.
    glm::vec3 passes(const Ray& ray, const Media& media) const;
    double buildSeconds() const { return buildSeconds_; }

  private:
    enum class Kind { Spheres, Discs, Flats, Mesh };
    // What one primitive is to shading. `normal` and `center` are in the coordinates of its Embree scene.
    struct Item {
        uint32_t frame = 0, material = 0;
        glm::vec3 normal{0, 1, 0}, center{0};
        bool byCorners = false;  // (u, v) are those of a triangle
        bool swapped = false;    // its second and third corner
    };
    // An Embree geometry.
    struct Part {
        const Geometry* owner = nullptr;
        Kind kind = Kind::Mesh;
        std::vector<Item> items;  // by Embree's primitive; of a mesh one alone
        std::shared_ptr<const Mesh> mesh;
        std::vector<glm::vec3> normals;  // of a mesh
        bool filtered = false;           // has masks or dielectrics
    };
    // An object that is another geometry's instance.
    struct Instance {
        const Part* part = nullptr;
        uint32_t frame = 0, material = 0;
        glm::mat3 linear{1}, normalMatrix{1};
        glm::vec3 offset{0};
    };
    struct Found {  // a hit as Embree reports it
        const Part* part = nullptr;
        const Instance* instance = nullptr;
        uint32_t primitive = 0;
        float u = 0, v = 0;
        glm::vec3 normal{0};  // outward, of any length, in the coordinates of its Embree scene
        glm::vec3 point{0};   // in those of all
    };
    struct Shadow;

    Item itemOf(const Object& object);
    void add(const Object& object);
    void addTriangle(const Item& item, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
    void addPolygon(const Object& object);
    void addBox(const Object& object);
    void addMesh(const Object& object);
    void addInstance(const Object& object, RTCScene prototype, const Part& part, const Affine& transform);
    // A scene that holds one unit ball, unit disc or mesh.
    RTCScene prototypeOf(const Object& object, const Part*& part);
    RTCGeometry meshGeometry(Part& part, const Affine& place);
    RTCGeometry pointGeometry(const Part& part, const std::vector<glm::vec4>& rows,
                              const std::vector<glm::vec3>& normals);
    RTCGeometry flatGeometry();
    // Its number in `scene`; the geometry is released.
    uint32_t attach(RTCScene scene, RTCGeometry geometry, Part& part);
    bool open(uint32_t material) const;
    bool seenThrough(const Part& part) const;

    Surface surfaceOf(const Found& found, float t) const;
    void placeTexture(const Item& item, Surface& surface) const;
    void surfaceOfMesh(const Found& found, Surface& surface) const;
    uint32_t materialOf(const Found& found) const;
    bool intersectPlane(const Item& plane, const Ray& ray, float tFar, Surface& surface) const;
    static void filterHit(const RTCFilterFunctionNArguments* arguments);
    static void filterShadow(const RTCFilterFunctionNArguments* arguments);
    Found foundBy(const RTCFilterFunctionNArguments& arguments, const Part& part, float t) const;

    const Scene& scene_;
    const Materials& materials_;
    glm::dvec3 origin_;
    bool colored_;
    std::vector<shared::ObjectFrame> frames_;
    std::deque<Part> parts_;
    std::vector<const Part*> partOf_;  // by geometry of the whole scene; null: an instance
    std::vector<Instance> instances_;
    std::vector<uint32_t> instanceOf_;  // by geometry
    std::vector<Item> planes_;
    Part spheres_, discs_, flats_;
    std::vector<glm::vec4> sphereRows_, discRows_;  // centre and radius
    std::vector<glm::vec3> discNormals_, flatVertices_;
    std::map<const void*, std::pair<RTCScene, const Part*>> prototypes_;  // by mesh, or a name for the others
    RTCDevice device_ = nullptr;
    RTCScene embree_ = nullptr;
    double buildSeconds_ = 0;
};

}  // namespace glint::bench::peer
