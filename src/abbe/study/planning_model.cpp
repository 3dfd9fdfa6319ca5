#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/study_file.h"
#include "abbe/formats/study_parts.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/planning_candidates.h"
#include "abbe/instruments/tracker_observations.h"
#include "abbe/instruments/tracker_simulation.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/planning.h"
#include "abbe/study/tracker_campaign.h"

namespace abbe {
namespace {

using Eigen::Index;

ErrorSet planned_errors(const Study& study) {
  ErrorSet errors;
  for (const IdentifiedMotion& identified : study.identification->motions) {
    ErrorMotion motion{identified.axis, identified.component, identified.basis, {}, {}};
    motion.coefficients.assign(motion.basis.size(), 0.0);
    errors.motions.push_back(motion);
  }
  for (const IdentifiedLocation& location : study.identification->locations)
    errors.locations.push_back({location.axis, location.component, 0, 0});
  for (const std::size_t axis : study.identification->reversals) errors.reversals.push_back({axis, 0, 0});
  return errors;
}

void append_planned(TrackerReadings& all, const TrackerReadings& more) {
  if (all.poses.axis.empty()) {
    all = more;
    return;
  }
  const auto join = [](auto& a, const auto& b) { a.insert(a.end(), b.begin(), b.end()); };
  join_poses(all.poses, more.poses);
  join(all.station, more.station);
  join(all.reflector, more.reflector);
  for (std::size_t i = 0; i < 3; ++i) join(all.measured[i], more.measured[i]);
  all.time_s.clear();
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

PlanningModel::PlanningModel(const Study& study) : study_(study) {
  if (!study.planning) throw InputError({.field = "plan"}, "there is nothing to plan", "a table [plan]");
  if (!study.identification)
    throw InputError({.field = "identify"}, "it is not said what is to be identified", "a table [identify]");
  if (study.setups.empty()) throw InputError({.field = "setup"}, "there is no instrument", "[[setup]]");
  errors_ = planned_errors(study);
  for (std::size_t s = 0; s < study.setups.size(); ++s) {
    const Setup& setup = study.setups[s];
    const std::string field = "setup " + setup.name;
    if (setup.instrument != "tracker") {
      throw InputError({.field = field}, fmt::format("a plan for instrument \"{}\" is not possible", setup.instrument),
                       "set-ups with instrument = \"tracker\"");
    }
    if (setup.noise_from_data) throw InputError({.field = field}, "a plan has no data", "[setup.noise]");
    for (const SetupStation& station : setup.stations)
      if (!station.pose && !station.true_pose)
        throw InputError({.field = field}, fmt::format("it is not said where {} will stand", station.name),
                         "pose = { position_mm = [x, y, z], angles_deg = [a, b, c] }, roughly");
    for (const SetupReflector& reflector : setup.reflectors)
      if (reflector.offset_from_data)
        throw InputError({.field = field}, "a plan has no data for the offset of " + reflector.name, "offset_mm");
    setups_.push_back(tracker_setup(setup, true));
    for (std::size_t i = 0; i < setup.stations.size(); ++i)
      for (std::size_t j = 0; j < setup.reflectors.size(); ++j) sights_.push_back({s, i, j});
  }
  if (sights_.empty()) throw InputError({.field = "setup"}, "the reflectors are missing", "[[setup.reflector]]");
  const Problem empty = problem(std::vector<TrackerReadings>(setups_.size()));
  parameters_ = estimated_parameters(empty);
  Problem with_priors = empty;
  for (const ParameterPrior& prior : study.identification->priors)
    for (const EstimatedParameter& parameter : parameters_)
      if (matches_pattern(parameter.name, prior.parameters) && parameter.is_angle == prior.is_angle)
        with_priors.priors.push_back({parameter.id, prior.value, prior.standard_uncertainty});
  for (std::size_t s = 0; s < study.setups.size(); ++s)
    for (const SetupReflector& reflector : study.setups[s].reflectors)
      for (int k = 0; k < 3; ++k)
        for (const EstimatedParameter& parameter : parameters_)
          if (reflector.offset_standard_uncertainty[k] > 0 && parameter.id.observations == s &&
              parameter.name == fmt::format("{}.offset_{}", reflector.name, "xyz"[k]))
            with_priors.priors.push_back({parameter.id, reflector.offset[k], reflector.offset_standard_uncertainty[k]});
  known_ = prior_rows(with_priors);
}

Problem PlanningModel::problem(const std::vector<TrackerReadings>& readings) const {
  std::vector<std::shared_ptr<Observations>> observations;
  for (std::size_t s = 0; s < setups_.size(); ++s) {
    TrackerReadings own = readings[s];
    own.poses.axis.resize(study_.machine.axes.size());
    observations.push_back(std::make_shared<TrackerObservations>(study_.machine, errors_, setups_[s], own));
  }
  Problem result = estimate_everything(study_.machine, errors_, observations);
  if (!study_.identification->tool_offset)
    result.machine_parameters.resize(result.machine_parameters.size() - 3);  // they come last
  return result;
}

PlanningModel::Candidates PlanningModel::readings_at(const PoseList& poses,
                                                     const std::vector<std::size_t>& sight) const {
  Candidates result;
  const std::vector<bool> out = forbidden(poses);
  result.forbidden = static_cast<std::size_t>(std::count(out.begin(), out.end(), true));
  std::vector<TrackerReadings> readings(setups_.size());
  for (std::size_t i = 0; i < sights_.size(); ++i) {
    PoseList own;
    own.axis.resize(poses.axis.size());
    for (std::size_t k = 0; k < poses.count(); ++k) {
      if (out[k] || (!sight.empty() && sight[k] % sights_.size() != i)) continue;
      for (std::size_t a = 0; a < poses.axis.size(); ++a) own.axis[a].push_back(poses.axis[a][k]);
    }
    if (own.count() == 0) continue;
    TrackerSimulationOptions options;
    options.measure = study_.setups[sights_[i].setup].measure;
    options.noise_factor = 0;
    options.threads = study_.threads;
    options.sights = {
        {static_cast<std::uint16_t>(sights_[i].station), static_cast<std::uint16_t>(sights_[i].reflector)}};
    const SimulatedTracker seen = simulate_tracker(study_.machine, ErrorSet{}, setups_[sights_[i].setup], own, options);
    result.hidden += seen.hidden;
    append_planned(readings[sights_[i].setup], seen.readings);
  }
  result.rows = candidate_rows(problem(readings));
  for (std::size_t s = 0; s < readings.size(); ++s)
    for (std::size_t k = 0; k < readings[s].count(); ++k)
      result.readings.push_back({readings[s].poses.pose(k), s, readings[s].station[k], readings[s].reflector[k]});
  return result;
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
    const double u =
        (parameters_[i].is_angle ? kAngle_rad : kLength_mm) * (parameters_[i].id.is_machine() ? 1 : kSetUp);
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
  for (std::size_t first = 0; first < n; first += ChainPlan::kBlockSize) {
    const std::size_t count = std::min(ChainPlan::kBlockSize, n - first);
    const std::vector<const double*> axis = pointers(poses, first);
    plan.differentiate({axis, count}, {}, {seen[0].data() + first, seen[1].data() + first, seen[2].data() + first},
                       rows, wanted, jacobian.data(), 3 * count);
    for (std::size_t c = 0; c < wanted.size(); ++c)
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < count; ++k)
          result(static_cast<Index>(3 * (first + k) + row), columns[c]) = jacobian[c * 3 * count + row * count + k];
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
