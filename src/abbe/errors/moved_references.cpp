#include "abbe/errors/moved_references.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace abbe {
namespace {

/// A part of an old factor: a number times the new factor of a state; kNoState: the number alone.
struct FactorPart {
  std::size_t state;
  double times;
};

double moved_by(const Machine& machine, std::size_t state, std::span<const double> values) {
  const MachineState& one = machine.states.at(state);
  if (!is_input(one.kind) || state >= values.size() || !std::isfinite(values[state])) return 0;
  return values[state] - one.reference;
}

/// What an old factor is besides the new factor of the same state.
std::vector<FactorPart> other_parts(const Machine& machine, std::size_t state, std::span<const double> values) {
  std::vector<FactorPart> parts;
  if (state == kNoState) return parts;
  const auto add = [&](std::size_t of, double times) {
    if (times != 0) parts.push_back({of, times});
  };
  const MachineState& one = machine.states.at(state);
  if (one.kind != StateKind::product) {
    add(kNoState, moved_by(machine, state, values));
    return parts;
  }
  // (g + a) (h + b) = g h + b g + a h + a b
  const double a = moved_by(machine, one.first, values), b = moved_by(machine, one.second, values);
  add(one.first, b);
  add(one.second, a);
  add(kNoState, a * b);
  return parts;
}

/// Whether the functions of one basis are the first functions of another one.
bool begins_with(const Basis& longer, const Basis& shorter) {
  if (longer == shorter) return true;
  const bool nested = longer.kind == BasisKind::monomial || longer.kind == BasisKind::legendre ||
                      longer.kind == BasisKind::chebyshev || longer.kind == BasisKind::fourier;
  Basis same = longer;
  same.order = shorter.order;
  return nested && same == shorter && longer.order > shorter.order;
}

/// Parameters of a set as sums of those of another one.
class ParameterSums {
 public:
  void add_rows(std::size_t count) { rows_.resize(rows_.size() + count); }
  void add(std::size_t row, std::size_t parameter, double times) { rows_[row].push_back({parameter, times}); }
  Eigen::MatrixXd matrix(std::size_t columns) const {
    Eigen::MatrixXd sums =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(columns));
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      for (const auto& [p, times] : rows_[r]) {
        sums(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(p)) += times;
      }
    }
    return sums;
  }
  std::size_t count() const { return rows_.size(); }

 private:
  std::vector<std::vector<std::pair<std::size_t, double>>> rows_;
};

class MovedReferences {
 public:
  MovedReferences(const Machine& machine, const ErrorSet& errors, std::span<const double> values)
      : machine_(machine), errors_(errors), values_(values), result_(errors) {}

  ErrorSet moved(Eigen::MatrixXd* by_parameters) {
    move_motions();
    move_locations();
    const std::size_t rest = errors_.reversals.size() + 3, before = errors_.parameter_count();
    const std::size_t first = sums_.count();
    sums_.add_rows(rest);
    for (std::size_t k = 0; k < rest; ++k) sums_.add(first + k, before - rest + k, 1);
    if (by_parameters != nullptr) *by_parameters = sums_.matrix(before);
    return std::move(result_);
  }

 private:
  void move_motions() {
    std::vector<std::size_t> row;  // first of each motion of the result
    for (const ErrorMotion& motion : errors_.motions) {
      row.push_back(parameter_);
      sums_.add_rows(motion.coefficients.size());
      for (std::size_t k = 0; k < motion.coefficients.size(); ++k, ++parameter_) sums_.add(parameter_, parameter_, 1);
    }
    for (std::size_t m = 0; m < errors_.motions.size(); ++m) {
      const ErrorMotion& motion = errors_.motions[m];
      for (const FactorPart& part : other_parts(machine_, motion.state, values_)) {
        const std::size_t to = target(motion, part.state);
        if (to == row.size()) {
          row.push_back(sums_.count());
          sums_.add_rows(motion.coefficients.size());
        }
        add(motion, row[m], part.times, row[to], result_.motions[to]);
      }
    }
  }

  /// Index of the motion to which a part of another one is added; a new one where there is none.
  std::size_t target(const ErrorMotion& motion, std::size_t state) {
    for (std::size_t i = 0; i < result_.motions.size(); ++i) {
      const ErrorMotion& one = result_.motions[i];
      if (one.axis != motion.axis || one.component != motion.component || one.state != state) continue;
      // Its slopes follow from its own values: two such curves are not the curve of the sums.
      if (motion.basis.kind == BasisKind::table_monotone) continue;
      if (begins_with(one.basis, motion.basis)) return i;
    }
    ErrorMotion fresh = motion;
    fresh.state = state;
    std::fill(fresh.coefficients.begin(), fresh.coefficients.end(), 0.0);
    std::fill(fresh.standard_uncertainty.begin(), fresh.standard_uncertainty.end(), 0.0);
    result_.motions.push_back(std::move(fresh));
    return result_.motions.size() - 1;
  }

  void add(const ErrorMotion& motion, std::size_t from_row, double times, std::size_t to_row, ErrorMotion& to) {
    if (!motion.standard_uncertainty.empty()) to.standard_uncertainty.resize(to.coefficients.size(), 0.0);
    for (std::size_t k = 0; k < motion.coefficients.size(); ++k) {
      to.coefficients[k] += times * motion.coefficients[k];
      if (!motion.standard_uncertainty.empty()) {
        to.standard_uncertainty[k] = std::hypot(to.standard_uncertainty[k], times * motion.standard_uncertainty[k]);
      }
      sums_.add(to_row + k, from_row + k, times);
    }
  }

  void move_locations() {
    const std::size_t first = sums_.count();
    sums_.add_rows(errors_.locations.size());
    for (std::size_t k = 0; k < errors_.locations.size(); ++k) sums_.add(first + k, parameter_ + k, 1);
    for (std::size_t k = 0; k < errors_.locations.size(); ++k) {
      const LocationError& location = errors_.locations[k];
      for (const FactorPart& part : other_parts(machine_, location.state, values_)) {
        const std::size_t to = location_target(location, part.state);
        if (first + to == sums_.count()) sums_.add_rows(1);
        LocationError& sum = result_.locations[to];
        sum.value += part.times * location.value;
        sum.standard_uncertainty = std::hypot(sum.standard_uncertainty, part.times * location.standard_uncertainty);
        sums_.add(first + to, parameter_ + k, part.times);
      }
    }
  }

  std::size_t location_target(const LocationError& location, std::size_t state) {
    const auto same = std::find_if(result_.locations.begin(), result_.locations.end(), [&](const LocationError& one) {
      return one.axis == location.axis && one.component == location.component && one.state == state;
    });
    const auto at = static_cast<std::size_t>(same - result_.locations.begin());
    if (same == result_.locations.end()) {
      result_.locations.push_back({.axis = location.axis, .component = location.component, .state = state});
    }
    return at;
  }

  const Machine& machine_;
  const ErrorSet& errors_;
  std::span<const double> values_;
  ErrorSet result_;
  ParameterSums sums_;
  std::size_t parameter_ = 0;  // of the errors: behind those of the motions, once these are moved
};

}  // namespace

ErrorSet with_references(const Machine& machine, const ErrorSet& errors, std::span<const double> values,
                         Eigen::MatrixXd* by_parameters) {
  return MovedReferences(machine, errors, values).moved(by_parameters);
}

Machine with_references(Machine machine, std::span<const double> values) {
  for (std::size_t j = 0; j < std::min(values.size(), machine.states.size()); ++j) {
    if (is_input(machine.states[j].kind) && std::isfinite(values[j])) machine.states[j].reference = values[j];
  }
  return machine;
}

}  // namespace abbe
