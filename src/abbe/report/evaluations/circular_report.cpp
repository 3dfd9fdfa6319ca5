#include "abbe/report/evaluations/circular_report.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/svg_polar_plot.h"
#include "abbe/report/drawings/thinned.h"
#include "abbe/report/evaluations/expansion_report.h"

namespace abbe {
namespace {

/// Degrees of a radian.
constexpr double kPerDegree = 1 / kDegree;
constexpr const char* kPathNames[2] = {"clockwise", "counter-clockwise"};
constexpr const char* kPathSymbols[2] = {"cw", "ccw"};

std::string reason(CircleStatus status) {
  switch (status) {
    case CircleStatus::not_run:
      return "not driven";
    case CircleStatus::done:
      return "";
    case CircleStatus::too_few_readings:
      return "fewer than three readings";
    case CircleStatus::arc_too_short:
      return "the arc is shorter than 200\xC2\xB0 and has no centre of its own; --centre instrument takes the "
             "instrument's";
    case CircleStatus::not_converged:
      return "the readings are not a circle around the instrument";
  }
  return "";
}

EvaluationFigure named_figure(std::string symbol, std::string name) {
  EvaluationFigure result;
  result.symbol = std::move(symbol);
  result.name = std::move(name);
  return result;
}

void add_value(EvaluationFigure entry, const CircularDeviation& path, double value, double uncertainty,
               bool uncertainty_is_stated, EvaluationReport& report) {
  if (path.status == CircleStatus::done) {
    entry.value = value;
    if (uncertainty_is_stated) entry.uncertainty = 2 * uncertainty;
  } else {
    entry.missing = reason(path.status);
  }
  report.figures.push_back(std::move(entry));
}

void add_deviations(const CircularRequest& request, const CircularResult& result, EvaluationReport& report) {
  const bool stated = request.circular.reading_uncertainty > 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const CircularDeviation& path = result.paths[k];
    if (path.status == CircleStatus::not_run) continue;
    const std::string symbol = kPathSymbols[k], name = kPathNames[k];
    add_value(named_figure("G_" + symbol, "circular deviation, " + name), path, path.circular,
              path.circular_uncertainty, stated, report);
    add_value(named_figure("Fmax_" + symbol, "largest radial deviation, " + name), path, path.radial_largest,
              path.radial_largest_uncertainty, stated, report);
    add_value(named_figure("Fmin_" + symbol, "smallest radial deviation, " + name), path, path.radial_smallest,
              path.radial_smallest_uncertainty, stated, report);
  }
  if (result.both.status == CircleStatus::not_run) return;
  add_value(named_figure("G_b", "bidirectional circular deviation G(b)"), result.both, result.both.circular,
            result.both.circular_uncertainty, stated, report);
  EvaluationFigure mean = named_figure("D", "mean bidirectional radial deviation");
  if (result.has_mean) {
    mean.value = result.mean;
    if (stated) mean.uncertainty = 2 * result.mean_uncertainty;
  } else {
    mean.missing = "a path has no least-squares circle";
  }
  report.figures.push_back(std::move(mean));
}

struct CauseName {
  std::string symbol, name;
  Quantity quantity = Quantity::length;
  const char* unit = "um";
  std::vector<std::string> about{};
};

CauseName name_of(CircularCause cause, const std::string& plane) {
  const std::string first(1, plane[0]), second(1, plane[1]);
  switch (cause) {
    case CircularCause::centre_first:
      return {"centre_" + first, "centre of the path along " + first + " (set-up)", Quantity::length, "um", {first}};
    case CircularCause::centre_second:
      return {"centre_" + second, "centre of the path along " + second + " (set-up)", Quantity::length, "um", {second}};
    case CircularCause::radius:
      return {"radius", "mean radius less nominal radius"};
    case CircularCause::scale_mismatch:
      return {"scale_mismatch",
              "scale error of " + first + " less that of " + second,
              Quantity::length_per_length,
              "um_per_m",
              {first, second}};
    case CircularCause::scale_first:
      return {"scale_" + first, "scale error of " + first, Quantity::length_per_length, "um_per_m", {first}};
    case CircularCause::scale_second:
      return {"scale_" + second, "scale error of " + second, Quantity::length_per_length, "um_per_m", {second}};
    case CircularCause::squareness:
      return {"squareness",
              "angle between +" + first + " and +" + second + " less 90\xC2\xB0",
              Quantity::angle,
              "urad",
              {first, second}};
    case CircularCause::reversal_first:
      return {"reversal_" + first, "reversal value B of " + first, Quantity::length, "um", {first}};
    case CircularCause::reversal_second:
      return {"reversal_" + second, "reversal value B of " + second, Quantity::length, "um", {second}};
    case CircularCause::servo_mismatch:
      return {"servo_mismatch",
              "following error of " + first + " less that of " + second,
              Quantity::length,
              "um",
              {first, second}};
  }
  return {};
}

void add_causes(const CircularRequest& request, const CircularDiagnosis& diagnosis, EvaluationReport& report) {
  EvaluationTable table{"Causes of the radial deviations, fitted to all readings",
                        {"cause", "peak to peak on the path in \xC2\xB5m", "distinct from the others"},
                        {}};
  nlohmann::ordered_json json;
  bool any_missing = false;
  for (std::size_t k = 0; k < kCircularCauses; ++k) {
    const auto cause = static_cast<CircularCause>(k);
    const CircularCauseValue& value = diagnosis.causes[k];
    const CauseName name = name_of(cause, request.plane);
    EvaluationFigure entry = named_figure(name.symbol, name.name);
    entry.quantity = name.quantity;
    entry.unit = name.unit;
    entry.about = name.about;
    const bool is_scale = cause == CircularCause::scale_first || cause == CircularCause::scale_second;
    if (value.separable) {
      entry.value = value.value;
      entry.uncertainty = 2 * value.uncertainty;
      table.rows.push_back(
          {name.name, fmt::format("{:.2f}", 1e3 * value.effect), fmt::format("{:.0f} %", 100 * value.distinctness)});
      json[name.symbol] = {{"effect_um", 1e3 * value.effect}, {"distinctness", value.distinctness}};
    } else if (diagnosis.status == DiagnosisStatus::too_few_readings) {
      entry.missing = "too few readings";
    } else {
      entry.missing = is_scale && !request.diagnosis.length_calibrated
                          ? "the length is not calibrated"
                          : "these readings do not separate it from the other causes";
      any_missing = any_missing || !is_scale || request.diagnosis.length_calibrated;
    }
    report.figures.push_back(std::move(entry));
    if (cause == CircularCause::servo_mismatch && value.separable && request.feed_mm_s > 0) {
      EvaluationFigure time = named_figure("lag_mismatch", "the same as a time constant");
      time.quantity = Quantity::time;
      time.unit = "ms";
      time.value = value.value / request.feed_mm_s;
      time.uncertainty = 2 * value.uncertainty / request.feed_mm_s;
      report.figures.push_back(std::move(time));
    }
  }
  if (!table.rows.empty()) {
    table.rows.push_back({"left unexplained", fmt::format("{:.2f}", 1e3 * diagnosis.residual_peak_to_peak), ""});
    report.tables.push_back(std::move(table));
  }
  report.details["diagnosis"] = {{"causes", json},
                                 {"residual_rms_um", 1e3 * diagnosis.residual_rms},
                                 {"residual_peak_to_peak_um", 1e3 * diagnosis.residual_peak_to_peak},
                                 {"correlation_length", diagnosis.correlation_length}};
  if (any_missing) {
    report.notes.push_back(
        "Some causes make the same pattern in these readings and cannot be separated: squareness and servo mismatch "
        "need both directions of a full circle, scales and centre need a full circle.");
  }
  if (request.diagnosis.reversal_margin > 0) {
    report.notes.push_back(
        fmt::format("Readings within {:g}\xC2\xB0 of a reversal of an axis are not used for the causes.",
                    request.diagnosis.reversal_margin * kPerDegree));
  }
  if (diagnosis.correlation_length > 5) {
    report.notes.push_back(fmt::format(
        "The residuals of the causes follow a pattern of their own: {:.0f} readings count as one in the uncertainties.",
        diagnosis.correlation_length));
  }
}

void add_notes(const CircularRequest& request, const CircularResult& result, EvaluationReport& report) {
  for (std::size_t k = 0; k < 2; ++k) {
    const CircularDeviation& path = result.paths[k];
    if (path.status == CircleStatus::done && path.partial && request.circular.centre != CircularCentre::instrument) {
      report.notes.push_back(
          fmt::format("The {} path is not a full circle, for which alone ISO 230-4 fits the centre.", kPathNames[k]));
    }
  }
  if (request.circular.reading_uncertainty == 0) {
    report.notes.push_back(
        "No uncertainty of the instrument was stated (--u-reading-um): G, F and D have no measurement uncertainty.");
  }
  report.notes.push_back(
      "Uncertainties of the causes are those of the fit (from its residuals); reversal values are as in ISO 230-2: "
      "approach in positive less approach in negative direction.");
}

EvaluationPlot deviation_plot(const CircularRequest& request, const CircularResult& result) {
  PolarPlot plot("Radial deviation of " + std::filesystem::path(request.file).filename().string(),
                 "deviation from the nominal radius in \xC2\xB5m");
  plot.name_axes(std::string("+") + request.plane[0], std::string("+") + request.plane[1]);
  const PlotColour colours[2] = {PlotColour::first, PlotColour::second};
  for (std::size_t k = 0; k < 2; ++k) {
    const CircularDeviation& path = result.paths[k];
    if (path.status != CircleStatus::done) continue;
    std::vector<PolarPoint> points;
    for (const std::size_t i : thinned(path.deviations)) points.push_back({path.angle[i], 1e3 * path.deviations[i]});
    plot.line(points, !path.partial, {colours[k]}, kPathNames[k]);
  }
  const CircularDeviation& shown = result.both.status == CircleStatus::done       ? result.both
                                   : result.paths[0].status == CircleStatus::done ? result.paths[0]
                                                                                  : result.paths[1];
  const PlotStyle zone{PlotColour::soft, 1, true, 1};
  plot.circle(1e3 * shown.radial_largest, fmt::format("{:.2f}", 1e3 * shown.radial_largest), zone);
  plot.circle(1e3 * shown.radial_smallest, fmt::format("{:.2f}", 1e3 * shown.radial_smallest), zone);
  return {"plot",
          "Dashed: the concentric circles that hold " +
              std::string(result.both.status == CircleStatus::done ? "both paths." : "the path."),
          plot.picture()};
}

EvaluationPlot diagnosis_plot(const CircularRequest& request, const std::array<CircularReadings, 2>& paths,
                              const CircularDiagnosis& diagnosis) {
  XyPlot plot("What the causes explain", std::string("angle from +") + request.plane[0] + " in degrees",
              "radial deviation in \xC2\xB5m");
  plot.divide_x_in_degrees();
  const PlotColour colours[2] = {PlotColour::first, PlotColour::second};
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<PlotPoint> measured, modelled;
    double turns = 0;
    for (const std::size_t i : thinned(diagnosis.modelled[k])) {
      const double angle = paths[k].angle[i] * kPerDegree, in_turn = angle - 360 * std::floor(angle / 360);
      if (!modelled.empty() && std::abs(in_turn - modelled.back().x) > 180) {
        measured.push_back({std::nan(""), 0});
        modelled.push_back({std::nan(""), 0});
        ++turns;
      }
      const double model = 1e3 * diagnosis.modelled[k][i];
      measured.push_back({in_turn, model + 1e3 * diagnosis.residuals[k][i]});
      modelled.push_back({in_turn, model});
    }
    if (modelled.empty()) continue;
    plot.line(measured, {colours[k], 1, false, 0.6}, std::string(kPathNames[k]) + ", centre taken out");
    plot.line(modelled, {colours[k], 2, true, 1}, std::string(kPathNames[k]) + ", fitted causes");
  }
  return {"causes", "Measured deviations without the part of the centre, and the sum of the fitted causes.",
          plot.picture()};
}

/// Called while the figures are those of the deviations.
void add_circular_correction(const CircularRequest& request, const CircularCorrection& correction,
                             EvaluationReport& report) {
  add_expansion(correction.expansion, {correction.has_machine, correction.has_instrument}, correction.at, correction.at,
                report);
  report.notes.emplace_back(
      "The radii are corrected to 20 \xC2\xB0\x43 for the nominal differential expansion of machine and instrument "
      "(ISO "
      "230-4).");
  note_exact_expansion(correction.expansion, report);
  EvaluationReport as_read;
  add_deviations(request, correction.as_read, as_read);
  EvaluationTable table{"Figures as read and corrected to 20 \xC2\xB0\x43, in \xC2\xB5m",
                        {"figure", "as read", "at 20 \xC2\xB0\x43"},
                        {}};
  nlohmann::ordered_json json;
  for (std::size_t f = 0; f < as_read.figures.size(); ++f) {
    const EvaluationFigure &before = as_read.figures[f], &after = report.figures[f];
    if (!before.value || !after.value) continue;
    table.rows.push_back({before.symbol, figure_text(before, *before.value), figure_text(after, *after.value)});
    json[before.symbol + "_um"] = figure_number(before, *before.value);
  }
  report.tables.push_back(std::move(table));
  report.details["expansion"]["correction_of_nominal_radius_um"] =
      std::round(request.circular.nominal_radius * (correction.factor - 1) * 1e12) / 1e9;
  report.details["expansion"]["standard_uncertainty_um"] = std::round(correction.uncertainty * 1e12) / 1e9;
  report.details["as_read"] = std::move(json);
}

}  // namespace

EvaluationReport circular_report(const CircularRequest& request, const std::array<CircularReadings, 2>& paths,
                                 const CircularResult& result, const CircularDiagnosis& diagnosis,
                                 const CircularCorrection* correction) {
  EvaluationReport report;
  report.kind = "circular";
  report.title = "Circular test of " + std::filesystem::path(request.file).filename().string();
  report.standard = "ISO 230-4";
  const char* const centres[3] = {"least squares", "minimum zone", "instrument"};
  report.facts = {{"plane", request.plane},
                  {"nominal radius", fmt::format("{:.6g} mm", request.circular.nominal_radius)},
                  {"centre", centres[static_cast<std::size_t>(request.circular.centre)]}};
  report.details = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < 2; ++k) {
    const CircularDeviation& path = result.paths[k];
    if (paths[k].count() == 0) continue;
    report.facts.emplace_back(kPathNames[k], fmt::format("{} readings", paths[k].count()));
    if (path.status != CircleStatus::done) continue;
    report.details["paths"][kPathSymbols[k]] = {{"centre_mm", {path.centre.x(), path.centre.y()}},
                                                {"mean_radius_mm", path.mean_radius},
                                                {"full_circle", !path.partial}};
  }
  add_deviations(request, result, report);
  if (correction != nullptr) add_circular_correction(request, *correction, report);
  add_causes(request, diagnosis, report);
  add_notes(request, result, report);
  const bool any_path = result.paths[0].status == CircleStatus::done || result.paths[1].status == CircleStatus::done;
  if (any_path) report.plots.push_back(deviation_plot(request, result));
  if (diagnosis.status != DiagnosisStatus::too_few_readings) {
    report.plots.push_back(diagnosis_plot(request, paths, diagnosis));
  }
  return report;
}

}  // namespace abbe
