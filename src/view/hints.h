// What somebody who has never seen the window needs to know: shown until it has been done once.
#pragma once

#include <array>
#include <filesystem>

#include "core/enum_names.h"

namespace glint::view {

enum class Hint { Turn, Pick, Save, Compare };
constexpr auto entriesOf(Hint) {
    return std::to_array<EnumEntry<Hint>>(
        {{Hint::Turn, "turn", "Drag: turn around. Wheel: nearer."},
         {Hint::Pick, "pick", "Click: what is there, and where its light comes from."},
         {Hint::Save, "save", "S: save the picture."},
         {Hint::Compare, "compare", "K: keep the picture. Change something, then B: compare."}});
}

class Hints {
  public:
    // `file` holds what was done, by earlier windows too; empty: nothing is remembered. That it cannot be
    // read or written is no error.
    explicit Hints(std::filesystem::path file = {});

    bool wanted(Hint hint) const { return !done_[static_cast<size_t>(hint)]; }
    bool any() const;
    // True if that was the last of them.
    bool done(Hint hint);
    // None is wanted any more.
    void close();

  private:
    void remember() const;

    std::filesystem::path file_;
    std::array<bool, kEnumNames<Hint>.size()> done_{};
};

}  // namespace glint::view
