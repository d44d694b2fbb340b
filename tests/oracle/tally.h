// Answers compared with the truth, and the counts.
#pragma once

#include <string>
#include <vector>

#include "oracle.h"

namespace glint::oracle {

struct Tally {
    size_t rays = 0, hits = 0;  // hits: in truth
    // Rays with Truth::margin < band, which may be decided either way.
    size_t inBand = 0, wrongInBand = 0;
    size_t falseHits = 0, falseMisses = 0;
    std::vector<double> tErrors;       // |t - truth| / truth, hits of both outside the band
    std::vector<double> scaledErrors;  // tErrors times Truth::margin: what cancellation does not excuse
    std::vector<double> weightErrors;  // max |u - truth|, |v - truth|

    void add(const Truth& truth, double band, bool hit, double t, double u = 0, double v = 0);
    size_t wrong() const { return falseHits + falseMisses; }
    // The value that the share `part` of the errors stays within; 0 without errors. part 1: the greatest.
    static double quantile(std::vector<double> errors, double part);
    // One line: all of the above.
    std::string text() const;
};

}  // namespace glint::oracle
