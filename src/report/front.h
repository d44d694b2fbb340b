// Which settings of a report another one beats, and what that says of the default.
#pragma once

#include <string>
#include <vector>

#include "report/plan.h"

namespace glint::report {

// The settings that took turns: between batches a busy machine drifts by more than methods differ.
enum class Contest { Samplers, Methods, None };
Contest contestOf(const Measured& m);

// Clearly better in time or error and not clearly worse in the other, both wall clock and RMSE against the
// converged picture, of settings of one batch. Ratios are those of one turn, and differ clearly if the
// interval that holds their expectation with probability 1 - `tail` (report/statistics.h) lies beyond a
// fiftieth: less is of no use to anybody.
bool beats(const Measured& a, const Measured& b, double tail);

// Sets isDefault and beatenBy of all that was measured: of what beats a setting, the one of least error times
// time; empty on the front and for what no contest is about (depths and cuts are the scene's own decisions).
// Each batch with n settings is given a chance of kMistake to name any winner among equals, which its
// n (n - 1) / 2 pairs share (Bonferroni).
inline constexpr double kMistake = 0.05;
void markFront(SceneReport& scene);

// Why a quicker or more exact setting is not the default all the same; empty if nothing speaks against it.
std::string weaknessOf(const std::string& family);

// Of what took turns: "1.02 (0.99 to 1.05)", with the interval that holds a single ratio in 95 % of cases.
std::string ratio(const std::vector<double>& a, const std::vector<double>& b);

// Needs markFront. The default of one contest: "on the front at 1, 16 spp; beaten at 4 spp by ...". Empty if
// it was not measured.
std::string defaultInWords(const SceneReport& scene, Contest contest);

// Markdown: a line for each measurement of the default. Empty if there is none.
std::string defaultTable(const SceneReport& scene);
// Markdown: a line for each scene.
std::string defaultSummary(const Report& data);

}  // namespace glint::report
