#include "abbe/errors/error_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace abbe {
namespace {

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

/// What remains of a state at given values of its inputs.
struct FoldedState {
  double factor = 1;
  std::size_t state = kNoState;
};

FoldedState folded(const Machine& machine, std::size_t state, std::span<const double> values) {
  if (state == kNoState) return {};
  const MachineState& one = machine.states.at(state);
  if (is_input(one.kind)) {
    const double value = state < values.size() ? values[state] : kNotGiven;
    if (!std::isfinite(value)) throw std::invalid_argument("the state " + one.name + " is not given");
    return {value - one.reference, kNoState};
  }
  if (one.kind != StateKind::product) return {1, state};
  const FoldedState first = folded(machine, one.first, values), second = folded(machine, one.second, values);
  if (first.state != kNoState && second.state != kNoState) return {1, state};
  return {first.factor * second.factor, first.state == kNoState ? second.state : first.state};
}

}  // namespace

bool has_states(const ErrorSet& errors) {
  return std::any_of(errors.motions.begin(), errors.motions.end(),
                     [](const ErrorMotion& motion) { return motion.state != kNoState; }) ||
         std::any_of(errors.locations.begin(), errors.locations.end(),
                     [](const LocationError& location) { return location.state != kNoState; });
}

std::string first_error_with_state(const Machine& machine, const ErrorSet& errors) {
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.state != kNoState) return error_motion_name(machine, motion.axis, motion.component, motion.state);
  }
  for (const LocationError& location : errors.locations) {
    if (location.state == kNoState) continue;
    return location_error_name(machine, location.axis, location.component, location.state);
  }
  return {};
}

std::vector<std::uint8_t> used_states(const Machine& machine, const ErrorSet& errors) {
  std::vector<std::uint8_t> used(machine.states.size(), 0);
  const auto note = [&](std::size_t state) {
    if (state == kNoState) return;
    const MachineState& one = machine.states.at(state);
    used[state] = 1;
    if (one.kind == StateKind::product) used.at(one.first) = used.at(one.second) = 1;
  };
  for (const ErrorMotion& motion : errors.motions) note(motion.state);
  for (const LocationError& location : errors.locations) note(location.state);
  return used;
}

std::size_t missing_state(const Machine& machine, const ErrorSet& errors, const PoseList& poses) {
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] == 0 || !is_input(machine.states[j].kind)) continue;
    if (j >= poses.state.size() || poses.state[j].size() != poses.count()) return j;
    if (!std::all_of(poses.state[j].begin(), poses.state[j].end(), [](double v) { return std::isfinite(v); })) return j;
  }
  return kNoState;
}

void require_states(const Machine& machine, const ErrorSet& errors, const PoseList& poses) {
  const std::size_t missing = missing_state(machine, errors, poses);
  if (missing == kNoState) return;
  throw std::invalid_argument("errors depend on the state " + machine.states[missing].name +
                              ", which is not given at all poses");
}

std::vector<double> reference_states(const Machine& machine) {
  std::vector<double> values;
  for (const MachineState& state : machine.states) {
    values.push_back(is_input(state.kind) ? state.reference : kNotGiven);
  }
  return values;
}

void stand_at_references(const Machine& machine, PoseList& poses) {
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (!is_input(machine.states[j].kind)) continue;
    poses.state.resize(machine.states.size());
    if (poses.state[j].empty()) poses.state[j].assign(poses.count(), machine.states[j].reference);
  }
}

std::string reference_words(const Machine& machine, const ErrorSet& errors) {
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  std::string words;
  for (std::size_t j = 0; j < used.size(); ++j) {
    const MachineState& state = machine.states[j];
    if (used[j] == 0 || !is_input(state.kind)) continue;
    words += fmt::format("{}{} {:.6g}{}", words.empty() ? "" : ", ", state.name, state.reference,
                         state.unit == "1" ? "" : " " + state.unit);
  }
  return words;
}

ErrorSet at_state(const Machine& machine, const ErrorSet& errors, std::span<const double> values,
                  Eigen::MatrixXd* by_parameters) {
  ErrorSet result = errors;
  result.locations.clear();
  std::vector<double> factors;         // per parameter of the errors
  std::vector<std::size_t> parameter;  // where it goes in the result
  for (ErrorMotion& motion : result.motions) {
    const FoldedState fold = folded(machine, motion.state, values);
    motion.state = fold.state;
    for (double& coefficient : motion.coefficients) coefficient *= fold.factor;
    for (double& uncertainty : motion.standard_uncertainty) uncertainty *= std::abs(fold.factor);
    for (std::size_t k = 0; k < motion.coefficients.size(); ++k) {
      parameter.push_back(factors.size());
      factors.push_back(fold.factor);
    }
  }
  const std::size_t first_location = factors.size();
  for (LocationError location : errors.locations) {
    const FoldedState fold = folded(machine, location.state, values);
    location.state = fold.state;
    location.value *= fold.factor;
    location.standard_uncertainty *= std::abs(fold.factor);
    const auto same = std::find_if(result.locations.begin(), result.locations.end(), [&](const LocationError& other) {
      return other.axis == location.axis && other.component == location.component && other.state == location.state;
    });
    factors.push_back(fold.factor);
    parameter.push_back(first_location + static_cast<std::size_t>(same - result.locations.begin()));
    if (same == result.locations.end()) {
      result.locations.push_back(location);
    } else {
      same->value += location.value;
      same->standard_uncertainty = std::hypot(same->standard_uncertainty, location.standard_uncertainty);
    }
  }
  if (by_parameters == nullptr) return result;
  const std::size_t before = errors.parameter_count(), after = result.parameter_count();
  by_parameters->setZero(static_cast<Eigen::Index>(after), static_cast<Eigen::Index>(before));
  for (std::size_t p = 0; p < before; ++p) {
    const std::size_t to = p < parameter.size() ? parameter[p] : after - (before - p);
    (*by_parameters)(static_cast<Eigen::Index>(to), static_cast<Eigen::Index>(p)) = p < factors.size() ? factors[p] : 1;
  }
  return result;
}

GivenStates::GivenStates(const Machine& machine, const ErrorSet& errors) : states_(machine.states.size()) {
  const std::vector<std::uint8_t> used = used_states(machine, errors);
  for (std::size_t j = 0; j < used.size(); ++j) {
    const bool is_approach = machine.states[j].kind == StateKind::approach;
    if (used[j] == 0 || !(is_approach || is_input(machine.states[j].kind))) continue;
    columns_.push_back({j, is_approach, machine.states[j].axis});
  }
}

double GivenStates::value(const PoseList& poses, const Column& column, std::size_t pose) {
  if (column.is_approach) return poses.approach.empty() ? 0 : poses.approach[column.axis][pose];
  if (column.state >= poses.state.size() || poses.state[column.state].empty()) return kNotGiven;
  return poses.state[column.state][pose];
}

template <class PoseAt>
void GivenStates::gather_from(const PoseList& poses, std::size_t count, const PoseAt& pose_at, std::size_t stride,
                              std::vector<double>& memory, std::vector<const double*>& pointers) const {
  pointers.clear();
  if (columns_.empty()) return;
  pointers.resize(states_, nullptr);
  memory.resize(columns_.size() * stride);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    double* values = &memory[c * stride];
    for (std::size_t k = 0; k < count; ++k) values[k] = value(poses, columns_[c], pose_at(k));
    pointers[columns_[c].state] = values;
  }
}

void GivenStates::gather(const PoseList& poses, std::size_t first, std::span<const std::uint16_t> at,
                         std::size_t stride, std::vector<double>& memory, std::vector<const double*>& pointers) const {
  gather_from(
      poses, at.size(), [&](std::size_t k) { return first + at[k]; }, stride, memory, pointers);
}

void GivenStates::gather(const PoseList& poses, std::span<const std::size_t> chosen, std::vector<double>& memory,
                         std::vector<const double*>& pointers) const {
  gather_from(
      poses, chosen.size(), [&](std::size_t k) { return chosen[k]; }, chosen.size(), memory, pointers);
}

std::vector<double> GivenStates::at(const PoseList& poses, std::size_t pose) const {
  if (columns_.empty()) return {};
  std::vector<double> values(states_, kNotGiven);
  for (const Column& column : columns_) values[column.state] = value(poses, column, pose);
  return values;
}

OnePose::OnePose(const std::vector<double>& positions, const std::vector<double>& given) {
  for (const double& position : positions) axis_.push_back(&position);
  for (const double& value : given) state_.push_back(&value);
}

}  // namespace abbe
