// Which of a slice's paths the next kernels run over.
#pragma once

#include <cstdint>

#include "core/enum_names.h"
#include "shared/dispatch.h"

namespace glint::render {

enum class Compaction {
    Auto,  // where it pays, see LivePaths
    On,    // after every bounce, the paths that go on alone
    Off    // every kernel runs over all paths of the slice, those that have ended too
};
constexpr auto entriesOf(Compaction) {
    return std::to_array<EnumEntry<Compaction>>(
        {{Compaction::Auto, "auto"}, {Compaction::On, "on"}, {Compaction::Off, "off"}});
}

// All paths of a slice, until it pays to go by the list of those that go on, which `shade` writes.
class LivePaths {
  public:
    LivePaths(Compaction compaction, uint32_t paths) : compaction_(compaction), running_(paths) {}

    // After a bounce from which `alive` paths go on.
    void bounced(uint32_t alive);
    // Workgroups to dispatch.
    uint32_t groups() const;
    // Tells the kernels.
    void writeTo(shared::Dispatch& dispatch) const;

  private:
    Compaction compaction_;
    uint32_t running_;  // invocations that have a path, alive or not
    bool listed_ = false;
    uint32_t list_ = 0;  // the list that is read, if listed
};

}  // namespace glint::render
