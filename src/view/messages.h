// Messages of the window: those that go away by themselves, and the first steps of a new user.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <string>

#include "core/enum_names.h"

namespace glint::view {

enum class ToastKind { Info, Error };

struct Toast {
    std::string text;
    ToastKind kind = ToastKind::Info;
    double until = 0;  // seconds of the clock that add() was told
};

class Toasts {
  public:
    // An error stays twice as long. One that says the same as a shown one replaces it.
    void add(const std::string& text, ToastKind kind, double now);
    // Drops what has expired; true if anything has.
    bool expire(double now);
    void clear() { toasts_.clear(); }
    const std::deque<Toast>& shown() const { return toasts_; }
    // Seconds until the next one goes; negative: there is none.
    double next(double now) const;

    static constexpr double kSeconds = 5;  // to read a line of text and look back at the image
    static constexpr size_t kMost = 4;

  private:
    std::deque<Toast> toasts_;
};

enum class Hint { Turn, Pick, Save, Compare };
constexpr auto entriesOf(Hint) {
    return std::to_array<EnumEntry<Hint>>(
        {{Hint::Turn, "turn", "Drag: turn around. Wheel: nearer."},
         {Hint::Pick, "pick", "Click: what is there, and where its light comes from."},
         {Hint::Save, "save", "S: save the image."},
         {Hint::Compare, "compare", "K: keep the image. Change something, then B: compare."}});
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
