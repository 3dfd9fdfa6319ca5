#include "abbe/report/evaluations/rotation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/drawings/svg_polar_plot.h"
#include "abbe/report/drawings/thinned.h"

namespace abbe {
namespace {

struct MotionName {
  const char* symbol;
  const char* name;
};

MotionName name_of(AxisErrorMotionKind kind) {
  switch (kind) {
    case AxisErrorMotionKind::radial_fixed_x1:
      return {"radial_x1", "radial along X, plane 1"};
    case AxisErrorMotionKind::radial_fixed_y1:
      return {"radial_y1", "radial along Y, plane 1"};
    case AxisErrorMotionKind::radial_rotating_1:
      return {"radial_rotating_1", "radial, rotating direction, plane 1"};
    case AxisErrorMotionKind::radial_fixed_x2:
      return {"radial_x2", "radial along X, plane 2"};
    case AxisErrorMotionKind::radial_fixed_y2:
      return {"radial_y2", "radial along Y, plane 2"};
    case AxisErrorMotionKind::radial_rotating_2:
      return {"radial_rotating_2", "radial, rotating direction, plane 2"};
    case AxisErrorMotionKind::tilt_fixed_x:
      return {"tilt_x", "tilt towards X"};
    case AxisErrorMotionKind::tilt_fixed_y:
      return {"tilt_y", "tilt towards Y"};
    case AxisErrorMotionKind::tilt_rotating:
      return {"tilt_rotating", "tilt, rotating direction"};
    case AxisErrorMotionKind::axial:
      return {"axial", "axial"};
    case AxisErrorMotionKind::face:
      return {"face", "face"};
  }
  return {"", ""};
}

std::string reason(const RotationResult& result) {
  switch (result.status) {
    case RotationStatus::not_run:
      return "not run";
    case RotationStatus::done:
      return "";
    case RotationStatus::too_few_turns:
      return fmt::format("fewer than {} whole turns", kLeastTurns);
    case RotationStatus::too_few_positions:
      return fmt::format("fewer than {} readings per turn", kLeastPositions);
    case RotationStatus::uneven_coverage:
      return fmt::format("a step of the angle is more than {:g} times the mean step", kLargestStepRatio);
  }
  return "";
}

void add_figures(AxisErrorMotionKind kind, const AxisErrorMotion* motion, bool stated, const std::string& missing,
                 EvaluationReport& report) {
  const MotionName name = name_of(kind);
  const auto add = [&](const char* suffix, const char* words, double value, double uncertainty) {
    EvaluationFigure figure;
    figure.symbol = std::string(name.symbol) + "_" + suffix;
    figure.name = std::string(name.name) + ": " + words;
    if (is_tilt(kind)) {
      figure.quantity = Quantity::angle;
      figure.unit = "urad";
    }
    if (motion == nullptr) {
      figure.missing = missing;
    } else {
      figure.value = value;
      if (stated && uncertainty > 0) figure.uncertainty = 2 * uncertainty;
    }
    report.figures.push_back(std::move(figure));
  };
  const AxisErrorMotion none, &m = motion == nullptr ? none : *motion;
  add("total", "total error motion", m.total_value, m.total_uncertainty);
  add("synchronous", "synchronous error motion", m.synchronous_value, m.synchronous_uncertainty);
  add("asynchronous", "asynchronous error motion", m.asynchronous_value, m.asynchronous_uncertainty);
  if (fundamental_is_removed(kind)) return;
  add("fundamental", "fundamental error motion", m.fundamental_value, m.synchronous_uncertainty);
  add("residual", "residual synchronous error motion", m.residual_value, m.synchronous_uncertainty);
}

EvaluationPlot plot_of(const RotationResult& result, const AxisErrorMotion& motion, const std::string& file) {
  const double unit = micro_per_unit(is_tilt(motion.kind));
  const MotionName name = name_of(motion.kind);
  PolarPlot plot(fmt::format("Error motion, {} ({})", name.name, file),
                 is_tilt(motion.kind) ? "error motion in \xC2\xB5rad" : "error motion in \xC2\xB5m");
  std::vector<PolarPoint> total, synchronous;
  for (const std::size_t i : thinned(motion.total)) {
    total.push_back({result.angle[i % result.positions], unit * motion.total[i]});
  }
  for (std::size_t k = 0; k < result.positions; ++k) {
    synchronous.push_back({result.angle[k], unit * motion.synchronous[k]});
  }
  plot.line(total, false, {PlotColour::soft, 0.7, false, 0.6}, fmt::format("total, {} turns", result.turns));
  plot.line(synchronous, true, {PlotColour::first, 2}, "synchronous");
  const auto [low, high] = std::minmax_element(motion.total.begin(), motion.total.end());
  plot.circle(unit * *high, fmt::format("{:.2f}", unit * *high), {PlotColour::soft, 1, true, 1});
  plot.circle(unit * *low, fmt::format("{:.2f}", unit * *low), {PlotColour::soft, 1, true, 1});
  const char* const taken_out = fundamental_is_removed(motion.kind) ? "mean and once-per-turn part" : "mean";
  return {name.symbol, fmt::format("{} taken out. Dashed: circles that hold the total error motion.", taken_out),
          plot.picture()};
}

void add_notes(const RotationResult& result, const RotationOptions& options, EvaluationReport& report) {
  if (options.reading_uncertainty == 0) {
    report.notes.push_back(
        "No uncertainty of the displacement probes was stated (--u-reading-um): no measurement "
        "uncertainty is given.");
  }
  if (result.status != RotationStatus::done) return;
  if (result.interpolated) {
    report.notes.push_back(
        "The readings do not stand at the same angles in every turn; they were interpolated linearly in between.");
  }
  for (const AxisErrorMotion& motion : result.motions) {
    if (std::abs(motion.drift) > 0.3 * motion.asynchronous_value && motion.asynchronous_value > 0) {
      report.notes.push_back(
          fmt::format("{}: the mean of a turn drifts by {:.2f} {} from the first to the last turn; that is part of the "
                      "asynchronous and "
                      "total values.",
                      name_of(motion.kind).name, motion.drift * micro_per_unit(is_tilt(motion.kind)),
                      unit_symbol(micro_unit(is_tilt(motion.kind)))));
    }
    if (motion.kind == AxisErrorMotionKind::face) {
      report.notes.push_back(
          "The fundamental face error motion contains the angle between the measured face and the axis.");
    }
  }
  report.notes.push_back("Roundness of the artefact is part of the synchronous values; it is not separated here.");
}

}  // namespace

const char* error_motion_symbol(AxisErrorMotionKind kind) { return name_of(kind).symbol; }

EvaluationReport rotation_report(const std::string& file, const RotationOptions& options,
                                 const RotationReadings& readings, const RotationResult& result) {
  EvaluationReport report;
  report.kind = "rotation";
  report.title = "Error motions of an axis of rotation: " + file;
  report.standard = "ISO 230-7";
  report.facts = {{"readings", fmt::format("{}", readings.angle.size())}};
  report.details = nlohmann::ordered_json::object();
  if (result.status == RotationStatus::done) {
    report.facts.emplace_back("whole turns", fmt::format("{}", result.turns));
    report.facts.emplace_back("positions per turn", fmt::format("{}", result.positions));
    report.details["turns"] = result.turns;
    report.details["positions"] = result.positions;
  }
  if (options.plane_distance > 0) {
    report.facts.emplace_back("distance of the planes", fmt::format("{:.6g} mm", options.plane_distance));
  }
  std::size_t next = 0;
  for (const AxisErrorMotionKind kind : evaluated_kinds(readings, options)) {
    const AxisErrorMotion* motion = result.status == RotationStatus::done ? &result.motions[next++] : nullptr;
    add_figures(kind, motion, options.reading_uncertainty > 0, reason(result), report);
    if (motion == nullptr) continue;
    report.plots.push_back(plot_of(result, *motion, file));
    const double degrees = result.angle[motion->asynchronous_at] * 180 / std::numbers::pi;
    report.details["largest_asynchronous_at_deg"][name_of(kind).symbol] = degrees;
  }
  add_notes(result, options, report);
  return report;
}

}  // namespace abbe
