#include "abbe/identify/problem.h"

#include <algorithm>
#include <numeric>

namespace abbe {

Problem estimate_everything(const Machine& machine, const ErrorSet& errors,
                            const std::vector<std::shared_ptr<Observations>>& observations) {
  Problem problem;
  problem.machine = machine;
  problem.errors = errors;
  problem.machine_parameters.resize(errors.parameter_count());
  std::iota(problem.machine_parameters.begin(), problem.machine_parameters.end(), std::size_t{0});
  for (const std::shared_ptr<Observations>& one : observations) {
    SelectedObservations selected;
    selected.observations = one;
    selected.unknowns.resize(one->unknowns().size());
    std::iota(selected.unknowns.begin(), selected.unknowns.end(), std::size_t{0});
    problem.observations.push_back(std::move(selected));
  }
  return problem;
}

std::shared_ptr<Observations> borrowed(Observations& observations) {
  return {std::shared_ptr<Observations>(), &observations};
}

std::vector<EstimatedParameter> estimated_parameters(const Problem& problem) {
  std::vector<EstimatedParameter> result;
  const std::vector<std::string> names = parameter_names(problem.machine, problem.errors);
  const std::vector<bool> angles = parameters_are_angles(problem.machine, problem.errors);
  for (const std::size_t i : problem.machine_parameters)
    result.push_back({names[i], angles[i], {ParameterId::kMachine, i}, false});
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const std::vector<SetupUnknown>& unknowns = problem.observations[o].observations->unknowns();
    for (const std::size_t i : problem.observations[o].unknowns)
      result.push_back({unknowns[i].name, unknowns[i].is_angle, {o, i}, unknowns[i].is_pure_number});
  }
  return result;
}

std::size_t estimated_count(const Problem& problem) {
  std::size_t count = problem.machine_parameters.size();
  for (const SelectedObservations& selected : problem.observations) count += selected.unknowns.size();
  return count;
}

Eigen::VectorXd present_values(const Problem& problem) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(estimated_count(problem)));
  Eigen::Index next = 0;
  const std::vector<double> machine = problem.errors.parameters();
  for (const std::size_t i : problem.machine_parameters) values[next++] = machine[i];
  for (const SelectedObservations& selected : problem.observations) {
    const std::vector<double> setup = selected.observations->unknown_values();
    for (const std::size_t i : selected.unknowns) values[next++] = setup[i];
  }
  return values;
}

ReadingPoint reading_point(const Problem& problem, const Eigen::VectorXd& estimates) {
  ReadingPoint point;
  point.machine = problem.errors.parameters();
  Eigen::Index next = 0;
  for (const std::size_t i : problem.machine_parameters) point.machine[i] = estimates[next++];
  for (const SelectedObservations& selected : problem.observations) {
    point.setups.push_back(selected.observations->unknown_values());
    for (const std::size_t i : selected.unknowns) point.setups.back()[i] = estimates[next++];
  }
  return point;
}

void set_observations(const Problem& problem, const ReadingPoint& point) {
  for (std::size_t o = 0; o < problem.observations.size(); ++o)
    problem.observations[o].observations->set_parameters(point.machine, point.setups[o]);
}

void set_observations(const Problem& problem, const Eigen::VectorXd& estimates) {
  set_observations(problem, reading_point(problem, estimates));
}

void keep_estimates(Problem& problem, const Eigen::VectorXd& estimates) {
  const ReadingPoint point = reading_point(problem, estimates);
  set_observations(problem, point);
  problem.errors.set_parameters(point.machine);
}

std::size_t find_estimated(const Problem& problem, const ParameterId& id) {
  std::size_t next = 0;
  const auto position = [](const std::vector<std::size_t>& list, std::size_t index) {
    return static_cast<std::size_t>(std::find(list.begin(), list.end(), index) - list.begin());
  };
  if (id.is_machine()) {
    const std::size_t found = position(problem.machine_parameters, id.index);
    return found < problem.machine_parameters.size() ? found : estimated_count(problem);
  }
  next = problem.machine_parameters.size();
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const std::vector<std::size_t>& unknowns = problem.observations[o].unknowns;
    if (o == id.observations) {
      const std::size_t found = position(unknowns, id.index);
      return found < unknowns.size() ? next + found : estimated_count(problem);
    }
    next += unknowns.size();
  }
  return next;
}

std::size_t used_reading_count(const SelectedObservations& selected) {
  if (selected.use.empty()) return selected.observations->reading_count();
  return static_cast<std::size_t>(
      std::count_if(selected.use.begin(), selected.use.end(), [](std::uint8_t used) { return used != 0; }));
}

std::size_t used_reading_count(const Problem& problem) {
  std::size_t count = 0;
  for (const SelectedObservations& selected : problem.observations) count += used_reading_count(selected);
  return count;
}

std::size_t used_residual_count(const Problem& problem) {
  std::size_t count = 0;
  for (const SelectedObservations& selected : problem.observations)
    count += used_reading_count(selected) * static_cast<std::size_t>(selected.observations->rows());
  return count;
}

}  // namespace abbe
