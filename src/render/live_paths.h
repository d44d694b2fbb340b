// Which of a slice's paths the next kernels run over.
#pragma once

#include <cstdint>

#include "shared/dispatch.h"

namespace glint::render {

// All paths of a slice until one has ended, then the paths in the list that `shade` wrote.
class LivePaths {
  public:
    explicit LivePaths(uint32_t paths) : running_(paths) {}

    // Call after each bounce; `alive` paths continue.
    void bounced(uint32_t alive);
    // Workgroups to dispatch.
    uint32_t groups() const;
    // Writes the arguments that select these paths in the kernels.
    void writeTo(shared::Dispatch& dispatch) const;

  private:
    uint32_t running_;  // invocations that have a path, alive or not
    bool listed_ = false;
    uint32_t list_ = 0;  // the list that is read, if listed
};

}  // namespace glint::render
