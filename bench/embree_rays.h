// Embree's side of the comparison.
#pragma once

#include <embree3/rtcore.h>

#include <vector>

#include "pack/packed_scene.h"
#include "rays.h"

namespace glint::bench {

enum class EmbreeCall { Single, Packet8, Packet16 };

// The triangles and spheres of a packed scene in an Embree scene of medium build quality. A scene that
// has primitives of other kinds is refused (std::invalid_argument).
class EmbreeRays {
  public:
    explicit EmbreeRays(const PackedScene& scene);
    ~EmbreeRays();
    EmbreeRays(const EmbreeRays&) = delete;
    EmbreeRays& operator=(const EmbreeRays&) = delete;

    double buildSeconds() const { return buildSeconds_; }
    // Traces on two threads that take blocks of tiles from a common counter. Packets are flagged coherent.
    Timing trace(const std::vector<BenchRay>& rays, bool any, EmbreeCall call,
                 std::vector<BenchHit>& hits) const;

  private:
    void addTriangles(const PackedScene& scene);
    void addSpheres(const PackedScene& scene);
    uint32_t idOf(uint32_t geometry, uint32_t primitive) const;

    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::vector<uint32_t> triangleIds_, sphereIds_;
    uint32_t triangleGeometry_ = RTC_INVALID_GEOMETRY_ID;
    double buildSeconds_ = 0;
};

}  // namespace glint::bench
