#include "core/progress.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "core/format.h"
#include "core/stopwatch.h"

namespace glint {
namespace {

constexpr double kSilence = 1.0;     // seconds at the start
constexpr double kRedraw = 0.1;      // seconds between two updates of the display
constexpr double kLineTime = 2.0;    // seconds between two plain lines
constexpr double kLineParts = 10.0;  // or whenever a part of this many is done
constexpr int kBarWidth = 20;

std::string timeText(double seconds) {
    const auto total = static_cast<long>(seconds);
    return total < 3600 ? format("%ld:%02ld", total / 60, total % 60)
                        : format("%ld:%02ld:%02ld", total / 3600, total / 60 % 60, total % 60);
}

// "47 %  0:12 elapsed, 0:14 left"
std::string statusText(double fraction, double elapsed) {
    const std::string done =
        format("%2d %%  ", static_cast<int>(fraction * 100.0)) + timeText(elapsed) + " elapsed";
    if (fraction < 0.001) return done;  // the estimate would be noise
    return done + ", " + timeText(std::round(elapsed * (1.0 - fraction) / fraction)) + " left";
}

}  // namespace

Progress::Progress(std::string label, ProgressMode mode, std::ostream& sink, bool terminal, Clock clock)
    : label_(std::move(label)),
      mode_(mode != ProgressMode::Auto ? mode
            : terminal                 ? ProgressMode::Bar
                                       : ProgressMode::None),
      sink_(sink),
      clock_(clock ? std::move(clock) : [stopwatch = Stopwatch()] { return stopwatch.seconds(); }),
      start_(clock_()),
      due_(kSilence) {}

Progress::~Progress() {
    finish();
}

void Progress::update(double fraction) {
    if (mode_ == ProgressMode::None) return;
    const double elapsed = clock_() - start_;
    if (elapsed < due_.load(std::memory_order_relaxed)) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    // Another thread is at it, or has just been.
    if (!lock.owns_lock() || elapsed < due_.load(std::memory_order_relaxed) || finished_) return;
    due_.store(elapsed + kRedraw, std::memory_order_relaxed);
    fraction_ = std::max(fraction_, std::isnan(fraction) ? 0.0 : std::clamp(fraction, 0.0, 1.0));
    show(fraction_, elapsed);
}

void Progress::show(double fraction, double elapsed) {
    if (mode_ == ProgressMode::Bar) {
        drawBar(fraction, elapsed);
    } else if (elapsed - lineTime_ >= kLineTime ||
               std::floor(fraction * kLineParts) > std::floor(lineFraction_ * kLineParts)) {
        sink_ << label_ + "  " + statusText(fraction, elapsed) + "\n" << std::flush;
        lineTime_ = elapsed;
        lineFraction_ = fraction;
    }
}

void Progress::drawBar(double fraction, double elapsed) {
    const auto filled = static_cast<size_t>(fraction * kBarWidth);
    std::string line = label_ + "  [" + std::string(filled, '#') + std::string(kBarWidth - filled, '-') +
                       "]  " + statusText(fraction, elapsed);
    const size_t length = line.size();
    // A shorter line must not leave the end of a longer one behind.
    line.resize(std::max(length, barLength_), ' ');
    sink_ << '\r' << line << std::flush;
    barLength_ = length;
}

void Progress::finish() {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    if (barLength_ > 0) {
        sink_ << '\r' << std::string(barLength_, ' ') << '\r' << std::flush;
        barLength_ = 0;
    }
}

}  // namespace glint
