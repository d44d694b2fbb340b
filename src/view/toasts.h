// Messages over the picture that go away by themselves.
#pragma once

#include <deque>
#include <string>

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

    static constexpr double kSeconds = 5;  // to read a line of text and look back at the picture
    static constexpr size_t kMost = 4;

  private:
    std::deque<Toast> toasts_;
};

}  // namespace glint::view
