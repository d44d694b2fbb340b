// Who draws which unit of a picture, and who draws it if he dies, hangs or is slow. Knows nothing of clocks,
// processes and networks: those who call say who asks, and when.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

namespace glint::farm {

class HandOut {
  public:
    // Units are numbered from 1. Those more than `window` beyond the first that is not settled have to wait,
    // so that what comes before its turn has room.
    HandOut(int units, int window);

    // A unit for `who`, at `now` seconds: the first that nobody has; if there is none, the one that has been
    // drawn longest by one other alone, if that is three times as long as units take on average. It has the
    // same bits, whoever draws it.
    std::optional<int> next(int who, double now);

    // False if the unit was done before.
    bool done(int unit, int who, double now);
    // It needs no room any more.
    void settle(int unit);
    // What `who` had is nobody's.
    void lose(int who);

    bool holds(int unit, int who) const {
        return units_[static_cast<size_t>(unit) - 1].holders.contains(who);
    }
    bool isDone(int unit) const { return units_[static_cast<size_t>(unit) - 1].done; }
    int doneCount() const { return doneCount_; }
    bool complete() const { return doneCount_ == static_cast<int>(units_.size()); }

  private:
    struct Unit {
        bool done = false, settled = false;
        std::map<int, double> holders;  // and since when
    };
    std::optional<int> slowest(int who, double now) const;

    std::vector<Unit> units_;
    std::set<int> free_;  // neither done nor anybody's
    int window_;
    int settledBelow_ = 1;  // all units below this number are settled
    int doneCount_ = 0;
    double seconds_ = 0;  // that the units took that are done
};

}  // namespace glint::farm
