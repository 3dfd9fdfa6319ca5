#include "abbe/verify/compensated_poses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/errors/error_states.h"
#include "abbe/errors/reversal.h"
#include "abbe/geometry/angle.h"
#include "abbe/verify/covariance_root.h"
#include "abbe/verify/displacement_fields.h"
#include "abbe/verify/parts/actual_tool.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Points nearer to a line than this (root mean square) do not say how the workpiece is turned about it: what some
/// micrometres of error make of that turn is no longer small against the errors of the tool's direction. mm
constexpr double kLine = 1;

/// What becomes of a command that is corrected.
enum class Reach { reached, outside_travel, not_covered, not_reached };

/// Commands for identified errors, with their reversal values where the list knows the approach.
/// @param reach  becomes [poses]
PoseList corrected_commands(const Machine& machine, const ErrorSet& identified, const PoseList& commands,
                            std::vector<Reach>& reach) {
  ErrorSet mean = identified;
  mean.reversals.clear();
  const CompensatedInverse inverse(machine, mean);
  if (!inverse.problem().empty()) throw std::invalid_argument("corrected commands: " + inverse.problem());
  const std::size_t count = commands.count();
  PoseList corrected;
  corrected.axis.assign(machine.axes.size(), std::vector<double>(count));
  std::vector<const double*> from;
  std::vector<double*> to;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    from.push_back(commands.axis[i].data());
    to.push_back(corrected.axis[i].data());
  }
  std::vector<CorrectionStatus> status(count);
  CorrectedArrays arrays;
  arrays.axis = to;
  arrays.status = status.data();
  const GivenStates given(machine, mean);
  std::vector<std::size_t> all(given.any() ? count : 0);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<double> states;
  std::vector<const double*> state;
  given.gather(commands, all, states, state);
  inverse.correct({from, count, state}, arrays);
  reach.assign(count, Reach::not_reached);
  for (std::size_t k = 0; k < count; ++k) {
    if (reaches_point(status[k])) {
      reach[k] = Reach::reached;
    } else if (status[k] == CorrectionStatus::not_covered) {
      reach[k] = Reach::not_covered;
    } else if (status[k] == CorrectionStatus::outside_travel) {
      reach[k] = Reach::outside_travel;
    }
  }
  const ReversalShift reversal(identified);
  if (reversal.acts_on(commands)) {
    for (std::size_t i = 0; i < corrected.axis.size(); ++i) {
      for (std::size_t k = 0; k < count; ++k) corrected.axis[i][k] -= reversal.shift(commands, i, k);
    }
  }
  corrected.approach = commands.approach;
  corrected.state = commands.state;
  return corrected;
}

/// The tools of used poses after the best fit of the workpiece datum, against where they should be.
struct Left {
  BestFitStatus status = BestFitStatus::not_run;  ///< not ok: nothing else is there
  Eigen::Matrix3Xd displacement;
  std::vector<double> norm, angle;
};

Left left_after_datum(const ToolPlaces& actual, const ToolPlaces& wanted, const std::vector<std::size_t>& used) {
  std::vector<Eigen::Vector3d> source, target;
  for (const std::size_t k : used) {
    source.emplace_back(actual.point.col(static_cast<Index>(k)));
    target.emplace_back(wanted.point.col(static_cast<Index>(k)));
  }
  const BestFitTransform fit = best_fit_transform(source, target, {}, kLine);
  Left left;
  left.status = fit.status;
  if (fit.status != BestFitStatus::ok) return left;
  const RigidTransform& datum = fit.target_from_source;
  left.displacement.resize(3, static_cast<Index>(used.size()));
  for (std::size_t n = 0; n < used.size(); ++n) {
    const auto k = static_cast<Index>(used[n]);
    const Eigen::Vector3d displacement = datum * source[n] - target[n];
    left.displacement.col(static_cast<Index>(n)) = displacement;
    left.norm.push_back(displacement.norm());
    left.angle.push_back(angle_between(datum.rotation * actual.direction.col(k), wanted.direction.col(k)));
  }
  return left;
}

void predict(const Machine& machine, const ErrorSet& identified, const Eigen::MatrixXd& covariance,
             const PoseList& commands, const std::vector<std::size_t>& used, const Left& after,
             CompensatedPoses& result) {
  std::vector<std::size_t> parameters(identified.parameter_count());
  for (std::size_t p = 0; p < parameters.size(); ++p) parameters[p] = p;
  std::vector<std::uint8_t> wanted(commands.count(), 0);
  for (const std::size_t k : used) wanted[k] = 1;
  const DisplacementFields at = displacement_fields(machine, identified, parameters, commands, wanted);
  Eigen::MatrixXd spread = at.by_parameter * covariance_root(covariance);
  remove_span(orthonormal_columns(at.by_motion, 1e-10), spread);
  std::size_t within = 0;
  for (std::size_t n = 0; n < used.size(); ++n) {
    double variance = 0;
    for (Index c = 0; c < 3; ++c) {
      const Index row = 3 * static_cast<Index>(n) + c;
      const double u = spread.cols() > 0 ? spread.row(row).norm() : 0;
      variance += u * u;
      within += std::abs(after.displacement(c, static_cast<Index>(n))) <= 2 * u ? 1U : 0U;
    }
    result.uncertainty.push_back(std::sqrt(variance));
  }
  result.coverage = static_cast<double>(within) / (3 * static_cast<double>(used.size()));
}

}  // namespace

double CompensatedPoses::reduction() const {
  return after_statistics.mean > 0 ? before_statistics.mean / after_statistics.mean : 0;
}

double CompensatedPoses::uncertainty_ratio() const {
  return uncertainty_statistics.rms > 0 ? after_statistics.rms / uncertainty_statistics.rms : 0;
}

CompensatedPoses check_compensated_poses(const Machine& machine, const ErrorSet& truth, const ErrorSet& identified,
                                         const Eigen::MatrixXd& covariance, const PoseList& commands) {
  if (commands.axis.size() != machine.axes.size()) {
    throw std::invalid_argument("compensated poses: commands do not fit the machine's axes");
  }
  const auto parameters = static_cast<Index>(identified.parameter_count());
  if (covariance.size() > 0 && (covariance.rows() != parameters || covariance.cols() != parameters)) {
    throw std::invalid_argument("compensated poses: the covariance does not fit the errors");
  }
  CompensatedPoses result;
  std::vector<Reach> reach;
  const PoseList corrected = corrected_commands(machine, identified, commands, reach);
  const ToolPlaces wanted = actual_tool(machine, ErrorSet{}, commands);
  const ToolPlaces before = actual_tool(machine, truth, commands), after = actual_tool(machine, truth, corrected);
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < commands.count(); ++k) {
    if (reach[k] == Reach::not_covered || before.covered[k] == 0 || after.covered[k] == 0) {
      ++result.not_covered;
    } else if (reach[k] == Reach::outside_travel) {
      ++result.outside_travel;
    } else if (reach[k] == Reach::not_reached) {
      ++result.not_reached;
    } else {
      used.push_back(k);
    }
  }
  const Left left_before = left_after_datum(before, wanted, used), left_after = left_after_datum(after, wanted, used);
  result.datum = left_before.status != BestFitStatus::ok ? left_before.status : left_after.status;
  if (result.datum != BestFitStatus::ok) return result;
  result.before = left_before.norm;
  result.after = left_after.norm;
  result.direction_before = left_before.angle;
  result.direction_after = left_after.angle;
  if (covariance.size() > 0) predict(machine, identified, covariance, commands, used, left_after, result);
  result.before_statistics = sample_statistics(result.before);
  result.after_statistics = sample_statistics(result.after);
  result.direction_before_statistics = sample_statistics(result.direction_before);
  result.direction_after_statistics = sample_statistics(result.direction_after);
  result.uncertainty_statistics = sample_statistics(result.uncertainty);
  return result;
}

Eigen::Matrix3Xd errors_at_commands(const Machine& machine, const ErrorSet& actual, const ErrorSet& wanted,
                                    const PoseList& commands, std::vector<std::uint8_t>& used) {
  const ToolPlaces at = actual_tool(machine, actual, commands), should = actual_tool(machine, wanted, commands);
  std::vector<std::size_t> both;
  for (std::size_t k = 0; k < commands.count(); ++k) {
    if (at.covered[k] == 0 || should.covered[k] == 0) used[k] = 0;
    if (used[k] != 0) both.push_back(k);
  }
  const Left left = left_after_datum(at, should, both);
  if (left.status != BestFitStatus::ok) return {};
  Eigen::Matrix3Xd displacement = Eigen::Matrix3Xd::Zero(3, static_cast<Index>(commands.count()));
  for (std::size_t n = 0; n < both.size(); ++n) {
    displacement.col(static_cast<Index>(both[n])) = left.displacement.col(static_cast<Index>(n));
  }
  return displacement;
}

}  // namespace abbe
