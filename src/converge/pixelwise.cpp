#include "converge/pixelwise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "converge/bounds.h"
#include "converge/replicates.h"
#include "core/error.h"
#include "core/stopwatch.h"

namespace glint::converge {

namespace {

// Pixels of a tile's side: small enough that what has settled is left alone, large enough that a draw is more
// work than its start.
constexpr int kTile = 64;

struct Tile {
    Region region;
    std::vector<std::array<BoundedMean, 3>> means;
    std::vector<double> alphas;  // sums
    uint32_t taken = 0;
    size_t unsettled = 0;
    double widest = 1;  // of the pixels' half widths, in units of the bound
};

class PixelLoop {
  public:
    PixelLoop(const Draw& draw, const Job& job)
        : draw_(draw),
          job_(job),
          // Each channel of each pixel by itself; no share for looking often, the sequence allows it.
          tail_((1 - job.target.confidence) / 3) {
        whole_ = regionOf(job.request);
        for (int y = whole_.y0; y < whole_.y1; y += kTile)
            for (int x = whole_.x0; x < whole_.x1; x += kTile) addTile(x, y);
    }

    Result run() {
        if (!std::isfinite(job_.radianceBound))
            throw Error(ErrorKind::Argument,
                        "--measure pixel needs a bound of what a ray may bring, and none is known for this "
                        "scene: lights that fall off with the square of the distance may be as near as they "
                        "like, and media that amplify; --measure rmse needs none");
        for (;;) {
            if (state_.rounds > 0 && isOver(Stop::Samples)) return finished(Stop::Samples);
            if (state_.rounds > 0 && isOver(Stop::Seconds)) return finished(Stop::Seconds);
            if (!round()) return finished(Stop::Interrupted);
            if (state_.rounds == 1) checkReachable(draw_, job_, state_.budget);
            if (job_.report) job_.report(state_);
            if (state_.unsettled == 0) return finished(Stop::Reached);
        }
    }

  private:
    void addTile(int x, int y) {
        Tile tile;
        tile.region = {x, y, std::min(x + kTile, whole_.x1), std::min(y + kTile, whole_.y1)};
        const auto pixels = static_cast<size_t>(tile.region.width()) * tile.region.height();
        tile.means.resize(pixels);
        tile.alphas.resize(pixels);
        tile.unsettled = pixels;
        tiles_.push_back(std::move(tile));
    }

    bool isOver(Stop why) const {
        if (why == Stop::Samples) return state_.samplesPerPixel >= job_.target.maxSamples;
        return watch_.seconds() * (1 + 1.0 / state_.rounds) > job_.target.maxSeconds;
    }

    // One sample of every pixel of the tiles that have not settled: the first time of the whole picture,
    // which shows what the fixed parts are.
    bool round() {
        ImageSettings image = job_.image;
        image.seed = seedOf(job_.image.seed, state_.rounds);
        image.sampler = Sampler::Jittered;  // of one cell: independent and uniform
        Request request = job_.request;
        request.samples = SampleSequence(image).next(1);
        if (state_.rounds == 0) {
            const Picture picture = draw_(request);
            if (!picture.complete) return false;
            ledger_.add(picture, 1);
            state_.budget.rounding = job_.rounding;
            state_.budget.depthCounts = job_.target.depthCounts;
            ledger_.writeTo(state_.budget, Measure::Pixel);
            for (Tile& tile : tiles_) take(tile, picture);
        } else {
            request.data = request.cost = request.ledger = false;
            for (Tile& tile : tiles_) {
                if (tile.unsettled == 0) continue;
                request.region = tile.region;
                const Picture picture = draw_(request);
                if (!picture.complete) return false;
                take(tile, picture);
            }
        }
        ++state_.rounds;
        judge();
        return true;
    }

    void take(Tile& tile, const Picture& picture) {
        const double bound = std::max(job_.radianceBound, 1e-30);
        ++tile.taken;
        size_t i = 0;
        for (int y = tile.region.y0; y < tile.region.y1; ++y) {
            for (int x = tile.region.x0; x < tile.region.x1; ++x, ++i) {
                const float* pixel = &picture.color.pixels[picture.indexOf(x, y) * 4];
                // Rounded sums may lie beyond the bound by their last digits; what is not finite says nothing
                // and keeps its pixel unsettled.
                for (size_t c = 0; c < 3; ++c)
                    if (std::isfinite(pixel[c]))
                        tile.means[i][c].add(std::clamp(pixel[c] / bound, 0.0, 1.0), tail_);
                tile.alphas[i] += pixel[3];
            }
        }
    }

    double widthOf(const std::array<BoundedMean, 3>& pixel) const {
        double width = 0;
        for (const BoundedMean& channel : pixel) width = std::max(width, channel.halfWidth(tail_));
        return width * job_.radianceBound;
    }

    void judge() {
        const double allowed = job_.target.error - state_.budget.fixed();
        size_t unsettled = 0, pixels = 0;
        double widest = 0;
        for (Tile& tile : tiles_) {
            if (tile.unsettled > 0) {
                tile.unsettled = 0;
                tile.widest = 0;
                for (const auto& pixel : tile.means) {
                    const double width = widthOf(pixel);
                    tile.widest = std::max(tile.widest, width);
                    if (!(width <= allowed)) ++tile.unsettled;
                }
            }
            unsettled += tile.unsettled;
            pixels += tile.means.size();
            widest = std::max(widest, tile.widest);
            state_.samplesPerPixel = std::max(state_.samplesPerPixel, tile.taken);
        }
        state_.budget.sampling = widest;
        state_.unsettled = pixels > 0 ? static_cast<double>(unsettled) / static_cast<double>(pixels) : 0;
    }

    Result finished(Stop stop) const {
        Result result;
        static_cast<State&>(result) = state_;
        result.stop = stop;
        result.picture = blankPicture(job_.request);
        Picture& picture = result.picture;
        picture.complete = state_.rounds > 0;
        if (state_.rounds == 0) return result;
        std::fill(picture.done.begin(), picture.done.end(), uint8_t{1});
        ledger_.writeTo(picture);
        picture.samplesPerPixel = state_.samplesPerPixel;
        picture.samples.resize(picture.done.size());
        picture.errors.resize(picture.done.size());
        for (const Tile& tile : tiles_) writeTile(tile, picture);
        return result;
    }

    void writeTile(const Tile& tile, Picture& picture) const {
        size_t i = 0;
        for (int y = tile.region.y0; y < tile.region.y1; ++y) {
            for (int x = tile.region.x0; x < tile.region.x1; ++x, ++i) {
                const size_t to = picture.indexOf(x, y);
                float* pixel = &picture.color.pixels[to * 4];
                for (size_t c = 0; c < 3; ++c)
                    pixel[c] = static_cast<float>(tile.means[i][c].mean() * job_.radianceBound);
                pixel[3] = static_cast<float>(tile.alphas[i] / tile.taken);
                picture.samples[to] = tile.taken;
                picture.errors[to] = static_cast<float>(widthOf(tile.means[i]));
            }
        }
    }

    const Draw& draw_;
    const Job& job_;
    double tail_;
    Region whole_;
    std::vector<Tile> tiles_;
    Ledger ledger_;
    State state_;
    Stopwatch watch_;
};

}  // namespace

Result convergePixels(const Draw& draw, const Job& job) {
    return PixelLoop(draw, job).run();
}

}  // namespace glint::converge
