#include "abbe/identify/strategies.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
using Key = std::vector<std::int64_t>;

Key key_of(const Machine& machine, const std::vector<double>& positions, AxisKind kind) {
  Key key;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis)
    if (machine.axes[axis].kind == kind) key.push_back(std::llround(positions[axis] * 1e6));
  return key;
}

// The commonest key among the readings that count; the smallest one of several equally common.
Key commonest(const std::vector<Key>& keys, const std::vector<bool>& counts) {
  std::map<Key, std::size_t> number;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (counts[i]) ++number[keys[i]];
  Key best;
  std::size_t most = 0;
  for (const auto& [key, count] : number)
    if (count > most) {
      most = count;
      best = key;
    }
  return best;
}

// Parameters of error motions, location errors and reversals of axes of one kind; the tool offset error goes with the
// linear axes.
std::vector<std::size_t> parameters_of(const Problem& problem, AxisKind kind) {
  std::vector<bool> belongs;
  const std::vector<Axis>& axes = problem.machine.axes;
  for (const ErrorMotion& motion : problem.errors.motions)
    belongs.insert(belongs.end(), motion.coefficients.size(), axes[motion.axis].kind == kind);
  for (const LocationError& location : problem.errors.locations) belongs.push_back(axes[location.axis].kind == kind);
  for (const Reversal& reversal : problem.errors.reversals) belongs.push_back(axes[reversal.axis].kind == kind);
  belongs.resize(problem.errors.parameter_count(), kind == AxisKind::linear);
  std::vector<std::size_t> result;
  for (const std::size_t i : problem.machine_parameters)
    if (belongs[i]) result.push_back(i);
  return result;
}

Problem problem_of(const Problem& problem, const Stage& stage) {
  Problem result = problem;
  result.machine_parameters = stage.machine_parameters;
  for (std::size_t o = 0; o < result.observations.size(); ++o) {
    result.observations[o].use = stage.use[o];
    result.observations[o].unknowns = stage.unknowns[o];
  }
  return result;
}

std::vector<Index> places_in(const Problem& whole, const std::vector<EstimatedParameter>& part) {
  std::vector<Index> places;
  for (const EstimatedParameter& parameter : part)
    places.push_back(static_cast<Index>(find_estimated(whole, parameter.id)));
  return places;
}

// What the readings of a stage say about its parameters: J'J without any gauge.
JointPrior information_of(const Problem& problem, const Identification& identification, const SolverOptions& solver) {
  JointPrior prior;
  for (const EstimatedParameter& parameter : identification.parameters) prior.parameters.push_back(parameter.id);
  prior.value = identification.estimates;
  const ReadingStream stream(problem, solver.threads, solver.summation, solver.stop);
  prior.information =
      stream.sums(identification.estimates, Loss{}, Wanted::normal).normal / identification.statistics.robust_factor;
  prior.residual_count = identification.statistics.degrees_of_freedom > 0
                             ? static_cast<double>(identification.statistics.parameter_count)
                             : 0;
  return prior;
}

// Estimates and covariance of both stages of the independent strategy in the order of the whole problem.
void carry_forward(const Problem& whole, const Problem& later_problem, const Identification& earlier,
                   const Identification& later, const SolverOptions& solver, Identification& total) {
  const Index p = static_cast<Index>(estimated_count(whole));
  const std::vector<Index> first = places_in(whole, earlier.parameters), second = places_in(whole, later.parameters);
  total.covariance = Eigen::MatrixXd::Zero(p, p);
  if (earlier.covariance.size() == 0 || later.covariance.size() == 0) {
    total.covariance.resize(0, 0);
    return;
  }
  // H over all parameters, from the later readings: its mixed part is the sensitivity to what was held fixed.
  Problem mixed = whole;
  for (std::size_t o = 0; o < mixed.observations.size(); ++o)
    mixed.observations[o].use = later_problem.observations[o].use;
  mixed.priors.clear();
  mixed.joint_priors.clear();
  const ReadingStream stream(mixed, solver.threads, solver.summation, solver.stop);
  const Eigen::MatrixXd normal = stream.sums(total.estimates, Loss{}, Wanted::normal).normal;
  const Eigen::MatrixXd cross = normal(second, first);
  const Eigen::MatrixXd unscaled = later.covariance / later.statistics.robust_factor;
  const Eigen::MatrixXd sensitivity = -unscaled * cross;
  const Eigen::MatrixXd carried = sensitivity * earlier.covariance;
  total.covariance(first, first) = earlier.covariance;
  total.covariance(second, second) = later.covariance + carried * sensitivity.transpose();
  total.covariance(second, first) = carried;
  total.covariance(first, second) = carried.transpose();
}

void write_uncertainties(const Problem& problem, Identification& total) {
  total.errors = problem.errors;
  total.setup.clear();
  for (const SelectedObservations& selected : problem.observations)
    total.setup.push_back(selected.observations->unknown_values());
  if (total.covariance.size() == 0) return;
  total.standard_uncertainties = total.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  std::vector<double> all(total.errors.parameter_count(), 0.0);
  for (std::size_t i = 0; i < problem.machine_parameters.size(); ++i)
    all[problem.machine_parameters[i]] = total.standard_uncertainties[static_cast<Index>(i)];
  std::size_t next = 0;
  for (ErrorMotion& motion : total.errors.motions) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(next);
    motion.standard_uncertainty.assign(from, from + static_cast<std::ptrdiff_t>(motion.coefficients.size()));
    next += motion.coefficients.size();
  }
  for (LocationError& location : total.errors.locations) location.standard_uncertainty = all[next++];
  for (Reversal& reversal : total.errors.reversals) reversal.standard_uncertainty = all[next++];
}

}  // namespace

std::vector<ReadingClass> classify_readings(const Machine& machine, const Observations& observations) {
  const std::size_t count = observations.reading_count();
  std::vector<Key> rotary(count), linear(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> positions = observations.positions(i);
    rotary[i] = key_of(machine, positions, AxisKind::rotary);
    linear[i] = key_of(machine, positions, AxisKind::linear);
  }
  std::vector<ReadingClass> result(count, ReadingClass::both_move);
  const Key rotary_reference = commonest(rotary, std::vector<bool>(count, true));
  std::vector<bool> others(count);
  for (std::size_t i = 0; i < count; ++i) others[i] = rotary[i] != rotary_reference;
  const Key linear_reference = commonest(linear, others);
  for (std::size_t i = 0; i < count; ++i)
    if (!others[i])
      result[i] = ReadingClass::linear_moves;
    else if (linear[i] == linear_reference)
      result[i] = ReadingClass::rotary_moves;
  return result;
}

std::vector<Stage> plan_stages(const Problem& problem, Strategy strategy) {
  std::vector<Stage> stages;
  Stage first, second;
  first.name = strategy == Strategy::joint ? "all axes" : "linear axes";
  second.name = strategy == Strategy::combined ? "all axes, with the linear axes known" : "rotary axes";
  first.machine_parameters =
      strategy == Strategy::joint ? problem.machine_parameters : parameters_of(problem, AxisKind::linear);
  second.machine_parameters =
      strategy == Strategy::combined ? problem.machine_parameters : parameters_of(problem, AxisKind::rotary);
  second.with_joint_prior = strategy == Strategy::combined;
  for (const SelectedObservations& selected : problem.observations) {
    const std::size_t count = selected.observations->reading_count();
    std::vector<std::uint8_t> now(count, 1), then(count, 1);
    if (strategy != Strategy::joint) {
      const std::vector<ReadingClass> classes = classify_readings(problem.machine, *selected.observations);
      for (std::size_t i = 0; i < count; ++i) {
        now[i] = classes[i] == ReadingClass::linear_moves;
        then[i] = strategy == Strategy::combined ? !now[i] : classes[i] == ReadingClass::rotary_moves;
      }
    }
    if (!selected.use.empty())
      for (std::size_t i = 0; i < count; ++i) {
        now[i] = now[i] && selected.use[i];
        then[i] = then[i] && selected.use[i];
      }
    const bool seen = std::any_of(now.begin(), now.end(), [](std::uint8_t used) { return used != 0; });
    first.unknowns.push_back(seen || strategy == Strategy::joint ? selected.unknowns : std::vector<std::size_t>{});
    second.unknowns.push_back(seen && strategy == Strategy::independent ? std::vector<std::size_t>{}
                                                                        : selected.unknowns);
    first.use.push_back(std::move(now));
    second.use.push_back(std::move(then));
  }
  stages.push_back(std::move(first));
  if (strategy != Strategy::joint) stages.push_back(std::move(second));
  return stages;
}

StagedIdentification identify_in_stages(Problem& problem, Strategy strategy, const IdentifyOptions& options) {
  StagedIdentification result;
  const Eigen::VectorXd start = present_values(problem);
  const std::vector<Stage> stages = plan_stages(problem, strategy);
  Problem working = problem;
  Problem last;
  for (std::size_t s = 0; s < stages.size(); ++s) {
    Problem staged = problem_of(working, stages[s]);
    if (stages[s].with_joint_prior)
      staged.joint_priors.push_back(information_of(last, result.stages.back(), options.solver));
    result.stages.push_back(identify(staged, options));
    const Identification& now = result.stages.back();
    if (now.estimates.size() == 0) {
      set_observations(problem, start);
      result.total.status = now.status;
      result.total.message = stages[s].name + ": " + now.message;
      return result;
    }
    working.errors = staged.errors;
    last = std::move(staged);
  }
  problem.errors = working.errors;
  result.total = result.stages.back();
  if (strategy == Strategy::independent) {
    Identification& total = result.total;
    total.parameters = estimated_parameters(problem);
    total.estimates = present_values(problem);
    total.space = {};
    total.gauge = result.stages.front().gauge;
    const GaugeReport& later = result.stages.back().gauge;
    total.gauge.parameter_count += later.parameter_count;
    total.gauge.rank_at_start += later.rank_at_start;
    total.gauge.rank_at_solution += later.rank_at_solution;
    total.gauge.constraints.clear();  // they live in the stages' own parameters
    total.gauge.warnings.insert(total.gauge.warnings.end(), later.warnings.begin(), later.warnings.end());
    carry_forward(problem, last, result.stages.front(), result.stages.back(), options.solver, total);
    write_uncertainties(problem, total);
  }
  result.total.converged = std::all_of(result.stages.begin(), result.stages.end(),
                                       [](const Identification& stage) { return stage.converged; });
  for (std::size_t s = 0; s < result.stages.size(); ++s)
    if (result.stages[s].status != IdentifyStatus::converged) {
      result.total.status = result.stages[s].status;
      result.total.message = stages[s].name + ": " + result.stages[s].message;
      break;
    }
  set_observations(problem, present_values(problem));
  return result;
}

}  // namespace abbe
