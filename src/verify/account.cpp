#include "verify/account.h"

#include <algorithm>

namespace glint::verify {

void Account::addAlike(const TreeLosses& lost, double weight) {
    alike_.cut.add(lost.cut.count, lost.cut.sum * weight);
    alike_.depth.add(lost.depth.count, lost.depth.sum * weight);
    alike_.room.add(lost.room.count, lost.room.sum * weight);
    alike_.crowdedMedia += lost.crowdedMedia;
    greatestWeight_ = std::max(greatestWeight_, weight);
}

void Account::addOther(uint32_t bounces, double weight) {
    const uint64_t branches = 2 * (uint64_t{bounces} + 1);
    other_.add(branches, static_cast<double>(branches) * radianceBound_ * weight);
    greatestWeight_ = std::max(greatestWeight_, weight);
}

void Account::add(const Account& rows) {
    alike_.add(rows.alike_);
    other_.add(rows.other_);
    greatestWeight_ = std::max(greatestWeight_, rows.greatestWeight_);
}

// Counts are exact, except for pixels that decide otherwise. Bounds are products of weights: their sum must
// be right to a 256th, and each of them to a 16,384th of the greatest possible one. If that is near the
// greatest float, the device may report infinity.
bool Account::agrees(const LostBranches& alike, const LostBranches& device, uint64_t otherwise) const {
    const uint64_t most = alike.count + other_.count + otherwise;
    if (device.count + otherwise < alike.count || device.count > most) return false;
    const double greatest = radianceBound_ * greatestWeight_;
    if (!(greatest * static_cast<double>(most) < 0x1p120)) return true;
    const double room = alike.sum / 256 + greatest * (0x1p-14 * static_cast<double>(device.count) +
                                                      static_cast<double>(otherwise));
    return device.sum >= alike.sum - room && device.sum <= alike.sum + room + other_.sum &&
           device.sum <= 1.001 * greatest * static_cast<double>(device.count);
}

bool Account::agrees(const TreeLosses& device, uint64_t otherwise) const {
    const uint64_t branches = 2 * otherwise;
    return agrees(alike_.cut, device.cut, branches) && agrees(alike_.depth, device.depth, branches) &&
           agrees(alike_.room, device.room, branches) &&
           device.crowdedMedia + otherwise >= alike_.crowdedMedia &&
           device.crowdedMedia <= alike_.crowdedMedia + other_.count / 2 + otherwise;
}

}  // namespace glint::verify
