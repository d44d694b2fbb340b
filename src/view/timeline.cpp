#include "view/timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint::view {

namespace {

constexpr double kMostFrames = 10'000'000;
constexpr double kNear = 1e-6;  // frames: keyframes are written in seconds, and seldom exactly

int whole(double frame) {
    return static_cast<int>(std::clamp(frame, 0.0, kMostFrames));
}

}  // namespace

void Timeline::follow(const std::optional<AnimationSpan>& span) {
    span_ = span;
    if (!span_) playing_ = false;
}

void Timeline::setTime(std::optional<double> time) {
    playing_ = false;
    time_ = time;
}

int Timeline::first() const {
    return span_ ? whole(std::floor(span_->start * rate() + kNear)) : 0;
}
int Timeline::last() const {
    return span_ ? std::max(whole(std::ceil(span_->end * rate() - kNear)), first()) : 0;
}
int Timeline::frame() const {
    return time_ ? whole(std::round(*time_ * rate())) : first();
}

void Timeline::setRate(double rate) {
    rate_ = std::clamp(rate, 1.0, 1000.0);
}

void Timeline::play(double now) {
    if (!span_ || first() == last()) return;
    if (!time_ || frame() >= last() || frame() < first()) goTo(first());
    playing_ = true;
    position_ = *time_;
    since_ = now;
}

// A loop ends where it begins, so its last frame is left out: it is the first one, or is over at once.
bool Timeline::advance(double now) {
    if (!playing_) return false;
    position_ += now - std::exchange(since_, now);
    const double begin = first() / rate(), end = last() / rate();
    if (loops_)
        position_ = begin + std::fmod(position_ - begin, std::max(end - begin, 1 / rate()));
    else if (position_ >= end)
        playing_ = false;
    const int frame = std::min(whole(std::floor(position_ * rate() + kNear)), last());
    return std::exchange(time_, frame / rate()) != frame / rate();
}

void Timeline::goTo(int frame) {
    if (!span_) return;
    setTime(std::clamp(frame, first(), last()) / rate());
}

void Timeline::step(int frames) {
    if (!time_) return goTo(frames > 0 ? first() : last());
    const double at = *time_ * rate();
    goTo(whole(frames > 0 ? std::floor(at + kNear) + frames : std::ceil(at - kNear) + frames));
}

}  // namespace glint::view
