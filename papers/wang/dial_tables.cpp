#include "wang/dial_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "abbe/machine/axis_unit.h"
#include "abbe/verify/evaluations/statistics.h"
#include "wang/tables.h"

namespace abbe {
namespace {

constexpr std::uint64_t kDialSeed = 2020;

ReproducedTable one_dial_table(const WangDialFigures& figures) {
  ReproducedTable table{
      "one-dial",
      "One dial over grids on two faces, without noise: root mean square bias of the decoupled errors",
      {{"axis"},
       {"printed (5)", "um", 1},
       {"printed (8)", "um", 1},
       {"printed (11)", "urad", 1},
       {"correct for (5)", "um", 3},
       {"correct for (8)", "um", 3},
       {"correct roll", "urad", 3}},
      {},
      {}};
  for (const WangGridComparison& grid : figures.grids) {
    table.rows.push_back({grid.axis, 1e3 * grid.printed_second, 1e3 * grid.printed_first, 1e6 * grid.printed_roll,
                          1e3 * grid.correct_second, 1e3 * grid.correct_first, 1e6 * grid.correct_roll});
  }
  const WangGridComparison& x = figures.grids[0];
  table.notes = {
      "Dial zeros are 50 and -20 um, the faces are misaligned by 30 and -20 urad; angles are read as millidegrees. (5) "
      "and (8) keep the zero of the dial and the misalignment; (6) and (9) have opposite signs, so (11) is not a roll.",
      fmt::format(
          "(7) and (10) give {:.1f} and {:.1f} urad for X, which are slopes of the misalignment: one dial cannot see "
          "pitch and yaw (Table A1 has {:.1f} and {:.1f} urad, constant). With the angles in degrees as printed "
          "the dial would have to travel {:.1f} mm across 120 mm of face.",
          1e6 * x.printed_pitch, 1e6 * x.printed_yaw, 1e6 * x.true_pitch, 1e6 * x.true_yaw, x.dial_range_mm)};
  return table;
}

ReproducedTable decoupled_table(const WangDialFigures& figures) {
  ReproducedTable table{"decoupled",
                        "36 errors from simulated readings of dials and laser, angles read as millidegrees",
                        {{"axis"}, {"row"}},
                        {},
                        {}};
  add_columns(table, {"EX", "EY", "EZ"}, "um", 4);
  add_columns(table, {"EA", "EB", "EC"}, "urad", 4);
  const WangDialStudy& study = figures.study;
  for (const WangDialAxis& axis : study.axes) {
    std::vector<ReproducedCell> uncertainty = {kWangAxisNames[axis.table], "largest standard uncertainty"},
                                bias = {kWangAxisNames[axis.table], "largest bias without noise"};
    for (std::size_t c = 0; c < 6; ++c) {
      if (!axis.with_noise.seen[c]) {
        uncertainty.emplace_back();
        bias.emplace_back();
        continue;
      }
      const auto column = static_cast<Eigen::Index>(c);
      const double off = (axis.without_noise.errors.col(column) - axis.truth.col(column)).cwiseAbs().maxCoeff();
      const double micro = micro_per_unit(is_rotation(static_cast<Component>(c)));
      uncertainty.emplace_back(axis.largest_standard_uncertainty(c) * micro);
      bias.emplace_back(off * micro);
    }
    table.rows.push_back(std::move(uncertainty));
    table.rows.push_back(std::move(bias));
  }
  const WangDialMap& map = figures.map;
  table.notes = {
      fmt::format(
          "Seven dials on a carriage (u = 0.6 um) and a laser (u = 0.011 um) per linear axis, four dials on a "
          "mandrel and one probe on its end per rotary axis; datum in docs/dial-grids.md. The paper's "
          "instruments see {} of the 36 errors; EAA, EBB and ECC need an angle standard, which is added (U95 = 1 "
          "arcsec). {} of {} error values ({:.1f} %) lie within k = 2 of those without noise.",
          study.seen_by_dials, study.inside, study.values,
          100.0 * static_cast<double>(study.inside) / static_cast<double>(study.values)),
      fmt::format(
          "|E| of equation (18) over {} poses: mean {:.2f} um, largest {:.2f} um; its standard uncertainty is "
          "{:.2f} um on average and {:.2f} um at most; {:.1f} % of the components lie within k = 2 of those "
          "without noise. Zero pose: E = ({:.2f}, {:.2f}, {:.2f}) um, u = ({:.2f}, {:.2f}, {:.2f}) um, location "
          "errors left out.",
          map.poses, 1e3 * map.norm.mean, 1e3 * map.norm.maximum, 1e3 * map.uncertainty.mean,
          1e3 * map.uncertainty.maximum, 100 * map.inside, 1e3 * map.zero_pose.x(), 1e3 * map.zero_pose.y(),
          1e3 * map.zero_pose.z(), 1e3 * map.zero_pose_uncertainty.x(), 1e3 * map.zero_pose_uncertainty.y(),
          1e3 * map.zero_pose_uncertainty.z())};
  return table;
}

ReproducedTable ball_bar_table(const WangBallBarStudy& bar) {
  ReproducedTable table{"ball-bar",
                        "Ball bar of 100 mm in three planes, simulated (ISO 230-4, least-squares centre)",
                        {{"errors"}, {"quantity"}, {"XY", "", 2}, {"YZ", "", 2}, {"ZX", "", 2}, {"unit"}},
                        {},
                        {}};
  const auto add = [&](const std::string& errors, const char* quantity, const char* unit,
                       const std::vector<WangCircle>& at, const std::function<double(std::size_t plane)>& value) {
    std::vector<ReproducedCell> row = {errors, quantity};
    for (std::size_t i = 0; i < at.size(); ++i) {
      row.push_back(at[i].converged ? ReproducedCell(value(i)) : ReproducedCell());
    }
    row.emplace_back(unit);
    table.rows.push_back(std::move(row));
  };
  double largest_displacement = 0;
  constexpr const char* kCircular = "circular deviation G";
  for (const WangBallBarModel& model : bar.models) {
    add(model.name, kCircular, "um", model.circles, [&](std::size_t i) { return 1e3 * model.circles[i].circular; });
    if (model.reading.angles != WangAngleUnit::none) continue;
    for (const WangCircle& circle : model.circles)
      largest_displacement = std::max(largest_displacement, circle.circular);
  }
  constexpr const char* kFound = "36 decoupled errors";
  const std::vector<WangCircle>& found = bar.with_noise;
  const auto band = [&](std::size_t i) { return sample_statistics(found[i].uncertainty); };
  add(kFound, kCircular, "um", found, [&](std::size_t i) { return 1e3 * found[i].circular; });
  add(kFound, "U(G), k = 2", "um", found, [&](std::size_t i) { return 2e3 * found[i].circular_uncertainty; });
  add(kFound, "U of the deviation, k = 2, mean", "um", found, [&](std::size_t i) { return 2e3 * band(i).mean; });
  add(kFound, "U of the deviation, k = 2, largest", "um", found, [&](std::size_t i) { return 2e3 * band(i).maximum; });
  add(kFound, "within U of the trace without noise", "%", found,
      [&](std::size_t i) { return 100 * wang_share_within(found[i], bar.without_noise[i]); });
  table.notes = {fmt::format(
      "According to Figure 15 the ball bar agrees with the displacement errors alone at 0.1 mm. Displacements alone "
      "make at most {:.1f} um on these circles; 0.1 mm is {:.1f} times as much. The decoupled errors carry the "
      "expanded uncertainties of the readings, 0.022 and 1.2 um, and have no location errors.",
      1e3 * largest_displacement, 0.1 / largest_displacement)};
  return table;
}

/// The traces, for files only.
ReproducedTable trace_table(const WangBallBarStudy& bar) {
  ReproducedTable table{
      "ball-bar-traces",
      "Ball bar from the 36 decoupled errors: deviation of the length from 100 mm",
      {{"plane"}, {"angle", "deg", 0}, {"deviation", "um", 3}, {"U k2", "um", 3}, {"deviation without noise", "um", 3}},
      {},
      {},
      false};
  for (std::size_t i = 0; i < bar.with_noise.size(); ++i) {
    const WangCircle &circle = bar.with_noise[i], &exact = bar.without_noise[i];
    for (std::size_t k = 0; k < circle.deviation.size(); ++k) {
      const double angle = 360.0 * static_cast<double>(k) / static_cast<double>(circle.deviation.size());
      table.rows.push_back(
          {circle.plane, angle, 1e3 * circle.deviation[k], 2e3 * circle.uncertainty[k], 1e3 * exact.deviation[k]});
    }
  }
  return table;
}

}  // namespace

WangDialFigures wang_dial_figures() {
  WangDialFigures figures;
  figures.study = wang_dial_study(kDialSeed);
  figures.map = wang_dial_map(figures.study);
  figures.grids = wang_grid_comparison();
  figures.ball_bar = wang_ball_bar_study(figures.study.with_noise, figures.study.without_noise);
  return figures;
}

std::vector<ReproducedTable> wang_dial_tables(const WangDialFigures& figures) {
  return {ball_bar_table(figures.ball_bar), trace_table(figures.ball_bar), one_dial_table(figures),
          decoupled_table(figures)};
}

std::vector<EvaluationPlot> wang_ball_bar_plots(const WangBallBarStudy& bar) {
  std::vector<EvaluationPlot> plots;
  for (std::size_t i = 0; i < bar.with_noise.size(); ++i) {
    const WangCircle& circle = bar.with_noise[i];
    plots.push_back({"ball-bar-" + circle.plane, "", wang_circle_picture(circle, bar.without_noise[i])});
  }
  plots.front().caption = "What the readings of dials and laser predict for a ball bar of 100 mm.";
  return plots;
}

}  // namespace abbe
