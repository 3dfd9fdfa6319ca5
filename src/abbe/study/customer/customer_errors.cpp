#include "abbe/study/customer/customer_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/customer/customer_words.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

using Word = CustomerWord;

constexpr std::size_t kMotionPoints = 121;

const char* shown_unit(bool angle) { return angle ? "µrad" : "µm"; }

std::string letter(Component component) { return {component_letter(component)}; }

/// One error motion of one axis: all its terms, their range and its uncertainty.
class IdentifiedCurve {
 public:
  /// @returns nothing if no term is identified
  static std::optional<IdentifiedCurve> find(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                             std::size_t axis, Component component) {
    IdentifiedCurve curve(errors, covariance);
    Eigen::Index first = 0;
    for (std::size_t m = 0; m < errors.motions.size(); ++m) {
      const ErrorMotion& motion = errors.motions[m];
      if (motion.axis == axis && motion.component == component && motion.state == kNoState) curve.add(m, first);
      first += static_cast<Eigen::Index>(motion.basis.size());
    }
    return curve.terms_.empty() ? std::nullopt : std::optional(std::move(curve));
  }

  double from() const { return from_; }
  double to() const { return to_; }
  bool covers(double position) const {
    return std::all_of(terms_.begin(), terms_.end(),
                       [&](const Term& term) { return errors_.motions[term.motion].basis.covers(position); });
  }
  double value(double position) const {
    double sum = 0;
    for (const Term& term : terms_) {
      const ErrorMotion& motion = errors_.motions[term.motion];
      sum += motion.basis.evaluate(position, motion.coefficients);
    }
    return sum;
  }
  /// d(value)/d(parameters of the error set).
  Eigen::VectorXd derivatives(double position) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(errors_.parameter_count()));
    for (const Term& term : terms_) {
      const ErrorMotion& motion = errors_.motions[term.motion];
      motion.basis.values(position, motion.coefficients, {row.data() + term.first, motion.basis.size()});
    }
    return row;
  }
  double expanded_uncertainty(const Eigen::VectorXd& row) const {
    if (covariance_.size() == 0) return 0;  // not stated
    return 2 * std::sqrt(std::max(0.0, row.dot(covariance_ * row)));
  }
  double position(std::size_t index, std::size_t count) const {
    return from_ + (to_ - from_) * static_cast<double>(index) / static_cast<double>(count - 1);
  }

 private:
  struct Term {
    std::size_t motion;
    Eigen::Index first;  ///< of its coefficients among the parameters
  };

  IdentifiedCurve(const ErrorSet& errors, const Eigen::MatrixXd& covariance)
      : errors_(errors), covariance_(covariance) {}

  void add(std::size_t motion, Eigen::Index first) {
    const Basis& basis = errors_.motions[motion].basis;
    from_ = terms_.empty() ? basis.from : std::max(from_, basis.from);
    to_ = terms_.empty() ? basis.to : std::min(to_, basis.to);
    terms_.push_back({motion, first});
  }

  const ErrorSet& errors_;
  const Eigen::MatrixXd& covariance_;
  std::vector<Term> terms_;
  double from_ = 0, to_ = 0;
};

Component component_at(int index) { return static_cast<Component>(index); }

std::string motion_words(const Machine& machine, std::size_t index, Component component, ReportLanguage language) {
  const Axis& axis = machine.axes[index];
  const bool rotary = axis.kind == AxisKind::rotary, angle = is_rotation(component);
  const auto along = static_cast<Eigen::Index>(component) % 3;
  const bool is_parallel = axis.direction.cwiseAbs().maxCoeff() > 1 - 1e-9;
  const std::string direction = letter(component_at(static_cast<int>(along)));
  // The standard's names are those of axes along X, Y or Z.
  if (!is_parallel) {
    return customer_text(Word::other_motion, language, error_motion_name(machine, index, component));
  }
  const bool own = std::abs(axis.direction[along]) > 0.5;
  if (!rotary && angle) return customer_text(Word::angular_motion, language, direction);
  if (!rotary) {
    return own ? std::string(customer_word(Word::positioning_motion, language))
               : customer_text(Word::straightness_motion, language, direction);
  }
  if (angle) {
    return own ? std::string(customer_word(Word::rotary_positioning_motion, language))
               : customer_text(Word::tilt_motion, language, direction);
  }
  return own ? std::string(customer_word(Word::axial_motion, language))
             : customer_text(Word::radial_motion, language, direction);
}

/// A figure of mm or rad in um or urad.
CustomerFigure micro_figure(std::string symbol, std::string name, bool angle, double value, double expanded,
                            double left) {
  const double scale = micro_per_unit(angle);
  CustomerFigure figure;
  figure.symbol = std::move(symbol);
  figure.name = std::move(name);
  figure.unit = shown_unit(angle);
  figure.decimals = decimals_for(scale * expanded);
  // What a convention of the gauge fixes has no uncertainty: it is not found from the readings.
  CustomerValue measured{scale * value, std::nullopt, false}, after{std::nullopt, std::nullopt, false};
  if (expanded > 0) measured.expanded_uncertainty = scale * expanded;
  if (left > 0) after.value = scale * left;
  figure.states = {measured, after};
  return figure;
}

/// um or urad.
double expanded_at(const IdentifiedCurve& curve, bool angle, double position) {
  return micro_per_unit(angle) * curve.expanded_uncertainty(curve.derivatives(position));
}

CustomerFigure curve_figure(const Machine& machine, std::size_t axis, Component component, const IdentifiedCurve& curve,
                            ReportLanguage language) {
  double low = 0, high = 0, left = 0;
  std::size_t low_at = 0, high_at = 0;
  for (std::size_t i = 0; i < kMotionPoints; ++i) {
    const double q = curve.position(i, kMotionPoints);
    const double value = curve.value(q);
    if (i == 0 || value < low) low = value, low_at = i;
    if (i == 0 || value > high) high = value, high_at = i;
    left = std::max(left, curve.expanded_uncertainty(curve.derivatives(q)));
  }
  const Eigen::VectorXd difference = curve.derivatives(curve.position(high_at, kMotionPoints)) -
                                     curve.derivatives(curve.position(low_at, kMotionPoints));
  return micro_figure(error_motion_name(machine, axis, component), motion_words(machine, axis, component, language),
                      is_rotation(component), high - low, curve.expanded_uncertainty(difference), left);
}

}  // namespace

std::vector<CustomerFigure> customer_error_figures(const CustomerErrors& of) {
  const auto& [machine, errors, covariance, language] = of;
  std::vector<CustomerFigure> figures;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (int c = 0; c < kComponentCount; ++c) {
      const auto curve = IdentifiedCurve::find(errors, covariance, axis, component_at(c));
      if (curve) figures.push_back(curve_figure(machine, axis, component_at(c), *curve, language));
    }
  }
  for (const LocationError& location : errors.locations) {
    if (location.state != kNoState) continue;
    const bool angle = is_rotation(location.component);
    const std::string direction = letter(component_at(static_cast<int>(location.component) % 3));
    const std::string name = customer_text(angle ? Word::orientation : Word::offset, language,
                                           {machine.axes[location.axis].name, direction});
    const double expanded = 2 * location.standard_uncertainty;
    figures.push_back(micro_figure(location_error_name(machine, location.axis, location.component), name, angle,
                                   location.value, expanded, expanded));
  }
  for (const Reversal& reversal : errors.reversals) {
    const Axis& axis = machine.axes[reversal.axis];
    const double expanded = 2 * reversal.standard_uncertainty;
    figures.push_back(micro_figure(reversal_name(machine, reversal.axis),
                                   customer_text(Word::reversal_value, language, axis.name),
                                   axis.kind == AxisKind::rotary, reversal.value, expanded, expanded));
  }
  return figures;
}

std::vector<CustomerTable> customer_error_tables(const CustomerErrors& of) {
  const auto& [machine, errors, covariance, language] = of;
  // A report on five axes has four sheets as well.
  const std::size_t positions = machine.axes.size() <= 3 ? 11 : 7;
  std::vector<CustomerTable> tables;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    std::vector<IdentifiedCurve> curves;
    std::vector<bool> angles;
    CustomerTable table;
    table.caption = customer_text(Word::axis_errors, language, machine.axes[axis].name);
    const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
    table.headers = {std::string(customer_word(Word::position, language)) + " / " + (rotary ? "°" : "mm")};
    for (int c = 0; c < kComponentCount; ++c) {
      auto curve = IdentifiedCurve::find(errors, covariance, axis, component_at(c));
      if (!curve) continue;
      table.headers.push_back(error_motion_name(machine, axis, component_at(c)) + " / " +
                              shown_unit(is_rotation(component_at(c))));
      angles.push_back(is_rotation(component_at(c)));
      curves.push_back(std::move(*curve));
    }
    if (curves.empty()) continue;
    double from = curves.front().from(), to = curves.front().to();
    for (const IdentifiedCurve& curve : curves) from = std::min(from, curve.from()), to = std::max(to, curve.to());
    // Of one column, all values have the decimals of its largest uncertainty.
    std::vector<double> q;
    std::vector<int> decimals(curves.size());
    for (std::size_t i = 0; i < positions; ++i) {
      q.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(positions - 1));
    }
    for (std::size_t c = 0; c < curves.size(); ++c) {
      double largest = 0;
      for (const double position : q) {
        if (curves[c].covers(position)) largest = std::max(largest, expanded_at(curves[c], angles[c], position));
      }
      decimals[c] = decimals_for(largest);
    }
    for (const double position : q) {
      const double shown = std::round(100 * position / position_unit(machine.axes[axis])) / 100;
      std::vector<std::string> row = {local_short_number(shown, language)};
      for (std::size_t c = 0; c < curves.size(); ++c) {
        const double value = micro_per_unit(angles[c]) * curves[c].value(position);
        row.push_back(!curves[c].covers(position)
                          ? "–"
                          : local_number(value, decimals[c], language) + " ± " +
                                local_number(expanded_at(curves[c], angles[c], position), decimals[c], language));
      }
      table.rows.push_back(std::move(row));
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<CustomerDrawing> customer_error_drawings(const CustomerErrors& of) {
  constexpr PlotColour kColours[] = {PlotColour::first, PlotColour::second, PlotColour::third};
  const auto& [machine, errors, covariance, language] = of;
  std::vector<CustomerDrawing> drawings;
  for (const AxisKind kind : {AxisKind::linear, AxisKind::rotary}) {
    const bool rotary = kind == AxisKind::rotary;
    const std::string caption(customer_word(rotary ? Word::drawing_rotary : Word::drawing_linear, language));
    XyPlot plot(caption, std::string(customer_word(Word::position, language)) + " / " + (rotary ? "°" : "mm"),
                std::string(customer_word(Word::deviation, language)) + " / " + shown_unit(rotary));
    if (rotary) plot.divide_x_in_degrees();
    std::size_t drawn = 0;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      if (machine.axes[axis].kind != kind) continue;
      Eigen::Index along = 0;
      machine.axes[axis].direction.cwiseAbs().maxCoeff(&along);
      const Component component = component_at(static_cast<int>(along) + (rotary ? 3 : 0));
      const auto curve = IdentifiedCurve::find(errors, covariance, axis, component);
      if (!curve) continue;
      const PlotColour colour = kColours[drawn++ % std::size(kColours)];
      std::vector<double> x, low, high;
      std::vector<PlotPoint> line;
      for (std::size_t i = 0; i < kMotionPoints; ++i) {
        const double q = curve->position(i, kMotionPoints), scale = micro_per_unit(rotary);
        const double value = scale * curve->value(q);
        const double expanded = scale * curve->expanded_uncertainty(curve->derivatives(q));
        x.push_back(q / position_unit(kind));
        low.push_back(value - expanded);
        high.push_back(value + expanded);
        line.push_back({x.back(), value});
      }
      plot.band(x, low, high, {colour, 0, false, 0.16});
      plot.line(std::move(line), {colour, 1.8}, error_motion_name(machine, axis, component));
    }
    if (drawn > 0) drawings.push_back({caption, plot.picture().wide});
  }
  return drawings;
}

}  // namespace abbe
