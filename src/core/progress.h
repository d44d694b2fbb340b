// How far a long computation has come, for a person who waits.
#pragma once

#include <atomic>
#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>

#include "core/enum_names.h"

namespace glint {

enum class ProgressMode {
    Auto,   // Bar on a terminal, otherwise None
    Bar,    // one line that is drawn over itself, at most 10 times a second
    Plain,  // a new line every 2 s or every 10 %, whichever comes first
    None
};
constexpr auto entriesOf(ProgressMode) {
    return std::to_array<EnumEntry<ProgressMode>>({{ProgressMode::Auto, "auto", "a bar on a terminal"},
                                                   {ProgressMode::Bar, "bar"},
                                                   {ProgressMode::Plain, "plain", "a line now and then"},
                                                   {ProgressMode::None, "none"}});
}

// Shows nothing in the first second, so that short computations stay silent. All members may be called from
// any thread; `sink` must outlive the object and is written to under a lock.
class Progress {
  public:
    using Clock = std::function<double()>;  // seconds from any fixed moment

    // `terminal`: whether `sink` is one. `clock`: for tests; empty: the steady clock.
    Progress(std::string label, ProgressMode mode, std::ostream& sink, bool terminal, Clock clock = {});
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // The finished part, in [0, 1]; the display never goes back. Returns at once if nothing is due.
    void update(double fraction);

    // Clears the bar; nothing is shown any more. Called by the destructor.
    void finish();

  private:
    void show(double fraction, double elapsed);
    void drawBar(double fraction, double elapsed);

    const std::string label_;
    const ProgressMode mode_;  // never Auto
    std::ostream& sink_;
    const Clock clock_;
    const double start_;
    std::atomic<double> due_;  // seconds after the start before which update() has nothing to do

    std::mutex mutex_;  // guards what follows and the sink
    bool finished_ = false;
    double fraction_ = 0;
    double lineTime_ = -1e30;  // of the last plain line
    double lineFraction_ = 0;
    size_t barLength_ = 0;  // characters of the bar that are on the screen
};

}  // namespace glint
