// The rays of library_rays, cast by tinybvh (https://github.com/jbikker/tinybvh), one at a time in its 8-wide
// tree for AVX2, by all processors.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace glint::bench {

class TinyBvh {
  public:
    // Three corners for each triangle.
    explicit TinyBvh(const std::vector<glm::vec3>& corners);
    ~TinyBvh();
    // Processor seconds; `hit`: receives 1 for each ray that meets anything.
    double closest(const std::vector<glm::vec3>& origins, const std::vector<glm::vec3>& directions,
                   std::vector<uint8_t>& hit) const;
    double any(const std::vector<glm::vec3>& origins, const std::vector<glm::vec3>& directions,
               std::vector<uint8_t>& hit) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace glint::bench
