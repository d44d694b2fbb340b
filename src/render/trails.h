// Reads back the rays of chosen pixels after each bounce.
#pragma once

#include <glm/glm.hpp>
#include <unordered_map>
#include <vector>

#include "render/path_limits.h"
#include "render/path_state.h"
#include "trace/trail.h"

namespace glint::render {

class TrailRecorder {
  public:
    explicit TrailRecorder(const std::vector<glm::ivec2>& pixels);
    // Call after the closest hits of a bounce and before its shading; the rows must hold AOVs.
    void add(const PathState& paths, const gpu::Device& device, const Slice& slice);
    std::vector<Trail> take() { return std::move(trails_); }

  private:
    static uint64_t keyOf(const glm::ivec2& pixel);

    std::unordered_map<uint64_t, size_t> places_;
    std::vector<Trail> trails_;
};

}  // namespace glint::render
