#include "abbe/identify/parameter_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace abbe {
namespace {

constexpr double kParallel = 0.99;

std::string words_of_state(const Machine& machine, std::size_t state) {
  return state == kNoState ? std::string() : " with " + machine.states[state].name;
}

/// The error a machine parameter belongs to: "EXX" with its words.
std::string words_of(const Problem& problem, std::size_t index) {
  const Machine& machine = problem.machine;
  std::size_t next = 0;
  for (const ErrorMotion& motion : problem.errors.motions) {
    next += motion.coefficients.size();
    if (index < next) {
      return error_motion_name(machine, motion.axis, motion.component, motion.state) + ": " +
             error_words(machine, motion.axis, motion.component, false) + words_of_state(machine, motion.state);
    }
  }
  if (index - next < problem.errors.locations.size()) {
    const LocationError& location = problem.errors.locations[index - next];
    return location_error_name(machine, location.axis, location.component, location.state) + ": " +
           error_words(machine, location.axis, location.component, true) + words_of_state(machine, location.state);
  }
  next += problem.errors.locations.size();
  if (index - next < problem.errors.reversals.size()) {
    const std::size_t axis = problem.errors.reversals[index - next].axis;
    return reversal_name(machine, axis) + ": reversal value of " + machine.axes[axis].name;
  }
  next += problem.errors.reversals.size();
  return fmt::format("tool_{}: error of the tool offset in {}", "XYZ"[index - next], "XYZ"[index - next]);
}

}  // namespace

std::string error_words(const Machine& machine, std::size_t axis, Component component, bool is_location) {
  const Axis& moving = machine.axes[axis];
  const bool rotation = is_rotation(component);
  const int k = static_cast<int>(component) % 3;
  const char along = "XYZ"[k];
  const bool own = std::abs(moving.direction[k]) > kParallel;
  const bool rotary = moving.kind == AxisKind::rotary;
  const std::string& name = moving.name;
  if (is_location) {
    if (is_zero_position_error(moving, component)) return "zero position error of " + name;
    if (!rotary) return fmt::format("squareness or parallelism error of {} about {}", name, along);
    return rotation ? fmt::format("orientation error of the axis average line of {} about {}", name, along)
                    : fmt::format("position error of the axis average line of {} in {}", name, along);
  }
  if (!rotary) {
    if (!rotation) {
      return own ? "positioning error motion of " + name
                 : fmt::format("straightness error motion of {} in {}", name, along);
    }
    return own ? "roll error motion of " + name : fmt::format("angular error motion of {} about {}", name, along);
  }
  if (!rotation) {
    return own ? "axial error motion of " + name : fmt::format("radial error motion of {} in {}", name, along);
  }
  return own ? "angular positioning error motion of " + name
             : fmt::format("tilt error motion of {} about {}", name, along);
}

std::string parameter_words(const Problem& problem, const std::vector<EstimatedParameter>& parameters,
                            const std::vector<std::size_t>& which, std::size_t most) {
  std::vector<std::string> said;
  for (const std::size_t i : which) {
    const ParameterId& id = parameters[i].id;
    std::string words = id.is_machine()
                            ? words_of(problem, id.index)
                            : "unknowns of the set-up of " + problem.observations[id.observations].observations->name();
    if (std::find(said.begin(), said.end(), words) == said.end()) said.push_back(std::move(words));
  }
  std::string text;
  for (std::size_t k = 0; k < std::min(most, said.size()); ++k) text += (k > 0 ? "; " : "") + said[k];
  if (said.size() > most) text += fmt::format("; and {} more", said.size() - most);
  return text;
}

std::vector<std::size_t> largest_entries(const Eigen::VectorXd& direction, double share) {
  constexpr double kSameAmount = 1e-6;
  const double largest = direction.size() > 0 ? direction.cwiseAbs().maxCoeff() : 0;
  const auto amount = [&](std::size_t i) {
    const double entry = std::abs(direction[static_cast<Eigen::Index>(i)]);
    return largest > 0 ? std::round(entry / (kSameAmount * largest)) : 0.0;
  };
  std::vector<std::size_t> order(static_cast<std::size_t>(direction.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return amount(a) > amount(b); });
  while (!order.empty() && amount(order.back()) < share / kSameAmount) order.pop_back();
  return order;
}

}  // namespace abbe
