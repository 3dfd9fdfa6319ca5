#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "abbe/geometry/work_in_step.h"
#include "abbe/plan/readings/planning_space.h"

namespace abbe {

/// What a plan makes small, within what the candidates can see (PlanningSpace).
enum class PlanningCriterion {
  determinant,  ///< D: the volume of the confidence ellipsoid of all seen directions; needs no units
  variance      ///< A, V: the sum of the variances of given functionals: named parameters (A), predictions (V, also I)
};

struct PlanningOptions {
  PlanningCriterion criterion = PlanningCriterion::determinant;
  Eigen::MatrixXd functionals;  ///< variance: [m, p]; rows of unit vectors, or d(prediction)/d(estimate)
  std::size_t count = 0;        ///< readings to be chosen, at most; 0: as many as the time allows
  double time_s = std::numeric_limits<double>::infinity();  ///< sum of the costs, at most
  std::size_t repeats = 1;                                  ///< how often the same reading may be taken
  std::vector<unsigned char> eligible;                      ///< [candidates] 0: not to be chosen; empty: all may be
  std::vector<std::uint32_t> group;        ///< [candidates] of which at most a number may be chosen; empty: no groups
  std::vector<std::size_t> most_of_group;  ///< [groups] readings, repetitions counted
  std::vector<std::size_t> start;          ///< choice to begin with instead of the greedy one; empty: greedy
  int starts = 1;                          ///< the first is greedy, the others random; the best result counts
  int most_passes = 10;                    ///< over all chosen readings, looking for exchanges
  double smallest_gain = 1e-7;  ///< exchanges that lower the criterion by less are not made; determinant: of its
                                ///< logarithm, variance: relative
  double pass_gain = 1e-3;      ///< the search ends after a pass that lowers it by less; determinant: of its logarithm
                                ///< per seen direction, variance: relative; 0: if no exchange helps
  std::uint64_t seed = 1;
  int threads = 0;                             ///< 0: all; the result does not depend on it
  WorkInStep in_step{};                        ///< processes that make the same choice, which then share the work
  std::function<void(double share)> progress;  ///< 0 to 1, called from one thread
};

enum class PlanningStatus {
  not_run,
  done,
  not_determined,  ///< no choice of that size was found that determines everything that the candidates see
  nothing_fits     ///< not a single candidate is allowed
};
const char* status_text(PlanningStatus status);

struct ReadingPlan {
  PlanningStatus status = PlanningStatus::not_run;
  std::vector<std::size_t> chosen;  ///< candidates, increasing, with repetitions
  PlanValue value;                  ///< by factorisation of the chosen rows, not by updates
  std::vector<double> history;      ///< criterion after each exchange: -log det or sum of variances; decreasing
  std::size_t exchanges = 0;
  std::size_t passes = 0;
};

/// Chooses readings: greedy start, then exchanges of one reading for another until none helps (Fedorov's exchange in
/// the form that takes for each chosen reading the best other one; Cook and Nachtsheim, Technometrics 22 (1980) 315).
///
/// With pass_gain 0 a local optimum in the sense that no single exchange improves it by smallest_gain; the number of
/// starts raises the chance of the best. Sources: Fedorov, Theory of Optimal Experiments (1972); Atkinson, Donev and
/// Tobias, Optimum Experimental Designs, with SAS (2007), chapters 10 to 12.
/// @throws std::invalid_argument for options that do not agree with the space
ReadingPlan plan_readings(const PlanningSpace& space, const PlanningOptions& options);

/// Plans of growing size, each holding the ones before: the first as plan_readings() makes it, then the best reading
/// added again and again. So the criterion falls with every point of the curve.
/// @param counts  increasing; options.count and options.time_s are not used
/// @return one value per count, as far as candidates last
std::vector<ReadingPlan> plan_curve(const PlanningSpace& space, const PlanningOptions& options,
                                    std::span<const std::size_t> counts);

/// How many points are enough: from that count on, the uncertainty falls with the number of points no faster than a
/// mean of independent readings does: u ~ n^-e with e below 1/2 + `spare` from there to the end of the curve. More
/// points then only average noise; fewer leave something badly determined.
/// @param counts, uncertainty  the curve, increasing counts; at least two points
/// @return index into counts; counts.size() if the curve is steeper to its end
std::size_t enough_points(std::span<const std::size_t> counts, std::span<const double> uncertainty,
                          double spare = 0.25);

}  // namespace abbe
