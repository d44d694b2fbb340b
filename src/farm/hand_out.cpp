#include "farm/hand_out.h"

#include <algorithm>

namespace glint::farm {

namespace {

constexpr double kPatience = 3;  // times what a unit takes on average

}  // namespace

HandOut::HandOut(int units, int window) : units_(static_cast<size_t>(units)), window_(std::max(1, window)) {
    for (int unit = 1; unit <= units; ++unit) free_.insert(free_.end(), unit);
}

std::optional<int> HandOut::slowest(int who, double now) const {
    if (doneCount_ == 0) return std::nullopt;
    const double patience = kPatience * seconds_ / doneCount_;
    std::optional<int> found;
    double since = now - patience;
    const int end = std::min(static_cast<int>(units_.size()), settledBelow_ + window_ - 1);
    for (int unit = settledBelow_; unit <= end; ++unit) {
        const Unit& u = units_[static_cast<size_t>(unit) - 1];
        if (u.done || u.holders.size() != 1 || u.holders.contains(who)) continue;
        if (u.holders.begin()->second > since) continue;
        since = u.holders.begin()->second;
        found = unit;
    }
    return found;
}

std::optional<int> HandOut::next(int who, double now) {
    std::optional<int> unit;
    if (!free_.empty() && *free_.begin() < settledBelow_ + window_)
        unit = *free_.begin();
    else
        unit = slowest(who, now);
    if (!unit) return unit;
    free_.erase(*unit);
    units_[static_cast<size_t>(*unit) - 1].holders[who] = now;
    return unit;
}

bool HandOut::done(int unit, int who, double now) {
    Unit& u = units_[static_cast<size_t>(unit) - 1];
    const auto held = u.holders.find(who);
    const double began = held == u.holders.end() ? now : held->second;
    if (u.done) return false;
    u.done = true;
    u.holders.clear();
    free_.erase(unit);
    ++doneCount_;
    seconds_ += std::max(0.0, now - began);
    return true;
}

void HandOut::settle(int unit) {
    units_[static_cast<size_t>(unit) - 1].settled = true;
    while (settledBelow_ <= static_cast<int>(units_.size()) &&
           units_[static_cast<size_t>(settledBelow_) - 1].settled)
        ++settledBelow_;
}

void HandOut::lose(int who) {
    for (size_t i = 0; i < units_.size(); ++i) {
        Unit& u = units_[i];
        if (u.holders.erase(who) > 0 && u.holders.empty() && !u.done) free_.insert(static_cast<int>(i) + 1);
    }
}

}  // namespace glint::farm
