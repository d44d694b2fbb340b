// A tracer whose truth is known.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "converge/converge.h"
#include "pack/pack_samples.h"

namespace glint::converge {

inline constexpr int kSide = 40;

// A pixel's expectation, and a sample of it by a number from [0, 1).
struct Film {
    std::function<double(int x, int y)> truth;
    std::function<double(int x, int y, double random)> sample;
};

// splitmix64 (Steele, Lea, Flood 2014) of the sample's and the pixel's numbers.
inline double uniform(uint64_t seed, uint64_t sample, uint64_t pixel) {
    uint64_t z = (seed << 32 | sample) + 0x9e3779b97f4a7c15u * (pixel + 1);
    for (int i = 0; i < 2; ++i) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
    }
    return std::ldexp(static_cast<double>(z >> 11), -53);
}

// An edge that covers a part of each pixel of a column, and flat pixels around it.
inline Film edgeFilm() {
    const auto truth = [](int x, int) { return x % 8 == 0 ? 0.3 : 0.5; };
    return {truth, [truth](int x, int y, double random) {
                if (x % 8 != 0) return truth(x, y);
                return random < 0.3 ? 1.0 : 0.0;
            }};
}

// Samples are random by their seed, place and number, as a tracer's are.
inline Picture drawn(const Film& film, const Request& request) {
    Picture picture = blankPicture(request);
    const auto& rows = request.samples.rows;
    const Region r = picture.region;
    for (int y = r.y0; y < r.y1; ++y) {
        for (int x = r.x0; x < r.x1; ++x) {
            double sum = 0;
            for (size_t i = shared::kFirstSample; i < rows.size(); ++i) {
                const auto number = static_cast<uint64_t>(y) * request.width + x;
                sum += film.sample(x, y, uniform(rows[i].seed, rows[i].x ^ rows[i].key, number));
            }
            const size_t at = picture.indexOf(x, y);
            for (int c = 0; c < 3; ++c)
                picture.color.pixels[at * 4 + c] = static_cast<float>(sum / request.samples.count());
            picture.done[at] = 1;
        }
    }
    return picture;
}

inline Draw drawOf(const Film& film) {
    return [film](const Request& request) { return drawn(film, request); };
}

inline Job jobOf(double error, uint32_t seed = 0) {
    Job job;
    job.request.width = job.request.height = kSide;
    job.request.width = job.request.height = kSide;
    job.request.seed = seed;
    job.request.limits.depth = 5;
    job.target.error = error;
    return job;
}

}  // namespace glint::converge
