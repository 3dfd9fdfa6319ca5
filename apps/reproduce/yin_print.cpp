#include <fmt/format.h>

#include <cmath>
#include <string>

#include "abbe/geometry/angle_units.h"
#include "reproduce/yin_results.h"

namespace abbe {
namespace {

/// A fit that did not converge has no uncertainty.
std::string joint_uncertainty_text(const YinJointFit& joint, std::size_t parameter) {
  return joint.converged ? fmt::format("{:.1f}", 1e3 * joint.standard_uncertainty(parameter)) : "-";
}

void print_linkage(const YinResults& r) {
  fmt::print("Linkage parameters by the five steps, exact readings of the machine of Table 2 / mm\n");
  fmt::print("  {:<8}{:>12}{:>14}{:>16}{:>16}{:>12}{:>16}\n", "", "Table 2", "corrected", "printed, U", "printed, P",
             "u / um", "joint fit, u");
  const auto table = yin_linkage().values();
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    fmt::print("  {:<8}{:>12.3f}{:>14.3f}{:>16.3f}{:>16.3f}{:>12.1f}{:>16}\n", linkage_name(i), table[i],
               r.table_moves.found.linkage.values()[i], r.table_moves.found.printed.values()[i],
               r.head_moves.found.printed.values()[i], 1e3 * r.table_moves.found.standard_uncertainty(i),
               joint_uncertainty_text(r.joint, i));
  }
  fmt::print(
      "  Wrong in print: (9) sign of h; step 3 takes 2 L_tA for L_tA; (10), (11) lose signs; (12) holds in convention "
      "U.\n"
      "  u: Table 1 as one standard deviation, microscope 2 um, zeros of A and C1 as good as their axes. U: X and Y "
      "carry the\n"
      "  table; P: (5) as printed.\n");
  if (!r.joint.converged) {
    fmt::print("  joint fit of marks: {}\n\n", r.joint.message);
    return;
  }
  fmt::print(
      "  Joint fit: {} marks at many poses of another machine (examples/laser_engraver/marks.study.toml), chi-square "
      "{:.0f} of {}.\n"
      "  Focus in the table's frame by the linkage alone, rms over poses: {:.1f} um by the five steps, {:.1f} um by "
      "the "
      "joint fit.\n\n",
      r.joint.readings, r.joint.chi_square, r.joint.degrees_of_freedom, 1e3 * r.joint.focus_by_steps,
      1e3 * r.joint.focus);
}

void print_positioning(const YinResults& r) {
  const auto row = [](const char* words, const YinPositioning& positioning, bool to_workpiece) {
    if (!positioning.failure.empty()) {
      fmt::print("  {:<42} {}\n", words, positioning.failure);
      return;
    }
    const PositioningParameters& q = to_workpiece ? positioning.table_to_workpiece : positioning.workpiece_to_table;
    fmt::print("  {:<42}{:>10.3f}{:>10.3f}{:>10.3f}{:>9.3f}{:>9.3f}{:>9.3f}\n", words, q.translation[0],
               q.translation[1], q.translation[2], q.angles[0] / kDegree, q.angles[1] / kDegree, q.angles[2] / kDegree);
    fmt::print("  {:<42}{:>10.4f}{:>10.4f}{:>10.4f}{:>9.4f}{:>9.4f}{:>9.4f}\n", "  standard uncertainty",
               std::sqrt(q.covariance(0, 0)), std::sqrt(q.covariance(1, 1)), std::sqrt(q.covariance(2, 2)),
               std::sqrt(q.covariance(3, 3)) / kDegree, std::sqrt(q.covariance(4, 4)) / kDegree,
               std::sqrt(q.covariance(5, 5)) / kDegree);
  };
  fmt::print("Positioning parameters, x y z / mm, alpha beta gamma / deg (Table 3)\n");
  row("p_workpiece = D p_table (the paper's words)", r.positioning, true);
  row("p_table = D p_workpiece (the other reading)", r.positioning, false);
  row("from a simulated scanner with occlusion", r.located.positioning, true);
  fmt::print(
      "  Wrong in print: (15) orients by heights; (17) t_z; (18) signs; (19) order; step 5 is D_M^W (D_M^B)^-1.\n"
      "  Targets 10 um, sphere and workpiece 20 um per point. Simulated scanner: {} of {} target positions and {} of "
      "{} "
      "places\n"
      "  seen{}.\n\n",
      r.scans.targets_seen, r.scans.targets_placed, r.scans.surface_seen, r.scans.surface_placed,
      r.located.positioning.failure.empty()
          ? fmt::format(", {:.1f} um off the truth, chi-square {:.1f} of 6",
                        1e3 * r.located.positioning.largest_difference, r.located.chi_square)
          : "");
}

void print_contour(const YinResults& r) {
  if (!r.positioning.failure.empty()) return;  // there is none
  const YinContour& c = r.contour;
  fmt::print("Contour error at the 30 points of Table A4 / um ({} runs, {} inputs)\n", c.budget.runs, c.budget.inputs);
  fmt::print("  {:<58}{:>8}{:>8}{:>8}\n", "", "mean", "max", "s");
  const auto row = [](const char* words, const YinFigures& f) {
    fmt::print("  {:<58}{:>8.1f}{:>8.1f}{:>8.1f}\n", words, f.mean, f.largest, f.deviation);
  };
  row("paper, measured", kYinMeasured);
  row("predicted, across the curve in the surface", c.across);
  row("  95 % of machines stay below", c.upper);
  row("predicted, whole distance in the surface", c.in_surface);
  if (r.sections.refused > 0) {
    fmt::print("  of {} of {} sections, the others have no edge:\n", r.sections.fits.size() - r.sections.refused,
               r.sections.fits.size());
  }
  row("one simulated part, its edges", r.sections.truth);
  row("  from its sections: commanded curve to P2", r.sections.found);
  row("  from its sections: P1 P2, called contour error", r.sections.rounding);
  fmt::print(
      "  Sections: 1280 points, 2 um in height and 1 um across, rounding of {:.0f} um (assumed). The edges are found "
      "within {:.1f} um.\n"
      "  P1 P2 is the rounding of the edge, whatever the machine did; the contour error is that of P2.\n"
      "  L_tA as printed, all else exact: up to {:.0f} um\n\n",
      1e3 * r.sections.radius, 1e3 * r.sections.largest_miss, c.printed_l_ta);
  fmt::print("Uncertainty budget, standard uncertainty, root mean square over the points / um\n");
  fmt::print("  {:<30}{:>7}{:>13}{:>22}{:>13}{:>22}{:>8}\n", "", "inputs", "across: lin.", "Monte Carlo", "along: lin.",
             "Monte Carlo", "share");
  const auto line = [](const std::string& words, std::size_t inputs, const std::vector<BudgetFigure>& k, double share) {
    const auto drawn = [](const BudgetFigure& f) {
      return fmt::format("{:.2f} +- {:.2f}", 1e3 * f.by_monte_carlo, 1e3 * f.monte_carlo_uncertainty);
    };
    fmt::print("  {:<30}{:>7}{:>13.2f}{:>22}{:>13.2f}{:>22}{:>7.1f}%\n", words, inputs, 1e3 * k[0].by_sensitivity,
               drawn(k[0]), 1e3 * k[1].by_sensitivity, drawn(k[1]), 100 * share);
  };
  for (const BudgetLine& cause : c.budget.lines) line(cause.cause, cause.inputs, cause.kinds, cause.share);
  line("all", c.budget.inputs, c.budget.total, 1);
  fmt::print(
      "  Both ways differ by at most {:.1f} of Monte Carlo's own standard uncertainties. What lies along the curve, a "
      "section does not see.\n\n",
      c.budget.largest_disagreement());
}

}  // namespace

void print_yin(const YinResults& r) {
  print_yin_equations(r.equations);
  print_linkage(r);
  print_positioning(r);
  print_yin_commands(r.commands);
  print_contour(r);
  for (const std::string& failure : r.failures) fmt::print("NOT FOUND: {}\n", failure);
  fmt::print("{} with the reference to 1e-9 mm\n", r.agrees ? "agrees" : "DOES NOT AGREE");
}

}  // namespace abbe
