#include "abbe/identify/gauge_convention.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
using Weights = std::array<double, kComponentCount>;
constexpr double kPi = std::numbers::pi;
constexpr int kPoints = 720;

/// Builds functionals of the error motions of one axis.
class AxisFunctionals {
 public:
  AxisFunctionals(const Problem& problem, std::size_t axis) : problem_(problem) {
    const ErrorSet& errors = problem.errors;
    count_ = static_cast<Index>(estimated_count(problem));
    std::size_t next = 0;
    bool any = false;
    for (const ErrorMotion& motion : errors.motions) {
      // Terms with a state are none of the constants and lines that these conventions are about.
      if (motion.axis == axis && motion.state == kNoState) {
        terms_.push_back({&motion, next});
        const bool turn = motion.basis.kind == BasisKind::fourier || motion.basis.periodic;
        whole_turn_ = whole_turn_ && turn;
        from_ = any ? std::max(from_, motion.basis.from) : motion.basis.from;
        to_ = any ? std::min(to_, motion.basis.to) : motion.basis.to;
        any = true;
      }
      next += motion.coefficients.size();
    }
    if (whole_turn_ && any && problem.machine.axes[axis].kind == AxisKind::rotary) {
      from_ = 0;
      to_ = 2 * kPi;
    }
  }

  bool empty() const { return terms_.empty() || !(to_ > from_); }
  double from() const { return from_; }
  double to() const { return to_; }
  double reference() const { return std::clamp(0.0, from_, to_); }

  /// sum over components of weights times E(position).
  Eigen::VectorXd at(double position, const Weights& weights) const {
    Eigen::VectorXd functional = Eigen::VectorXd::Zero(count_);
    add(position, weights, 1, functional);
    return functional;
  }

  /// Integral of weight(position) * (weights . E(position)) over the range, midpoint or Gauss rule.
  Eigen::VectorXd integral(const std::function<Weights(double)>& weight) const {
    Eigen::VectorXd functional = Eigen::VectorXd::Zero(count_);
    // Over a whole turn equal steps are exact for harmonics; else Gauss-Legendre in pieces is exact for polynomials.
    static constexpr std::array<double, 4> kNodes = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                                     0.9602898564975363};
    static constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                       0.1012285362903763};
    const double range = to_ - from_;
    if (whole_turn_) {
      for (int i = 0; i < kPoints; ++i) {
        const double position = from_ + range * i / kPoints;
        add(position, weight(position), range / kPoints, functional);
      }
    } else {
      constexpr int kPieces = 32;
      for (int piece = 0; piece < kPieces; ++piece)
        for (std::size_t n = 0; n < kNodes.size(); ++n)
          for (const double side : {-1.0, 1.0}) {
            const double position = from_ + range * (piece + (1 + side * kNodes[n]) / 2) / kPieces;
            add(position, weight(position), kWeights[n] / 2 * range / kPieces, functional);
          }
    }
    const double largest = functional.cwiseAbs().maxCoeff();
    // Sums that cancel leave rounding; it would tie parameters together that have nothing to do with each other.
    for (Index i = 0; i < count_; ++i)
      if (std::abs(functional[i]) < 1e-13 * largest) functional[i] = 0;
    return functional;
  }

 private:
  struct Term {
    const ErrorMotion* motion;
    std::size_t first;
  };

  void add(double position, const Weights& weights, double factor, Eigen::VectorXd& functional) const {
    std::vector<double> values;
    for (const Term& term : terms_) {
      const double weight = weights[static_cast<std::size_t>(term.motion->component)] * factor;
      if (weight == 0) continue;
      values.assign(term.motion->basis.size(), 0.0);
      term.motion->basis.values(position, term.motion->coefficients, values);
      for (std::size_t k = 0; k < values.size(); ++k) {
        const auto found =
            std::lower_bound(problem_.machine_parameters.begin(), problem_.machine_parameters.end(), term.first + k);
        if (found != problem_.machine_parameters.end() && *found == term.first + k)
          functional[found - problem_.machine_parameters.begin()] += weight * values[k];
      }
    }
  }

  const Problem& problem_;
  std::vector<Term> terms_;
  Index count_ = 0;
  double from_ = 0, to_ = 0;
  bool whole_turn_ = true;
};

std::string position_text(double position, bool rotary) {
  return rotary ? fmt::format("{:.6g} deg", position / kDegree) : fmt::format("{:.6g} mm", position);
}

void add_candidate(std::vector<GaugeCandidate>& list, std::string words, std::string quantity,
                   const Eigen::VectorXd& functional, double value = 0) {
  if (functional.cwiseAbs().maxCoeff() > 0) list.push_back({std::move(words), std::move(quantity), functional, value});
}

Weights single(int component) {
  Weights weights{};
  weights[static_cast<std::size_t>(component)] = 1;
  return weights;
}

void constants(const Problem& problem, std::size_t axis, std::vector<GaugeCandidate>& list) {
  const AxisFunctionals functionals(problem, axis);
  if (functionals.empty()) return;
  const Axis& moving = problem.machine.axes[axis];
  const bool rotary = moving.kind == AxisKind::rotary;
  for (int component = 0; component < kComponentCount; ++component) {
    const std::string name = error_motion_name(problem.machine, axis, static_cast<Component>(component));
    const bool about_itself = component >= 3 && std::abs(moving.direction[component - 3]) > 0.9;
    if (rotary && !about_itself)
      add_candidate(
          list, fmt::format("the mean of {} over the range is zero", name), fmt::format("constant of {}", name),
          functionals.integral([&](double) { return single(component); }) / (functionals.to() - functionals.from()));
    else
      add_candidate(
          list,
          fmt::format("{} is zero at its reference position {}{}", name, position_text(functionals.reference(), rotary),
                      functionals.reference() == 0 ? "" : ", the end of its range nearest to zero"),
          fmt::format("constant of {}", name), functionals.at(functionals.reference(), single(component)));
  }
}

void once_per_turn(const Problem& problem, std::size_t axis, std::vector<GaugeCandidate>& list) {
  const AxisFunctionals functionals(problem, axis);
  if (functionals.empty()) return;
  const Axis& moving = problem.machine.axes[axis];
  Index own = 0;
  moving.direction.cwiseAbs().maxCoeff(&own);
  const Eigen::Vector3d first =
      (Eigen::Vector3d::Unit((own + 1) % 3) - moving.direction * moving.direction[(own + 1) % 3]).normalized();
  const Eigen::Vector3d second = moving.direction.cross(first);
  const double norm = 1 / (functionals.to() - functionals.from());
  for (const int offset : {0, 3}) {
    const std::string u = error_motion_name(problem.machine, axis, static_cast<Component>((own + 1) % 3 + offset));
    const std::string v = error_motion_name(problem.machine, axis, static_cast<Component>((own + 2) % 3 + offset));
    // A command of a primed axis turns the table the other way, and what is fixed to the table with it.
    const std::string body = moving.primed ? moving.name + "'" : moving.name;
    for (const double with : {1.0, -1.0})
      for (const bool quadrature : {false, true}) {
        // (u, v) = rho (cos, sense sin) turns with (with = 1) or against the axis; the quadrature part a quarter turn
        // later.
        const double sense = with * moving.sense();
        const auto weight = [&](double q) {
          const double along_u = quadrature ? -sense * std::sin(q) : std::cos(q);
          const double along_v = quadrature ? std::cos(q) : sense * std::sin(q);
          const Eigen::Vector3d direction = along_u * first + along_v * second;
          Weights weights{};
          for (int i = 0; i < 3; ++i)
            weights[static_cast<std::size_t>(i) + static_cast<std::size_t>(offset)] = direction[i];
          return weights;
        };
        add_candidate(list,
                      fmt::format("the once-per-turn part of {} and {} turning {} {} ({}) is zero (axis average line)",
                                  u, v, with > 0 ? "with" : "against", body, quadrature ? "sine" : "cosine"),
                      fmt::format("first harmonic of {} and {} ({}, {})", u, v, with > 0 ? "forward" : "backward",
                                  quadrature ? "sine" : "cosine"),
                      functionals.integral(weight) * norm);
      }
  }
}

void slopes(const Problem& problem, std::size_t axis, std::vector<GaugeCandidate>& list) {
  const AxisFunctionals functionals(problem, axis);
  if (functionals.empty()) return;
  const Axis& moving = problem.machine.axes[axis];
  const bool rotary = moving.kind == AxisKind::rotary;
  const double middle = (functionals.from() + functionals.to()) / 2;
  const double range = functionals.to() - functionals.from();
  // Straightness first: its reference line is a convention; a slope of positioning or of an angle is a real error.
  std::vector<int> order = {0, 1, 2, 3, 4, 5};
  std::stable_partition(order.begin(), order.end(),
                        [&](int c) { return c < 3 && std::abs(moving.direction[c]) < 0.9; });
  if (rotary) order = {};
  for (const int component : order) {
    const std::string name = error_motion_name(problem.machine, axis, static_cast<Component>(component));
    add_candidate(list, fmt::format("the slope of the reference straight line of {} is zero", name),
                  fmt::format("slope of {}", name), functionals.integral([&](double q) {
                    Weights weights{};
                    weights[static_cast<std::size_t>(component)] = 12 * (q - middle) / (range * range);
                    return weights;
                  }));
  }
}

/// Index of the direction's largest component; of equal ones the first.
int nearest_component(const Axis& axis) {
  int nearest = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(axis.direction[k]) > std::abs(axis.direction[nearest]) + 1e-9) nearest = k;
  return nearest;
}

/// An axis parallel to none of X, Y, Z: all its components are parameters, and combinations of them have no effect.
bool is_oblique(const Axis& axis) { return std::abs(axis.direction[nearest_component(axis)]) < 1 - 1e-12; }

bool is_nearest_to_oblique_axis(const std::vector<Axis>& axes, const LocationError& location) {
  const Axis& axis = axes[location.axis];
  return is_oblique(axis) && static_cast<int>(location.component) % 3 == nearest_component(axis);
}

/// Of every axis: where the six components of its location errors stand among the estimates, -1: nowhere.
std::vector<std::vector<Index>> places_of_locations(const Problem& problem, std::size_t motion_parameters) {
  std::vector<std::vector<Index>> places(problem.machine.axes.size(), std::vector<Index>(kComponentCount, -1));
  for (std::size_t i = 0; i < problem.machine_parameters.size(); ++i) {
    const std::size_t index = problem.machine_parameters[i];
    if (index < motion_parameters || index >= motion_parameters + problem.errors.locations.size()) continue;
    const LocationError& location = problem.errors.locations[index - motion_parameters];
    if (location.state != kNoState) continue;
    places[location.axis][static_cast<std::size_t>(location.component)] = static_cast<Index>(i);
  }
  return places;
}

/// What of its location errors lies along an oblique axis's own direction: its zero position error, and what does
/// nothing, the shift of a rotary axis along itself and the roll of a linear one. Said of a single component instead,
/// an axis 0.1 degrees off Y would have its tilt about X taken for that and fixed, and the same tilt left to a turn
/// about Y 600 times as large.
void along_oblique_axis(const Problem& problem, std::size_t axis, const std::vector<Index>& places, bool zero_position,
                        std::vector<GaugeCandidate>& list) {
  const Axis& moving = problem.machine.axes[axis];
  if (!is_oblique(moving)) return;
  const bool rotary = moving.kind == AxisKind::rotary;
  const int offset = zero_position == rotary ? 3 : 0;
  const double sign = moving.direction[nearest_component(moving)] < 0 ? -1 : 1;
  Eigen::VectorXd functional = Eigen::VectorXd::Zero(static_cast<Index>(estimated_count(problem)));
  for (int k = 0; k < 3; ++k) {
    const Index place = places[static_cast<std::size_t>(k + offset)];
    if (place >= 0) functional[place] = sign * moving.direction[k];
  }
  if (functional.isZero(0)) return;
  const std::string quantity = zero_position ? "zero position error of " + moving.name
                                             : fmt::format("{} of {} {} itself", rotary ? "shift" : "turn", moving.name,
                                                           rotary ? "along" : "about");
  add_candidate(list, fmt::format("the {} is zero", quantity), quantity, functional);
  list.back().exchangeable = zero_position;
}

}  // namespace

std::vector<GaugeCandidate> gauge_candidates(const Problem& problem, const Eigen::VectorXd& start) {
  std::vector<GaugeCandidate> list;
  const std::vector<Axis>& axes = problem.machine.axes;
  const auto each = [&](AxisKind kind, const auto& add) {
    for (std::size_t axis = 0; axis < axes.size(); ++axis)
      if (axes[axis].kind == kind) add(problem, axis, list);
  };
  each(AxisKind::linear, constants);
  each(AxisKind::rotary, constants);
  each(AxisKind::rotary, once_per_turn);
  each(AxisKind::linear, slopes);

  std::size_t motion_parameters = 0;
  for (const ErrorMotion& motion : problem.errors.motions) motion_parameters += motion.coefficients.size();
  const std::vector<std::vector<Index>> places = places_of_locations(problem, motion_parameters);
  for (const bool zero_position : {false, true})
    for (std::size_t axis = 0; axis < axes.size(); ++axis)
      along_oblique_axis(problem, axis, places[axis], zero_position, list);
  const std::vector<EstimatedParameter> parameters = estimated_parameters(problem);
  const std::size_t locations_end = motion_parameters + problem.errors.locations.size();
  const auto one = [&](std::size_t i) {
    const EstimatedParameter& parameter = parameters[i];
    const Eigen::VectorXd functional = Eigen::VectorXd::Unit(start.size(), static_cast<Index>(i));
    if (parameter.id.is_machine())
      add_candidate(list, fmt::format("{} is zero", parameter.name), parameter.name, functional);
    else
      add_candidate(list, fmt::format("{} keeps its start value", parameter.name), parameter.name, functional,
                    start[static_cast<Index>(i)]);
    list.back().exchangeable = true;
    list.back().of_location = parameter.id.is_machine() && parameter.id.index < locations_end;
  };
  std::vector<std::size_t> nearly_along;  // after the other location errors
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterId& id = parameters[i].id;
    if (id.is_machine() && id.index < motion_parameters) continue;
    if (id.is_machine() && id.index < locations_end &&
        is_nearest_to_oblique_axis(axes, problem.errors.locations[id.index - motion_parameters])) {
      nearly_along.push_back(i);
      continue;
    }
    if (!id.is_machine() || id.index >= locations_end) {
      for (const std::size_t k : nearly_along) one(k);
      nearly_along.clear();
    }
    one(i);
  }
  for (const std::size_t k : nearly_along) one(k);
  return list;
}

}  // namespace abbe
