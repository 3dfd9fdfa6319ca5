#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "command.h"
#include "reproduce/reproduce.h"
#include "reproduce/yin_study.h"

namespace abbe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kRuns = 2000;
constexpr std::uint64_t kSeed = 2021;
constexpr double kAgreement = 1e-9;  // mm
constexpr ContourFigures kPaper = {15.1, 29.5, 6.8};

struct Results {
  YinSteps table_moves, head_moves;
  YinPositioning positioning;
  YinContour contour;
  bool agrees = false;
};

nlohmann::ordered_json parameters_json(const SwingHeadLinkage& linkage) {
  nlohmann::ordered_json json;
  const auto values = linkage.values();
  for (std::size_t i = 0; i < values.size(); ++i) json[std::string(linkage_name(i)) + "_mm"] = values[i];
  return json;
}

nlohmann::ordered_json figures_json(const ContourFigures& f) {
  return {{"mean_um", f.mean}, {"max_um", f.largest}, {"standard_deviation_um", f.deviation}};
}

nlohmann::ordered_json position_json(const PositioningParameters& p) {
  nlohmann::ordered_json json;
  const char* names[] = {"x_mm", "y_mm", "z_mm", "alpha_deg", "beta_deg", "gamma_deg"};
  for (Eigen::Index i = 0; i < 6; ++i) {
    json[names[i]] = i < 3 ? p.translation[i] : p.angles[i - 3] / kDegree;
    json["u_" + std::string(names[i])] = std::sqrt(p.covariance(i, i)) / (i < 3 ? 1 : kDegree);
  }
  return json;
}

void print_json(const Results& r) {
  nlohmann::ordered_json json;
  for (const auto* steps : {&r.table_moves, &r.head_moves}) {
    nlohmann::ordered_json& part = json["linkage"][steps == &r.table_moves ? "U" : "P"];
    part["corrected"] = parameters_json(steps->found.linkage);
    part["printed"] = parameters_json(steps->found.printed);
    for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
      part["standard_uncertainty_um"][linkage_name(i)] = 1e3 * steps->found.standard_uncertainty(i);
    }
  }
  json["positioning"] = {{"table_to_workpiece", position_json(r.positioning.table_to_workpiece)},
                         {"workpiece_to_table", position_json(r.positioning.workpiece_to_table)}};
  const YinContour& c = r.contour;
  json["contour"] = {{"paper", figures_json(kPaper)},           {"across_the_curve", figures_json(c.measured)},
                     {"in_the_surface", figures_json(c.whole)}, {"across_95_percent", figures_json(c.upper)},
                     {"rms_by_sensitivity_um", c.across},       {"rms_by_monte_carlo_um", c.sampled_across},
                     {"L_tA_as_printed_um", c.printed_l_ta}};
  for (const BudgetShare& share : c.shares) {
    json["contour"]["budget"].push_back(
        {{"cause", share.cause}, {"across_um", share.across}, {"in_surface_um", share.in_surface}});
  }
  json["agrees_with_reference"] = r.agrees;
  fmt::print("{}\n", json_text(json));
}

void print_linkage(const Results& r) {
  fmt::print("Linkage parameters by the five steps, exact readings of the machine of Table 2 / mm\n");
  fmt::print("  {:<8}{:>12}{:>14}{:>16}{:>16}{:>10}\n", "", "Table 2", "corrected", "printed, U", "printed, P",
             "u / um");
  const auto table = yin_linkage().values();
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    fmt::print("  {:<8}{:>12.3f}{:>14.3f}{:>16.3f}{:>16.3f}{:>10.1f}\n", linkage_name(i), table[i],
               r.table_moves.found.linkage.values()[i], r.table_moves.found.printed.values()[i],
               r.head_moves.found.printed.values()[i], 1e3 * r.table_moves.found.standard_uncertainty(i));
  }
  fmt::print(
      "  Wrong in print: (9) sign of h; step 3 takes 2 L_tA for L_tA; (10), (11) lose signs; (12) holds in convention "
      "U.\n"
      "  u: Table 1 as one standard deviation, microscope 2 um, zeros of A and C1 as good as their axes. U: X and Y "
      "carry the\n"
      "  table; P: (5) as printed.\n\n");
}

void print_positioning(const YinPositioning& p) {
  const auto row = [](const char* words, const PositioningParameters& q) {
    fmt::print("  {:<42}{:>10.3f}{:>10.3f}{:>10.3f}{:>9.3f}{:>9.3f}{:>9.3f}\n", words, q.translation[0],
               q.translation[1], q.translation[2], q.angles[0] / kDegree, q.angles[1] / kDegree, q.angles[2] / kDegree);
    fmt::print("  {:<42}{:>10.4f}{:>10.4f}{:>10.4f}{:>9.4f}{:>9.4f}{:>9.4f}\n", "  standard uncertainty",
               std::sqrt(q.covariance(0, 0)), std::sqrt(q.covariance(1, 1)), std::sqrt(q.covariance(2, 2)),
               std::sqrt(q.covariance(3, 3)) / kDegree, std::sqrt(q.covariance(4, 4)) / kDegree,
               std::sqrt(q.covariance(5, 5)) / kDegree);
  };
  fmt::print("Positioning parameters from simulated scans, x y z / mm, alpha beta gamma / deg (Table 3)\n");
  row("p_workpiece = D p_table (the paper's words)", p.table_to_workpiece);
  row("p_table = D p_workpiece (the other reading)", p.workpiece_to_table);
  fmt::print(
      "  Wrong in print: (15) orients by heights; (17) t_z; (18) signs; (19) order; step 5 is D_M^W (D_M^B)^-1.\n"
      "  Targets 10 um, sphere and workpiece 20 um per point.\n\n");
}

void print_contour(const YinContour& c) {
  fmt::print("Contour error at the 30 points of Table A4 / um ({} runs, {} causes)\n", c.runs, c.causes);
  fmt::print("  {:<58}{:>8}{:>8}{:>8}\n", "", "mean", "max", "s");
  const auto row = [](const char* words, const ContourFigures& f) {
    fmt::print("  {:<58}{:>8.1f}{:>8.1f}{:>8.1f}\n", words, f.mean, f.largest, f.deviation);
  };
  row("paper, measured", kPaper);
  row("predicted, across the curve in the surface", c.measured);
  row("  95 % of machines stay below", c.upper);
  row("predicted, whole distance in the surface", c.whole);
  fmt::print("  root mean square across the curve: {:.2f} by sensitivity, {:.2f} by Monte Carlo\n", c.across,
             c.sampled_across);
  fmt::print("  L_tA as printed, all else exact: up to {:.0f} um\n", c.printed_l_ta);
  fmt::print("  {:<40}{:>12}{:>14}\n", "cause", "across", "in surface");
  for (const BudgetShare& share : c.shares) {
    fmt::print("  {:<40}{:>12.2f}{:>14.2f}\n", share.cause, share.across, share.in_surface);
  }
  fmt::print(
      "  The line scanner enters as 2 um across the curve. What lies along the curve, a scanner's section does not "
      "see.\n\n");
}

}  // namespace

int reproduce_yin(const ReproduceOptions& options) {
  if (!options.output.empty()) {
    throw InputError({.field = "--output"}, "reproduce yin writes no folder", "no --output; --json prints the figures");
  }
  Results r;
  r.table_moves = yin_steps(LinkageConvention::table_moves);
  r.head_moves = yin_steps(LinkageConvention::head_moves);
  r.positioning = yin_positioning();
  r.agrees = r.table_moves.largest_difference < kAgreement && r.head_moves.largest_difference < kAgreement &&
             r.positioning.largest_difference < kAgreement;
  r.contour = yin_contour(r.positioning, kRuns, kSeed);
  if (options.json) {
    print_json(r);
  } else {
    print_linkage(r);
    print_positioning(r.positioning);
    print_contour(r.contour);
    fmt::print("{} with the reference to 1e-9 mm\n", r.agrees ? "agrees" : "DOES NOT AGREE");
  }
  return r.agrees ? kDone : kNegative;
}

}  // namespace abbe
