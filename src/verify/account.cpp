#include "verify/account.h"

#include <algorithm>

namespace glint::verify {

void Account::addAlike(const reference::Losses& lost, double weight) {
    const auto add = [&](Kind& kind, const reference::Lost& one) {
        kind.count += one.count;
        kind.bound += one.bound * weight;
    };
    add(cut_, lost.cut);
    add(depth_, lost.depth);
    add(room_, lost.room);
    crowded_ += lost.crowdedMedia;
    greatestWeight_ = std::max(greatestWeight_, weight);
}

void Account::addOther(uint32_t bounces, double weight) {
    const uint64_t branches = 2 * (uint64_t{bounces} + 1);
    other_.count += branches;
    other_.bound += static_cast<double>(branches) * radianceBound_ * weight;
    greatestWeight_ = std::max(greatestWeight_, weight);
}

void Account::add(const Account& other) {
    const auto add = [](Kind& kind, const Kind& more) {
        kind.count += more.count;
        kind.bound += more.bound;
    };
    add(cut_, other.cut_);
    add(depth_, other.depth_);
    add(room_, other.room_);
    add(other_, other.other_);
    crowded_ += other.crowded_;
    greatestWeight_ = std::max(greatestWeight_, other.greatestWeight_);
}

// Counts are exact, but for what may be decided otherwise. Bounds are products of weights, which are judged
// pixel by pixel where they count: here it is enough that the sum is right to a 256th, and each of them to a
// 16,384th of the greatest that there may be. Where that is near the greatest floats the device may say
// infinity.
bool Account::agrees(const Kind& kind, const LostBranches& device, uint64_t otherwise) const {
    const uint64_t most = kind.count + other_.count + otherwise;
    if (device.count + otherwise < kind.count || device.count > most) return false;
    const double greatest = radianceBound_ * greatestWeight_;
    if (!(greatest * static_cast<double>(most) < 0x1p120)) return true;
    const double room = kind.bound / 256 + greatest * (0x1p-14 * static_cast<double>(device.count) +
                                                       static_cast<double>(otherwise));
    return device.sum >= kind.bound - room && device.sum <= kind.bound + room + other_.bound &&
           device.sum <= 1.001 * greatest * static_cast<double>(device.count);
}

bool Account::agrees(const TreeLosses& device, uint64_t otherwise) const {
    const uint64_t branches = 2 * otherwise;
    return agrees(cut_, device.cut, branches) && agrees(depth_, device.depth, branches) &&
           agrees(room_, device.room, branches) && device.crowdedMedia + otherwise >= crowded_ &&
           device.crowdedMedia <= crowded_ + other_.count / 2 + otherwise;
}

}  // namespace glint::verify
