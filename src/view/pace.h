// How coarse a picture must be while the camera moves, so that it comes in time.
#pragma once

namespace glint::view {

class Pace {
  public:
    explicit Pace(double targetSeconds) : target_(targetSeconds) {}

    double target() const { return target_; }
    void setTarget(double seconds) { target_ = seconds; }

    // A frame of `pixels` took `renderSeconds` to trace, and everything else `otherSeconds`.
    void measured(double pixels, double renderSeconds, double otherSeconds);

    // Width and height to render, as a part of those of a window of `fullPixels`: kLeast..1.
    double scale(double fullPixels) const;
    // Reflections to follow out of `maxDepth`: fewer once the resolution has had to fall.
    int depth(int maxDepth, double fullPixels) const;

    static constexpr double kLeast = 0.125;

  private:
    double target_;
    double secondsPerPixel_ = 0;  // 0: nothing measured yet
    double other_ = 0;
};

}  // namespace glint::view
