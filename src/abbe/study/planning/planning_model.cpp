#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "abbe/errors/error_states.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/study/study_parts.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/planning_candidates.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/campaign.h"
#include "abbe/study/identification/identified_expansions.h"
#include "abbe/study/identification/setup_drifts.h"
#include "abbe/study/planning/planned_readings.h"
#include "abbe/study/planning/planning.h"
#include "abbe/study/planning/planning_beside_drifts.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Poses at which the largest factors of states are looked for.
constexpr std::size_t kFactorPoses = 50;

ErrorSet planned_errors(const Study& study) {
  ErrorSet errors;
  for (const IdentifiedMotion& identified : study.identification->motions) {
    ErrorMotion motion{identified.axis, identified.component, identified.basis, {}, {}};
    motion.coefficients.assign(motion.basis.size(), 0.0);
    motion.state = identified.state;
    errors.motions.push_back(motion);
  }
  for (const IdentifiedLocation& location : study.identification->locations) {
    LocationError& planned = errors.locations.emplace_back();
    planned.axis = location.axis;
    planned.component = location.component;
    planned.state = location.state;
  }
  for (const std::size_t axis : study.identification->reversals) errors.reversals.push_back({axis, 0, 0});
  return errors;
}

/// [parameters] state of each, or kNoState.
std::vector<std::size_t> states_of_parameters(const ErrorSet& errors) {
  std::vector<std::size_t> states;
  for (const ErrorMotion& motion : errors.motions)
    states.insert(states.end(), motion.coefficients.size(), motion.state);
  for (const LocationError& location : errors.locations) states.push_back(location.state);
  states.resize(errors.parameter_count(), kNoState);
  return states;
}

/// No readings at all, which still have a place in the problem.
InstrumentReadings empty_readings(const Machine& machine, const Instrument& device) {
  InstrumentReadings readings;
  readings.poses.axis.resize(machine.axes.size());
  readings.poses.state.resize(machine.states.size());
  readings.inputs.resize(device.inputs().size());
  readings.measured.resize(device.components().size());
  return readings;
}

std::vector<const double*> pointers(const PoseList& poses, std::size_t first = 0) {
  std::vector<const double*> result;
  for (const std::vector<double>& values : poses.axis) result.push_back(values.data() + first);
  return result;
}

/// Functional point of the tool seen from a body, [3][poses].
std::array<std::vector<double>, 3> tool_points(const Machine& machine, const PoseList& poses, Body seen_from) {
  const std::size_t n = poses.count();
  std::array<std::vector<double>, 3> start, seen;
  for (std::size_t i = 0; i < 3; ++i) {
    start[i].assign(n, machine.tool_offset[static_cast<Index>(i)]);
    seen[i].resize(n);
  }
  const ChainPlan plan(machine, ErrorSet{}, Body::tool, seen_from);
  const std::vector<const double*> axis = pointers(poses);
  plan.transform({axis, n}, {start[0].data(), start[1].data(), start[2].data()},
                 {seen[0].data(), seen[1].data(), seen[2].data()});
  return seen;
}

}  // namespace

PlanningModel::PlanningModel(const Study& study, const ErrorSet* errors, PlannedDrifts drifts)
    : study_(study), drifts_(std::move(drifts)) {
  if (!study.planning) throw InputError({.field = "plan"}, "there is nothing to plan", "a table [plan]");
  if (!study.identification)
    throw InputError({.field = "identify"}, "it is not said what is to be identified", "a table [identify]");
  if (study.setups.empty()) throw InputError({.field = "setup"}, "there is no instrument", "[[setup]]");
  errors_ = errors != nullptr ? *errors : planned_errors(study);
  states_ = PlannedStates(study, errors_);
  check_setups();
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    const Instrument& device = *devices_.emplace_back(study.setups[s].device->as_planned());
    const PoseFreedom freedom = device.pose_freedom();
    const bool anywhere = freedom == PoseFreedom::anywhere || freedom == PoseFreedom::together;
    if (device.measures_points() || (anywhere && study.setups[s].plans.empty())) {
      add_sights(s);
    } else {
      add_given(s);
    }
  }
  if (sights_.empty() && given_.empty()) {
    throw InputError({.field = "setup"}, "the reflectors are missing", "[[setup.reflector]]");
  }
  const Problem empty = problem(no_readings());
  parameters_ = estimated_parameters(empty);
  find_states();
  Problem with_priors = empty;
  const std::vector<std::uint8_t> of_expansion = are_of_expansions(*study.identification, empty.errors);
  for (const ParameterPrior& prior : study.identification->priors)
    for (const EstimatedParameter& parameter : parameters_) {
      if (parameter.id.is_machine() && of_expansion[parameter.id.index] != 0) continue;
      if (matches_pattern(parameter.name, prior.parameters) && parameter.is_angle == prior.is_angle)
        with_priors.priors.push_back({parameter.id, prior.value, prior.standard_uncertainty});
    }
  add_expansion_priors(*study.identification, with_priors);
  for (std::size_t s = 0; s < devices_.size(); ++s)
    for (const KnownUnknown& known : known_unknowns_of(*devices_[s]))
      with_priors.priors.push_back({{s, known.unknown}, known.value, known.standard_uncertainty});
  known_ = prior_rows(with_priors);
}

void PlanningModel::find_states() {
  const std::vector<std::size_t> of_machine = states_of_parameters(errors_);
  for (const EstimatedParameter& parameter : parameters_) {
    state_of_.push_back(parameter.id.is_machine() ? of_machine[parameter.id.index] : kNoState);
  }
  largest_factor_.assign(study_.machine.states.size(), 0);
  if (!has_states(errors_)) return;
  const PoseList poses = random_plan(study_.machine, study_.planning->axes, kFactorPoses, study_.seed);
  for (const std::vector<double>& given : states_.used_at()) {
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const std::vector<double> factors = state_factors(study_.machine, poses.pose(k), given);
      for (std::size_t j = 0; j < factors.size(); ++j) {
        if (std::isfinite(factors[j])) largest_factor_[j] = std::max(largest_factor_[j], std::abs(factors[j]));
      }
    }
  }
}

void PlanningModel::check_setups() const {
  for (const Setup& setup : study_.setups) {
    const std::string field = "setup " + setup.name;
    if (setup.noise_from_data) throw InputError({.field = field}, "a plan has no data", "[setup.noise]");
    if (const auto missing = setup.device->missing_for_plan()) {
      throw InputError({.field = field}, missing->problem, missing->expected);
    }
  }
}

void PlanningModel::add_sights(std::size_t setup) {
  const Instrument& device = *devices_[setup];
  const std::size_t stations = std::max<std::size_t>(1, device.station_names().size());
  const std::size_t targets = device.target_names().size();
  if (device.pose_freedom() != PoseFreedom::anywhere) sights_stand_anywhere_ = false;
  for (std::size_t i = 0; i < stations; ++i)
    for (std::size_t j = 0; j < targets; ++j) sights_.push_back({setup, i, j});
}

void PlanningModel::add_given(std::size_t setup) {
  const Setup& given = study_.setups[setup];
  if (given.plans.empty()) {
    throw InputError({.field = "setup " + given.name},
                     fmt::format("the study does not say where instrument \"{}\" can be read", given.instrument),
                     "[[setup.plan]] with all readings to choose from: its circles, its lines");
  }
  InstrumentReadings all;
  for (std::size_t p = 0; p < given.plans.size(); ++p) {
    all.append(planned_readings(study_.machine, given, given.plans[p], plan_seed(study_, setup, p)).readings);
  }
  given_.emplace_back(setup, std::move(all));
}

std::vector<InstrumentReadings> PlanningModel::no_readings() const {
  std::vector<InstrumentReadings> none;
  for (std::size_t s = 0; s < devices_.size(); ++s) {
    none.push_back(empty_readings(study_.machine, *devices_[s]));
    if (!drifts_.empty()) none.back().drift = drifts_[s];
  }
  return none;
}

Problem PlanningModel::problem(const std::vector<InstrumentReadings>& readings) const {
  std::vector<std::shared_ptr<Observations>> observations;
  for (std::size_t s = 0; s < devices_.size(); ++s) {
    observations.push_back(devices_[s]->observations(study_.machine, errors_, readings[s]));
  }
  Problem result = estimate_everything(study_.machine, errors_, observations);
  if (!study_.identification->tool_offset)
    result.machine_parameters.resize(result.machine_parameters.size() - 3);  // they come last
  keep_expansion_estimates(*study_.identification, result);
  for (std::size_t s = 0; s < readings.size(); ++s) {
    if (readings[s].drift != nullptr) add_walk_priors(*study_.setups[s].drift, *readings[s].drift, s, result);
  }
  return result;
}

/// Readings of one sight at poses; what cannot be read at a pose counts as hidden.
InstrumentReadings PlanningModel::sight_plan(const Sight& sight, const PoseList& poses, Candidates& result) const {
  const Instrument& device = *devices_[sight.setup];
  const Machine& machine = study_.machine;
  InstrumentReadings plan = empty_readings(machine, device);
  plan.measured.clear();
  for (std::size_t k = 0; k < poses.count(); ++k) {
    std::vector<double> pose = poses.pose(k);
    try {
      const std::size_t item = device.item_at(machine, sight.target, sight.station, pose);
      if (device.pose_freedom() == PoseFreedom::together) {
        const InstrumentItem& ends = device.items()[item];
        const std::optional<MeetingPoints> points = device.meeting_points(item);
        const auto reached =
            points ? meet(machine, pose, ends.from, ends.to, *points, Eigen::Vector3d::Zero()) : std::nullopt;
        if (!reached) {
          ++result.hidden;
          continue;
        }
        pose = *reached;
      }
      for (const std::vector<double>& inputs : device.planned_inputs(item)) plan.append(pose, item, inputs);
    } catch (const std::invalid_argument&) {
      ++result.hidden;  // no item of the target can be read there
    }
  }
  return plan;
}

/// Adds what of a plan can be read.
void PlanningModel::see(std::size_t setup, const InstrumentReadings& plan, std::vector<InstrumentReadings>& readings,
                        Candidates& result) const {
  if (plan.count() == 0) return;
  InstrumentSimulationOptions options;
  options.noise_factor = 0;
  options.threads = study_.threads;
  options.readings_per_pose = devices_[setup]->targets_share_poses() ? 1 : 0;
  SimulatedInstrument seen = devices_[setup]->simulate(study_.machine, ErrorSet{}, plan, options);
  result.hidden += seen.hidden;
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < seen.readings.count(); ++k) {
    const bool finite = std::all_of(seen.readings.measured.begin(), seen.readings.measured.end(),
                                    [k](const std::vector<double>& values) { return std::isfinite(values[k]); });
    if (finite) shown.push_back(k);
  }
  result.hidden += seen.readings.count() - shown.size();
  if (shown.size() < seen.readings.count()) seen.readings = seen.readings.subset(shown);
  seen.readings.time_s.clear();
  seen.readings.uncertainty.clear();
  seen.readings.covariance.clear();
  readings[setup].append(seen.readings);
}

void PlanningModel::see_poses(const PosesAt& at, const std::vector<std::size_t>& sight,
                              std::vector<InstrumentReadings>& readings, Candidates& result) const {
  const PoseList& poses = at.poses;
  const auto takes_part = [&at](std::size_t setup) { return at.setup == PosesAt::kEverySetup || at.setup == setup; };
  const std::vector<bool> out = forbidden(poses);
  result.forbidden += static_cast<std::size_t>(std::count(out.begin(), out.end(), true));
  for (std::size_t i = 0; i < sights_.size(); ++i) {
    if (!takes_part(sights_[i].setup)) continue;
    PoseList own;
    own.axis.resize(poses.axis.size());
    for (std::size_t k = 0; k < poses.count(); ++k) {
      if (out[k] || (!sight.empty() && sight[k] % sights_.size() != i)) continue;
      for (std::size_t a = 0; a < poses.axis.size(); ++a) own.axis[a].push_back(poses.axis[a][k]);
    }
    if (own.count() == 0) continue;
    see(sights_[i].setup, sight_plan(sights_[i], own, result), readings, result);
  }
  for (const auto& [setup, plan] : given_) {
    if (!takes_part(setup)) continue;
    const std::vector<bool> blocked = forbidden(plan.poses);
    std::vector<std::size_t> allowed;
    for (std::size_t k = 0; k < plan.count(); ++k) {
      if (!blocked[k]) allowed.push_back(k);
    }
    result.forbidden += plan.count() - allowed.size();
    see(setup, plan.subset(allowed), readings, result);
  }
}

PlanningModel::Candidates PlanningModel::readings_at(const PoseList& poses,
                                                     const std::vector<std::size_t>& sight) const {
  return readings_at({{poses, 0}}, sight);
}

PlanningModel::Candidates PlanningModel::readings_at(const std::vector<PosesAt>& tried,
                                                     const std::vector<std::size_t>& sight) const {
  Candidates result = seen_at(tried, sight);
  result.rows = candidate_rows(problem(result.of_setup), study_.threads);
  return result;
}

PlanningModel::Candidates PlanningModel::seen_at(const std::vector<PosesAt>& tried,
                                                 const std::vector<std::size_t>& sight) const {
  Candidates result;
  std::vector<InstrumentReadings> readings = no_readings();
  std::vector<std::vector<std::size_t>> condition(devices_.size()), part(devices_.size());
  for (const PosesAt& at : tried) {
    see_poses(at, sight, readings, result);
    for (std::size_t s = 0; s < readings.size(); ++s) {
      condition[s].resize(readings[s].count(), at.condition);
      part[s].resize(readings[s].count(), at.part);
      if (readings[s].drift != nullptr) readings[s].time_s.resize(readings[s].count(), at.time_s);
    }
  }
  for (std::size_t s = 0; s < readings.size(); ++s) {
    std::vector<std::vector<double>> states;
    for (const std::size_t one : condition[s]) states.push_back(states_.conditions()[one].states);
    give_states(states, readings[s].poses);
  }
  for (std::size_t s = 0; s < readings.size(); ++s)
    for (std::size_t k = 0; k < readings[s].count(); ++k) {
      std::vector<double> inputs;
      for (const std::vector<double>& column : readings[s].inputs) inputs.push_back(column[k]);
      result.readings.push_back(
          {readings[s].poses.pose(k), s, readings[s].item[k], std::move(inputs), condition[s][k], part[s][k]});
    }
  result.of_setup = std::move(readings);
  return result;
}

PlanningCandidates PlanningModel::rows_of(const std::vector<CandidateReading>& readings,
                                          const std::vector<std::vector<double>>& states,
                                          const std::vector<double>& time_s) const {
  std::vector<InstrumentReadings> seen;
  Candidates counted;
  for (std::size_t s = 0; s < devices_.size(); ++s) {
    seen.push_back(empty_readings(study_.machine, *devices_[s]));
    std::vector<std::vector<double>> own;
    std::vector<double> times;
    std::size_t count = 0;
    // One item at a time: see() takes all readings of a tracker as those of one sight.
    for (std::size_t item = 0; item < devices_[s]->items().size(); ++item) {
      InstrumentReadings plan = empty_readings(study_.machine, *devices_[s]);
      plan.measured.clear();
      for (std::size_t k = 0; k < readings.size(); ++k) {
        if (readings[k].setup != s || readings[k].item != item) continue;
        plan.append(readings[k].pose, item, readings[k].inputs);
        if (!states.empty()) own.push_back(states.at(k));
        if (!time_s.empty()) times.push_back(time_s.at(k));
        ++count;
      }
      see(s, plan, seen, counted);
      if (seen[s].count() != count) throw std::logic_error("planning: a candidate cannot be read any more");
    }
    give_states(own, seen[s].poses);
    const std::optional<DriftPlan>& drift = study_.setups[s].drift;
    if (times.empty() || !drift || !drift->is_identified()) continue;
    seen[s].time_s = std::move(times);
    seen[s].drift = drift_over(*drift, *devices_[s], times_by_station(*devices_[s], seen[s]));
  }
  const Problem taken = problem(seen);
  return time_s.empty() ? candidate_rows(taken) : beside_drifts(taken, candidate_rows(taken), seen);
}

std::vector<bool> PlanningModel::forbidden(const PoseList& poses) const {
  std::vector<bool> out(poses.count(), false);
  for (const ForbiddenBox& box : study_.planning->forbidden) {
    const std::array<std::vector<double>, 3> points = tool_points(study_.machine, poses, box.frame);
    for (std::size_t k = 0; k < poses.count(); ++k) {
      bool inside = true;
      for (std::size_t i = 0; i < 3; ++i)
        inside =
            inside && points[i][k] > box.from[static_cast<Index>(i)] && points[i][k] < box.to[static_cast<Index>(i)];
      if (inside) out[k] = true;
    }
  }
  return out;
}

Eigen::MatrixXd PlanningModel::weak_prior() const {
  constexpr double kLength_mm = 0.02, kAngle_rad = 6e-5, kSetUp = 1e3;
  Eigen::VectorXd information(static_cast<Index>(parameters_.size()));
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    double u = (parameters_[i].is_angle ? kAngle_rad : kLength_mm) * (parameters_[i].id.is_machine() ? 1 : kSetUp);
    const std::size_t state = state_of_[i];
    if (state != kNoState && largest_factor_[state] > 0) u /= largest_factor_[state];
    information[static_cast<Index>(i)] = 1 / (u * u);
  }
  return information.asDiagonal();
}

Eigen::MatrixXd PlanningModel::prediction_rows(const PoseList& poses) const {
  const Machine& machine = study_.machine;
  const std::size_t n = poses.count();
  std::vector<std::size_t> wanted;
  std::vector<Index> columns;
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (parameters_[i].id.is_machine()) {
      wanted.push_back(parameters_[i].id.index);
      columns.push_back(static_cast<Index>(i));
    }
  const std::array<std::vector<double>, 3> seen = tool_points(machine, poses, Body::workpiece);
  const ChainPlan plan(machine, errors_, Body::tool, Body::workpiece);
  const std::vector<double> one(ChainPlan::kBlockSize, 1.0), zero(ChainPlan::kBlockSize, 0.0);
  std::array<RowArrays, 3> rows;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto unit = [&](std::size_t k) { return (k == i ? one : zero).data(); };
    rows[i] = {{unit(0), unit(1), unit(2)}, {zero.data(), zero.data(), zero.data()}};
  }
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(static_cast<Index>(3 * n), static_cast<Index>(parameters_.size()));
  std::vector<double> jacobian(wanted.size() * 3 * ChainPlan::kBlockSize);
  const GivenStates given(machine, errors_);
  std::vector<std::size_t> all(given.any() ? n : 0);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<double> values;
  std::vector<const double*> state;
  given.gather(poses, all, values, state);
  for (std::size_t first = 0; first < n; first += ChainPlan::kBlockSize) {
    const std::size_t count = std::min(ChainPlan::kBlockSize, n - first);
    const std::vector<const double*> axis = pointers(poses, first);
    plan.differentiate({axis, count, state}, {},
                       {seen[0].data() + first, seen[1].data() + first, seen[2].data() + first}, rows, wanted,
                       jacobian.data(), 3 * count);
    for (std::size_t c = 0; c < wanted.size(); ++c)
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < count; ++k)
          result(static_cast<Index>(3 * (first + k) + row), columns[c]) = jacobian[c * 3 * count + row * count + k];
    for (const double*& column : state) column += column != nullptr ? count : 0;
  }
  // A rigid motion of the workpiece is a matter of its datum, not an error of the machine.
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(static_cast<Index>(3 * n), 6);
  for (std::size_t k = 0; k < n; ++k) {
    const Index at = static_cast<Index>(3 * k);
    rigid.block<3, 3>(at, 0).setIdentity();
    const double x = seen[0][k], y = seen[1][k], z = seen[2][k];
    rigid.block<3, 3>(at, 3) << 0, z, -y, -z, 0, x, y, -x, 0;
  }
  const Eigen::MatrixXd basis = Qr(rigid).orthonormal(6);
  result -= basis * (basis.transpose() * result);
  return result;
}

Eigen::MatrixXd PlanningModel::parameter_rows() const {
  Eigen::MatrixXd rows(0, static_cast<Index>(parameters_.size()));
  for (const std::string& pattern : study_.planning->parameters) {
    const Index before = rows.rows();
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (!matches_pattern(parameters_[i].name, pattern)) continue;
      rows.conservativeResize(rows.rows() + 1, rows.cols());
      rows.row(rows.rows() - 1) =
          Eigen::RowVectorXd::Unit(rows.cols(), static_cast<Index>(i)) * micro_per_unit(parameters_[i].is_angle);
    }
    if (rows.rows() == before)
      throw InputError({.field = "plan.parameters"}, fmt::format("no estimated parameter matches '{}'", pattern),
                       "a name such as " + parameters_.front().name);
  }
  return rows;
}

}  // namespace abbe
