// Which moment of an animation is shown, and how it goes on.
#pragma once

#include <optional>

#include "scene/scene.h"

namespace glint::view {

class Timeline {
  public:
    // Takes the span of the scene that is shown; without a span nothing moves. The moment stays, and so does
    // a rate that the user has chosen.
    void follow(const std::optional<AnimationSpan>& span);
    bool any() const { return span_.has_value(); }

    // The moment that is wanted, in seconds; empty: the scene as its file says it.
    std::optional<double> time() const { return time_; }
    void setTime(std::optional<double> time);  // stops there
    // The frame nearest to the moment, counted as by `glint render --frames`.
    int frame() const;
    // Frames of the first and the last keyframe.
    int first() const;
    int last() const;

    double rate() const { return rate_ ? *rate_ : span_ ? span_->framesPerSecond : 24; }  // frames a second
    void setRate(double rate);
    bool loops() const { return loops_; }
    void setLoops(bool loops) { loops_ = loops; }

    // `now`: of any clock, in seconds. Playing begins at the time that is shown, or at 0 after the end.
    bool playing() const { return playing_; }
    void play(double now);
    void toggle(double now) { playing_ ? void(playing_ = false) : play(now); }
    // True if there is another moment to show. Frames that come too late are left out.
    bool advance(double now);

    // All of them stop playing. Not farther than the ends.
    void goTo(int frame);
    void step(int frames);

  private:
    std::optional<AnimationSpan> span_;
    std::optional<double> time_, rate_;
    bool playing_ = false, loops_ = true;
    double position_ = 0, since_ = 0;  // while playing: the moment between frames, and when it was reached
};

}  // namespace glint::view
