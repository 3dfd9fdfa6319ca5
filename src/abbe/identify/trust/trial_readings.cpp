#include "abbe/identify/trust/trial_readings.h"

#include <algorithm>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/planning_candidates.h"

namespace abbe {

using Eigen::Index;

ErrorSet without_errors(const Problem& problem) {
  ErrorSet errors = problem.errors;
  errors.set_parameters(std::vector<double>(errors.parameter_count(), 0.0));
  return errors;
}

PossibleMeasurement trial_measurement(const Problem& problem, std::size_t observations, std::string words,
                                      Observations& trial, const std::vector<TrialUnknown>& unknowns) {
  Problem small = estimate_everything(problem.machine, without_errors(problem), {borrowed(trial)});
  small.machine_parameters = problem.machine_parameters;
  const PlanningCandidates rows = candidate_rows(small);
  const std::vector<EstimatedParameter> ours = estimated_parameters(problem), theirs = estimated_parameters(small);
  const Index p = static_cast<Index>(ours.size());
  PossibleMeasurement measurement;
  measurement.words = std::move(words);
  std::vector<Index> column;
  std::vector<std::pair<Index, double>> known;
  for (const EstimatedParameter& parameter : theirs) {
    if (parameter.id.is_machine()) {
      column.push_back(static_cast<Index>(find_estimated(problem, parameter.id)));
      continue;
    }
    const TrialUnknown& unknown = unknowns[parameter.id.index];
    const auto same = std::find_if(ours.begin(), ours.end(), [&](const EstimatedParameter& one) {
      return one.id.observations == observations && one.name == parameter.name;
    });
    if (!unknown.own && same != ours.end()) {
      column.push_back(static_cast<Index>(same - ours.begin()));
      continue;
    }
    column.push_back(p + static_cast<Index>(measurement.own++));
    if (unknown.standard_uncertainty > 0) known.emplace_back(column.back(), unknown.standard_uncertainty);
  }
  const Index all = rows.rows.rows();
  measurement.rows =
      PlanningCandidates::Rows::Zero(all + static_cast<Index>(known.size()), p + static_cast<Index>(measurement.own));
  for (std::size_t c = 0; c < column.size(); ++c)
    measurement.rows.col(column[c]).head(all) = rows.rows.col(static_cast<Index>(c));
  for (std::size_t k = 0; k < known.size(); ++k)
    measurement.rows(all + static_cast<Index>(k), known[k].first) = 1 / known[k].second;
  return measurement;
}

Eigen::MatrixXd rows_without_own(const PossibleMeasurement& measurement, Index parameters) {
  Eigen::MatrixXd rows = measurement.rows.leftCols(parameters);
  if (measurement.own == 0) return rows;
  const Eigen::MatrixXd own = measurement.rows.rightCols(static_cast<Index>(measurement.own));
  const PivotedQr qr(own);
  const Eigen::MatrixXd basis = qr.orthonormal(qr.rank());
  return rows - basis * (basis.transpose() * rows);
}

Eigen::VectorXd typical_sizes(const std::vector<EstimatedParameter>& parameters, const AdviceOptions& options) {
  constexpr double kSetUp = 1e3;  // times that of the machine
  Eigen::VectorXd sizes(static_cast<Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double factor = parameters[i].id.is_machine() ? 1 : kSetUp;
    sizes[static_cast<Index>(i)] = factor * (parameters[i].is_angle ? options.typical_angle : options.typical_length);
  }
  return sizes;
}

namespace {

/// What the set-ups of a problem could read additionally where they stand.
void add_further_readings(const Problem& problem, std::vector<PossibleMeasurement>& list) {
  const std::vector<EstimatedParameter> parameters = estimated_parameters(problem);
  const ErrorSet errors = without_errors(problem);
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    for (const FurtherReadings& further :
         problem.observations[o].observations->further_readings(problem.machine, errors)) {
      PossibleMeasurement measurement = trial_measurement(problem, o, further.words, *further.trial, further.unknowns);
      for (const auto& [name, axes] : further.turned) {
        for (std::size_t c = 0; c + 2 < parameters.size(); ++c) {
          if (parameters[c].id.observations != o || parameters[c].name != name) continue;
          measurement.rows.middleCols<3>(static_cast<Index>(c)) =
              (measurement.rows.middleCols<3>(static_cast<Index>(c)) * axes).eval();
        }
      }
      list.push_back(std::move(measurement));
    }
  }
}

}  // namespace

std::vector<PossibleMeasurement> possible_measurements(const Problem& problem) {
  std::vector<PossibleMeasurement> list;
  add_further_readings(problem, list);
  add_further_instruments(problem, list);
  return list;
}

}  // namespace abbe
