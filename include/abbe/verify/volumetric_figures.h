#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/instruments/measurement_plan.h"
#include "abbe/verify/error_map.h"

namespace abbe {

/// Volumetric error of one machine in the figures that `run`, `map`, `compensate table` and `verify` state, each with
/// one name and one definition (docs/conventions.md, "Volumetric error"): the same machine, errors and poses give the
/// same numbers in all of them.
///
/// All are lengths of the displacement of the functional point in the workpiece frame after the best fit of the
/// workpiece datum over the poses, mm. Axes with reversal values: mean of both directions of approach.
struct VolumetricFigures {
  std::string poses_words;  ///< "5 x 5 poses over X 0 to 400 mm, Z 0 to 300 mm"
  std::size_t poses = 0;    ///< that have a result
  std::size_t outside = 0;  ///< outside the range in which the errors are known
  /// Identified errors against the nominal machine: the error before correction, as predicted.
  std::optional<SampleStatistics> predicted_before;
  /// At each pose twice the root of the sum of the variances of the three coordinates, from the covariance of the
  /// identified errors: what is predicted to be left after correction, k = 2.
  std::optional<SampleStatistics> predicted_after;
  std::optional<SampleStatistics> true_before;  ///< true errors against the nominal machine (simulation)
  std::optional<SampleStatistics> true_after;   ///< true errors against the identified ones (simulation)
};

/// Poses over which figures are stated.
struct StatedPoses {
  PoseList poses;
  std::vector<std::size_t> grid;  ///< positions per axis in chain order
  std::string words;
};

/// The grid over which every command states the volumetric error unless it is asked for another one: 9 positions per
/// axis (5 above 3 axes), evenly over the range in which all of the given errors are known.
/// @param errors  at least one set
StatedPoses stated_grid(const Machine& machine, const std::vector<const ErrorSet*>& errors);

/// The ranges of that grid, with its numbers of positions.
std::vector<AxisRange> stated_ranges(const Machine& machine, const std::vector<const ErrorSet*>& errors);

/// All combinations of evenly spaced positions, the last axis fastest.
StatedPoses grid_over(const Machine& machine, const std::vector<AxisRange>& ranges);

/// "X -200 to 200 mm, ..."
std::string ranges_text(const Machine& machine, const std::vector<AxisRange>& ranges);

/// A pose that one of the maps cannot answer is a result in none of them, so that all statistics are over the same
/// poses.
/// @param maps  of the same poses, at least one
void keep_common_poses(std::span<ErrorMap* const> maps);

/// Figures from the maps of one machine; maps of the same poses, each after the best fit of the datum, null if there is
/// none. Poses without a result in one of them have none in any.
/// @param predicted  of the identified errors, with uncertainties if what is left is to be predicted
/// @param before     of the true errors
/// @param after      of the true errors against the identified ones
VolumetricFigures figures_of_maps(const std::string& poses_words, ErrorMap* predicted, ErrorMap* before,
                                  ErrorMap* after);

/// @param identified  null: only the truth is known
/// @param covariance  of identified->parameters(), or 0 x 0: nothing is predicted of what is left
/// @param truth       null: not known
VolumetricFigures volumetric_figures(const Machine& machine, const ErrorSet* identified,
                                     const Eigen::MatrixXd& covariance, const ErrorSet* truth, const StatedPoses& poses,
                                     int threads = 0);

}  // namespace abbe
