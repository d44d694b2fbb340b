#include "tally.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace glint::oracle {

void Tally::add(const Truth& truth, double band, bool hit, double t, double u, double v) {
    ++rays;
    hits += truth.hit;
    if (truth.margin < band) {
        ++inBand;
        wrongInBand += hit != truth.hit;
        return;
    }
    falseHits += hit && !truth.hit;
    falseMisses += !hit && truth.hit;
    if (!hit || !truth.hit) return;
    tErrors.push_back(std::abs(t - truth.t) / truth.t);
    scaledErrors.push_back(tErrors.back() * truth.margin);
    weightErrors.push_back(std::max(std::abs(u - truth.u), std::abs(v - truth.v)));
}

double Tally::quantile(std::vector<double> errors, double part) {
    if (errors.empty()) return 0;
    const auto index = static_cast<size_t>(part * static_cast<double>(errors.size() - 1));
    const auto at = errors.begin() + static_cast<std::ptrdiff_t>(index);
    std::nth_element(errors.begin(), at, errors.end());
    return *at;
}

std::string Tally::text() const {
    char line[300];
    std::snprintf(line, sizeof(line),
                  "%zu rays, %zu hits; wrong: %zu false hits, %zu false misses; in the band %zu (%zu wrong); "
                  "t error p50 %.2g p99 %.2g max %.2g; weights p99 %.2g max %.2g",
                  rays, hits, falseHits, falseMisses, inBand, wrongInBand, quantile(tErrors, 0.5),
                  quantile(tErrors, 0.99), quantile(tErrors, 1), quantile(weightErrors, 0.99),
                  quantile(weightErrors, 1));
    return line;
}

}  // namespace glint::oracle
