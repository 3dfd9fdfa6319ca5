// Which sensors a plan needs.
#include <algorithm>
#include <cmath>
#include <map>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/study/planning/planning.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Sizes of errors with states that an earlier identification has found, by names of parameters.
std::map<std::string, double> sizes_found(const Study& study) {
  std::map<std::string, double> sizes;
  if (!study.identification || !study.identification->initial_errors) return sizes;
  const ErrorSet errors =
      read_errors(*study.identification->initial_errors, study.machine, StatesOfErrors::allowed).errors;
  const std::vector<std::string> names = parameter_names(study.machine, errors);
  const std::vector<double> values = errors.parameters();
  for (std::size_t p = 0; p < names.size(); ++p) sizes[names[p]] = std::abs(values[p]);
  return sizes;
}

SensorTerms sensor_terms(const PlanningModel& model) {
  const Machine& machine = model.study().machine;
  const std::vector<std::size_t>& sensors = model.states().sensors();
  SensorTerms terms;
  for (const std::size_t sensor : sensors) terms.names.push_back(state_column(machine.states[sensor]));
  terms.size = model.weak_prior().diagonal().cwiseSqrt().cwiseInverse();
  const std::map<std::string, double> found = sizes_found(model.study());
  for (std::size_t p = 0; p < model.parameter_count(); ++p) {
    std::vector<std::size_t>& needs = terms.needs.emplace_back();
    for (const std::size_t state : sensors_of_state(machine, model.state_of(p))) {
      needs.push_back(static_cast<std::size_t>(std::find(sensors.begin(), sensors.end(), state) - sensors.begin()));
    }
    const auto size = found.find(model.parameters()[p].name);
    if (!needs.empty() && size != found.end() && size->second > 0) terms.size[static_cast<Index>(p)] = size->second;
  }
  return terms;
}

}  // namespace

SensorSelection planned_sensors(const PlanningModel& model, const PlanningCandidates& readings,
                                const Eigen::MatrixXd& predictions,
                                const std::vector<std::vector<double>>& reading_states) {
  const SensorTerms terms = sensor_terms(model);
  SensorPrediction planned;
  planned.information = readings.rows.transpose() * readings.rows + model.known().transpose() * model.known();
  planned.prediction = predictions.transpose() * predictions / (static_cast<double>(predictions.rows()) / 3);
  SensorSelection result = select_sensors(
      terms.names, [&](const std::vector<std::uint8_t>& has) { return predicted_error(terms, planned, has); });
  // Over the whole course; values that can be chosen are as unlike as the plan takes them.
  const std::vector<std::vector<double>>& over =
      model.states().has_course() ? model.states().used_at() : reading_states;
  std::vector<std::size_t> needed;
  for (std::size_t j = 0; !over.empty() && j < over.front().size(); ++j) {
    if (std::isnan(over.front()[j])) continue;
    needed.push_back(j);
    result.courses.push_back(model.study().machine.states[j].name);
  }
  Eigen::MatrixXd course(static_cast<Index>(over.size()), static_cast<Index>(needed.size()));
  for (std::size_t k = 0; k < over.size(); ++k) {
    for (std::size_t n = 0; n < needed.size(); ++n) {
      course(static_cast<Index>(k), static_cast<Index>(n)) = over[k][needed[n]];
    }
  }
  result.alike = like_sensors(course);
  return result;
}

}  // namespace abbe
