#include "app/losses.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/common.h"

namespace glint::app {

namespace {

// Below half a step of an 8-bit picture nothing is seen; with the sRGB curve's slope of up to 12.92 the steps
// of dark colours are smaller, but there a loss of this size is one of a bright branch.
constexpr double kVisible = 1.0 / 255;

double meanOf(const LostBranches& lost, const Picture& picture) {
    const auto pixels = static_cast<double>(picture.done.size());
    return pixels > 0 ? lost.sum / pixels : 0;
}

// Numbers that are not finite become null.
nlohmann::json lostJson(const LostBranches& lost, const Picture& picture) {
    return {{"branches", lost.count}, {"meanBound", meanOf(lost, picture)}, {"greatestBound", lost.greatest}};
}

std::string boundText(const LostBranches& lost, const Picture& picture) {
    if (!std::isfinite(lost.greatest)) return "how much light that is, is not known";
    return format("a pixel lacks at most %.3g, on average at most %.3g", lost.greatest,
                  meanOf(lost, picture));
}

}  // namespace

nlohmann::json lossesJson(const Picture& picture) {
    const TreeLosses& losses = picture.losses;
    return {{"cut", lostJson(losses.cut, picture)},
            {"maxDepth", lostJson(losses.depth, picture)},
            {"waiting", lostJson(losses.room, picture)},
            {"crowdedMedia", losses.crowdedMedia}};
}

void warnOfLosses(const Picture& picture, const std::string& start, std::ostream& err) {
    const TreeLosses& losses = picture.losses;
    const auto branches = [](uint64_t count) {
        return std::to_string(count) + (count == 1 ? " branch" : " branches");
    };
    if (losses.cut.count > 0)
        err << start << "--min-contribution cut " << branches(losses.cut.count) << "; "
            << boundText(losses.cut, picture) << '\n';
    if (losses.depth.greatest > kVisible)
        err << start << branches(losses.depth.count)
            << " beyond maxDepth not followed (increase --max-depth); " << boundText(losses.depth, picture)
            << '\n';
    if (losses.room.count > 0)
        err << start << branches(losses.room.count) << " dropped, as " << shared::kMaxWaiting
            << " others were waiting already; " << boundText(losses.room, picture) << '\n';
    if (losses.crowdedMedia > 0)
        err << start << "rays inside " << shared::kMaxMedia << " media at a time passed "
            << counted(losses.crowdedMedia, "surface") << " of more as if they were not there\n";
}

}  // namespace glint::app
