#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "yin/constants.h"
#include "yin/results.h"

namespace abbe {
namespace {

ReproducedTable equation_table(const std::vector<YinEquation>& equations) {
  ReproducedTable table{"equations",
                        "Equations (1) to (8), each put to a test that does not use it; by how much it fails",
                        {{"equation"},
                         {"as printed"},
                         {"printed fails by", "", 3},
                         {"right fails by", "", 3},
                         {"unit"},
                         {"printed, and its test"}},
                        {},
                        {"With the linkage of Table 2 and the beams of Table A4."}};
  for (const YinEquation& e : equations) {
    table.rows.push_back({e.number, e.is_right ? "right" : "WRONG", e.printed_off, e.right_off, e.unit,
                          fmt::format("{}. Test: {}", e.printed, e.test)});
  }
  return table;
}

/// Steps that failed have no values, and a fit that did not converge has no uncertainty.
ReproducedTable linkage_table(const YinResults& r) {
  ReproducedTable table{"table-2",
                        "Table 2: linkage parameters by the five steps, from exact readings of a machine with them",
                        {{"parameter"},
                         {"paper", "mm", 3},
                         {"corrected", "mm", 3},
                         {"as printed, U", "mm", 3},
                         {"as printed, P", "mm", 3},
                         {"u by five steps", "um", 1},
                         {"u by joint fit", "um", 1}},
                        {},
                        {}};
  const LinkageEvaluation &table_moves = r.table_moves.found, &head_moves = r.head_moves.found;
  const auto if_found = [](bool found, double value) { return found ? ReproducedCell(value) : ReproducedCell(); };
  const bool in_u = table_moves.status == LinkageStatus::ok, in_p = head_moves.status == LinkageStatus::ok;
  const auto paper = yin_linkage().values(), corrected = table_moves.linkage.values(),
             printed_u = table_moves.printed.values(), printed_p = head_moves.printed.values();
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    table.rows.push_back({linkage_name(i), paper[i], if_found(in_u, corrected[i]), if_found(in_u, printed_u[i]),
                          if_found(in_p, printed_p[i]), if_found(in_u, 1e3 * table_moves.standard_uncertainty(i)),
                          if_found(r.joint.converged, 1e3 * r.joint.standard_uncertainty(i))});
  }
  table.notes = {
      "U: X and Y carry the table, as in the text, (12) and Tables 2 and 3; P: (5) as printed. u: standard uncertainty "
      "with Table 1 as one standard deviation, microscope 2 um, zeros of A and C1 as good as their axes."};
  if (r.joint.converged) {
    table.notes.push_back(fmt::format(
        "Joint fit: {} marks at many poses of another machine (examples/laser_engraver/marks.study.toml), chi-square "
        "{:.0f} with {} degrees of freedom. The position of the focus in the table's frame is uncertain by {:.1f} um "
        "(root mean square over poses) after the five steps and by {:.1f} um after the joint fit, from the linkage "
        "alone.",
        r.joint.readings, r.joint.chi_square, r.joint.degrees_of_freedom, 1e3 * r.joint.focus_by_steps,
        1e3 * r.joint.focus));
  }
  return table;
}

ReproducedTable positioning_table(const YinResults& r) {
  ReproducedTable table{"table-3",
                        "Table 3: positioning parameters in both readings of the table, with standard uncertainties",
                        {{"reading"},
                         {"row"},
                         {"x", "mm", 4},
                         {"y", "mm", 4},
                         {"z", "mm", 4},
                         {"alpha", "deg", 4},
                         {"beta", "deg", 4},
                         {"gamma", "deg", 4}},
                        {},
                        {}};
  const auto add = [&](const char* words, const YinPositioning& positioning, bool to_workpiece) {
    std::vector<ReproducedCell> values = {words, "value"}, uncertainties = {words, "u"};
    const PositioningParameters& p = to_workpiece ? positioning.table_to_workpiece : positioning.workpiece_to_table;
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (!positioning.failure.empty()) {
        values.emplace_back();
        uncertainties.emplace_back();
        continue;
      }
      values.emplace_back(i < 3 ? p.translation[i] : p.angles[i - 3] / kDegree);
      uncertainties.emplace_back(std::sqrt(p.covariance(i, i)) / (i < 3 ? 1 : kDegree));
    }
    table.rows.push_back(std::move(values));
    table.rows.push_back(std::move(uncertainties));
  };
  add("p_workpiece = D p_table, the paper's words", r.positioning, true);
  add("p_table = D p_workpiece, the other reading", r.positioning, false);
  add("first reading, simulated scanner with occlusion", r.located.positioning, true);
  table.notes = {
      "Targets are known to 10 um, points on sphere and workpiece to 20 um (assumed).",
      fmt::format("The simulated scanner sees {} of {} target positions and {} of {} places on the surfaces.",
                  r.scans.targets_seen, r.scans.targets_placed, r.scans.surface_seen, r.scans.surface_placed)};
  if (r.located.positioning.failure.empty()) {
    table.notes.back() +=
        fmt::format(" Its result is {:.1f} um off the truth, chi-square {:.1f} with 6 degrees of freedom.",
                    1e3 * r.located.positioning.largest_difference, r.located.chi_square);
  }
  return table;
}

ReproducedTable contour_table(const YinResults& r) {
  const YinContour& c = r.contour;
  ReproducedTable table{"contour-error",
                        "Amount of the contour error at the 30 points of Table A4",
                        {{"what"}, {"mean", "um", 1}, {"largest", "um", 1}, {"standard deviation", "um", 1}},
                        {},
                        {}};
  const auto add = [&](const char* words, const YinFigures& f) {
    table.rows.push_back({words, f.mean, f.largest, f.deviation});
  };
  add("paper, measured", kYinMeasured);
  add("predicted, across the curve in the surface", c.across);
  add("predicted, 95 % of machines stay below", c.upper);
  add("predicted, whole distance in the surface", c.in_surface);
  add("one simulated part, its edges", r.sections.truth);
  add("one simulated part, its sections: commanded curve to P2", r.sections.found);
  add("one simulated part, its sections: P1 P2", r.sections.rounding);
  table.notes = {
      fmt::format("Predicted from {} simulated machines with {} inputs each.", c.budget.runs, c.budget.inputs),
      fmt::format("Sections: 1280 points each, 2 um in height and 1 um across, edges rounded by {:.0f} um "
                  "(assumed); the edges are found within {:.1f} um.",
                  1e3 * r.sections.radius, 1e3 * r.sections.largest_miss)};
  if (r.sections.refused > 0) {
    table.notes.push_back(fmt::format("{} of {} sections have no edge and are left out of the last two rows.",
                                      r.sections.refused, r.sections.fits.size()));
  }
  return table;
}

ReproducedTable budget_table(const UncertaintyBudget& budget) {
  ReproducedTable table{"budget",
                        "Uncertainty budget: standard uncertainty, root mean square over the points",
                        {{"cause"},
                         {"inputs", "", 0},
                         {"across", "um"},
                         {"across, drawn", "um"},
                         {"u across", "um"},
                         {"along", "um"},
                         {"along, drawn", "um"},
                         {"u along", "um"},
                         {"share", "%", 1}},
                        {},
                        {}};
  const auto add = [&](const std::string& cause, std::size_t inputs, const std::vector<BudgetFigure>& kinds,
                       double share) {
    std::vector<ReproducedCell> row = {cause, inputs};
    for (const BudgetFigure& f : kinds) {
      row.emplace_back(1e3 * f.by_sensitivity);
      row.emplace_back(1e3 * f.by_monte_carlo);
      row.emplace_back(1e3 * f.monte_carlo_uncertainty);
    }
    row.emplace_back(100 * share);
    table.rows.push_back(std::move(row));
  };
  for (const BudgetLine& line : budget.lines) add(line.cause, line.inputs, line.kinds, line.share);
  add("all", budget.inputs, budget.total, 1);
  table.notes = {
      "Across and along the curve: by sensitivity coefficients, then drawn by Monte Carlo with the standard "
      "uncertainty u of the drawn figure. A section does not see what lies along the curve."};
  return table;
}

ReproducedTable section_table(const YinSections& s) {
  ReproducedTable table{"sections",
                        "Sections of one simulated part",
                        {{"number", "", 0},
                         {"along the curve", "mm", 3},
                         {"true contour error", "um"},
                         {"contour error", "um"},
                         {"u contour error", "um"},
                         {"P1 P2", "um"},
                         {"u P1 P2", "um"},
                         {"scanned points", "", 0},
                         {"not evaluated"}},
                        {},
                        {},
                        false};
  for (std::size_t i = 0; i < s.fits.size(); ++i) {
    const EdgeFit& fit = s.fits[i];
    std::vector<ReproducedCell> row = {i + 1, *s.sections[i].along, 1e3 * s.edge[i]};
    const bool found = fit.status == EdgeStatus::ok;
    for (const double mm : {fit.corner.x(), fit.corner_uncertainty(), fit.rounding, fit.rounding_uncertainty}) {
      row.emplace_back(found ? std::optional(1e3 * mm) : std::nullopt);
    }
    row.emplace_back(static_cast<std::size_t>(s.sections[i].points.cols()));
    row.emplace_back(found ? std::string() : fit.reason);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<ReproducedTable> yin_tables(const YinResults& r) {
  std::vector<ReproducedTable> tables = {equation_table(r.equations), linkage_table(r), positioning_table(r)};
  if (!r.positioning.failure.empty()) return tables;  // without a place of the workpiece there is no contour
  for (ReproducedTable& table : yin_command_tables(r.commands)) tables.push_back(std::move(table));
  tables.push_back(contour_table(r));
  tables.push_back(budget_table(r.contour.budget));
  tables.push_back(section_table(r.sections));
  return tables;
}

std::vector<PublishedNumber> yin_published(const YinResults& r) {
  std::vector<PublishedNumber> rows;
  // Every note says what the number here is: those of Tables 2 and 3 go in and come out again.
  const LinkageEvaluation& steps = r.table_moves.found;
  const bool stepped = steps.status == LinkageStatus::ok;
  const auto paper = yin_linkage().values(), found = steps.linkage.values();
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    rows.push_back(
        {fmt::format("Table 2, {}", linkage_name(i)), "mm", paper[i],
         stepped ? std::optional<double>(found[i]) : std::nullopt,
         stepped ? "set in the simulation, found again by the corrected steps from exact readings" : steps.reason, 3});
  }
  const bool located = r.positioning.failure.empty();
  constexpr const char* kNames[] = {"x", "y", "z", "alpha", "beta", "gamma"};
  for (std::size_t i = 0; i < 6; ++i) {
    PublishedNumber row{fmt::format("Table 3, {}", kNames[i]),
                        i < 3 ? "mm" : "deg",
                        yin::kTable3[i],
                        {},
                        located ? "set in the simulation, found again from exact scans; first reading of the table"
                                : r.positioning.failure,
                        3};
    const PositioningParameters& p = r.positioning.table_to_workpiece;
    const auto k = static_cast<Eigen::Index>(i % 3);
    if (located) row.here = i < 3 ? p.translation[k] : p.angles[k] / kDegree;
    rows.push_back(std::move(row));
  }
  const auto add = [&](const char* words, double measured, double predicted) {
    rows.push_back({fmt::format("contour error, {}", words), "um", measured,
                    located ? std::optional<double>(predicted) : std::nullopt,
                    located ? "paper: one engraved part; here: predicted across the curve" : r.positioning.failure, 1});
  };
  add("mean", kYinMeasured.mean, r.contour.across.mean);
  add("largest", kYinMeasured.largest, r.contour.across.largest);
  add("standard deviation", kYinMeasured.deviation, r.contour.across.deviation);
  return rows;
}

}  // namespace abbe
