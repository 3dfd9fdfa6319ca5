#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/geometry/angle_units.h"
#include "exit_code.h"
#include "reproduce/ma_study.h"
#include "reproduce/reproduce.h"

namespace abbe {
namespace {

constexpr std::size_t kRuns = 10;
constexpr std::uint64_t kCampaignSeed = 2021;
constexpr double kMaAgreement = 1e-9;  // arcsec and mm

constexpr SixMotions kPaper33 = {0.0003, 0.0003, 0.0509, 0.084, 0.036, 0.028};  // printed as eps_z, eps_y, eps_x
constexpr SixMotions kPaperBefore = {26.15, 33.36, 27.28, 37.65, 53.09, 2.66};
constexpr SixMotions kPaperAfter = {15.93, 16.69, 27.38, 12.74, 11.12, 2.57};
constexpr SixMotions kPaperRepeatability = {0.87, 1.28, 15.13, 0.74, 0.87, 0.34};
constexpr SixMotions kPaperRepeatabilityBefore = {1.92, 1.35, 15.13, 1.12, 1.36, 0.53};

/// From rad and mm to arcsec and um.
SixMotions in_units(const SixMotions& motions) {
  SixMotions result = motions;
  for (std::size_t i = 0; i < 6; ++i) result[i] /= i < 3 ? kArcsec : kMicrometre;
  return result;
}

struct Variant {
  const char* name;
  PolygonFaceOrder order;
};
constexpr Variant kVariants[] = {{"paper order", PolygonFaceOrder::paper}, {"face order", PolygonFaceOrder::face}};

struct MaResults {
  ReadingDifference traced[2], one_by_one[2];
  MaInversions inversions[2];
  MaTable table;
  std::vector<MaRank> ranks;
  MaSeparation separation, noise_free;
  bool agrees = true;
};

MaResults ma_results() {
  MaResults r;
  for (std::size_t v = 0; v < 2; ++v) {
    const MaExample example = ma_example(kVariants[v].order);
    const std::vector<PolygonReadings> reference = read_ma_reference(kVariants[v].order);
    if (reference.size() != example.positions.size()) {
      throw InputError({.file = "golden/ma"}, fmt::format("{} reference positions", reference.size()),
                       fmt::format("{}", example.positions.size()));
    }
    r.one_by_one[v] = largest_difference(ma_readings(example), reference);
    r.traced[v] = largest_difference(ma_traced(example), reference);
    r.inversions[v] = ma_inversions(example);
    for (const ReadingDifference& d : {r.one_by_one[v], r.traced[v]}) {
      r.agrees = r.agrees && d.angle < kMaAgreement * kArcsec && d.length < kMaAgreement;
    }
    for (const SixMotions& exact : {in_units(r.inversions[v].stepwise), in_units(r.inversions[v].simultaneous)}) {
      for (std::size_t i = 0; i < 6; ++i) r.agrees = r.agrees && exact[i] < (i < 3 ? 1e-11 : 1e-10);
    }
    r.agrees = r.agrees && r.inversions[v].all_converged;
  }
  r.table = ma_table(kRuns, kCampaignSeed);
  r.ranks = ma_rank_table();
  r.agrees = r.agrees && r.ranks[0].rank == 72 && r.ranks[1].rank == 107;
  const PolygonNoise noise;
  r.separation = ma_separation(noise, true, kCampaignSeed);
  r.noise_free = ma_separation(noise, false, kCampaignSeed);
  r.agrees = r.agrees && r.separation.result.status == PolygonSeparationStatus::converged &&
             r.noise_free.result.status == PolygonSeparationStatus::converged;
  return r;
}

nlohmann::ordered_json motions_json(const SixMotions& in_unit) {
  return {{"eps_x_arcsec", in_unit[0]}, {"eps_y_arcsec", in_unit[1]}, {"eps_z_arcsec", in_unit[2]},
          {"delta_x_um", in_unit[3]},   {"delta_y_um", in_unit[4]},   {"delta_z_um", in_unit[5]}};
}

nlohmann::ordered_json json_of(const MaResults& r) {
  nlohmann::ordered_json json;
  const char* keys[] = {"paperorder", "faceorder"};
  for (std::size_t v = 0; v < 2; ++v) {
    json["reference_difference"][keys[v]] = {
        {"angle_arcsec", std::max(r.one_by_one[v].angle, r.traced[v].angle) / kArcsec},
        {"length_mm", std::max(r.one_by_one[v].length, r.traced[v].length)}};
    nlohmann::ordered_json& section = json["section_3_3"][keys[v]];
    section["printed"] = motions_json(in_units(r.inversions[v].printed));
    section["corrected"] = motions_json(in_units(r.inversions[v].corrected));
    section["exact_stepwise"] = motions_json(in_units(r.inversions[v].stepwise));
    section["exact_simultaneous"] = motions_json(in_units(r.inversions[v].simultaneous));
  }
  json["section_3_3"]["paper"] = motions_json(kPaper33);
  json["table_3"] = {{"paper_before", motions_json(kPaperBefore)},
                     {"paper_after", motions_json(kPaperAfter)},
                     {"before", motions_json(in_units(r.table.before))},
                     {"after_trigonometric_fit", motions_json(in_units(r.table.fitted))},
                     {"after_exact_inversion", motions_json(in_units(r.table.inverted))},
                     {"truth", motions_json(in_units(r.table.truth))},
                     {"motion_absorbed_by_the_fit", motions_json(in_units(r.table.absorbed))}};
  json["repeatability"] = {{"paper_before", motions_json(kPaperRepeatabilityBefore)},
                           {"paper_after", motions_json(kPaperRepeatability)},
                           {"before", motions_json(in_units(r.table.repeatability_before))},
                           {"after_trigonometric_fit", motions_json(in_units(r.table.repeatability_fitted))},
                           {"after_exact_inversion", motions_json(in_units(r.table.repeatability_inverted))},
                           {"truth", motions_json(in_units(r.table.repeatability_truth))}};
  json["rank"] = nlohmann::ordered_json::array();
  for (const MaRank& line : r.ranks) {
    json["rank"].push_back(
        {{"case", line.words}, {"unknowns", line.unknowns}, {"readings", line.readings}, {"rank", line.rank}});
  }
  nlohmann::ordered_json gauge = nlohmann::ordered_json::array();
  for (const PolygonGaugeEquation& equation : r.separation.gauge) gauge.push_back(equation.words);
  json["two_mounts"] = {{"gauge", gauge},
                        {"error", motions_json(in_units(r.separation.error))},
                        {"error_without_noise", motions_json(in_units(r.noise_free.error))},
                        {"standard_uncertainty", motions_json(in_units(r.separation.uncertainty))},
                        {"one_mount_alone", motions_json(in_units(r.separation.confused))},
                        {"face_azimuth_arcsec", r.separation.azimuth_error / kArcsec},
                        {"face_tilt_arcsec", r.separation.tilt_error / kArcsec},
                        {"face_distance_um", r.separation.distance_error / kMicrometre},
                        {"chi_square", r.separation.result.chi_square},
                        {"degrees_of_freedom", r.separation.result.degrees_of_freedom}};
  json["agrees_with_reference"] = r.agrees;
  return json;
}

void print_header() {
  fmt::print("  {:<46}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "eps_x", "eps_y", "eps_z", "delta_x", "delta_y",
             "delta_z");
  fmt::print("  {:<46}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "arcsec", "arcsec", "arcsec", "um", "um", "um");
}

void print_row(const char* words, const SixMotions& in_unit, const char* format) {
  fmt::print("  {:<46}", words);
  for (const double value : in_unit) fmt::print("{:>10}", fmt::format(fmt::runtime(format), value));
  fmt::print("\n");
}

void print_section_33(const MaResults& r) {
  fmt::print("Section 3.3: 13 positions, errors of 100 arcsec, 100 um and 10 um; largest |found - set|\n");
  print_header();
  print_row("paper", kPaper33, "{:.4f}");
  const MaInversions& paper = r.inversions[0];
  print_row("formulas as printed, paper order", in_units(paper.printed), "{:.4f}");
  print_row("formulas corrected, paper order", in_units(paper.corrected), "{:.4f}");
  print_row("formulas corrected, face order", in_units(r.inversions[1].corrected), "{:.4f}");
  print_row("exact inversion, stepwise, paper order", in_units(paper.stepwise), "{:.0e}");
  print_row("exact inversion, simultaneous, paper order", in_units(paper.simultaneous), "{:.0e}");
  print_row("exact inversion, stepwise, face order", in_units(r.inversions[1].stepwise), "{:.0e}");
  print_row("exact inversion, simultaneous, face order", in_units(r.inversions[1].simultaneous), "{:.0e}");
  fmt::print(
      "  Wrong in print: (11) sign of eps_ybc sin(theta); (13) signs of delta_xbc sin and eps_ybc sin; (18) V_x - "
      "V_x8.\n"
      "  (3) applies a face's tilt before its turn, so that it goes with cos(theta) (paper order); a tilt of the "
      "glass\n"
      "  is a constant of its face (face order). (10) holds in the paper order only.\n\n");
}

void print_table_3(const MaTable& t) {
  fmt::print(
      "Section 4: {} runs of a table like the SKQ-12200 (simulated), one autocollimator and one sensor, three "
      "set-ups\n",
      kRuns);
  fmt::print("  largest motion over the positions (Table 3), mean of the runs\n");
  print_header();
  print_row("paper, before compensation", kPaperBefore, "{:.2f}");
  print_row("simulated, before", in_units(t.before), "{:.2f}");
  print_row("paper, after compensation", kPaperAfter, "{:.2f}");
  print_row("simulated, after the paper's trigonometric fit", in_units(t.fitted), "{:.2f}");
  print_row("simulated, exact inversion, installation known", in_units(t.inverted), "{:.2f}");
  print_row("what the simulated table did", in_units(t.truth), "{:.2f}");
  fmt::print("  repeatability: half the peak-to-peak value of the runs, largest over the positions\n");
  print_row("paper, before compensation", kPaperRepeatabilityBefore, "{:.2f}");
  print_row("simulated, before", in_units(t.repeatability_before), "{:.2f}");
  print_row("paper, after compensation", kPaperRepeatability, "{:.2f}");
  print_row("simulated, after the trigonometric fit", in_units(t.repeatability_fitted), "{:.2f}");
  print_row("simulated, exact inversion", in_units(t.repeatability_inverted), "{:.2f}");
  print_row("what the simulated table did", in_units(t.repeatability_truth), "{:.2f}");
  print_row("true motion that the fit takes for installation", in_units(t.absorbed), "{:.2f}");
  fmt::print(
      "  A fit of constant, cosine and sine removes real once-per-turn motion with the installation: it is a choice "
      "of\n"
      "  gauge (the axis average line), not a compensation. A constant offset of the prism cannot change the\n"
      "  repeatability; what the fit changes there is motion of the table.\n\n");
}

void print_separation(const MaResults& r) {
  fmt::print("What the readings can see (six readings per position, 12 positions; rank of first order)\n");
  fmt::print("  {:<70}{:>10}{:>10}{:>8}\n", "", "unknowns", "readings", "rank");
  for (const MaRank& line : r.ranks) {
    fmt::print("  {:<70}{:>10}{:>10}{:>8}\n", line.words, line.unknowns, line.readings, line.rank);
  }
  fmt::print(
      "  One mount: any error of a face is also a motion of its position. Two mounts turned by one face separate "
      "them;\n"
      "  what stays open are constants and the once-per-turn parts that are the installation.\n\n");
  fmt::print("Gauge of the two mounts ({} equations)\n", r.separation.gauge.size());
  for (const PolygonGaugeEquation& equation : r.separation.gauge) fmt::print("  - {}\n", equation.words);
  fmt::print("\nTwo mounts, second turned by one face: largest |found - true| in that gauge\n");
  print_header();
  print_row("noise 0.05 arcsec and 0.03 um", in_units(r.separation.error), "{:.4f}");
  print_row("without noise (second order of the gauge)", in_units(r.noise_free.error), "{:.4f}");
  print_row("stated standard uncertainty, largest", in_units(r.separation.uncertainty), "{:.4f}");
  print_row("one mount alone, prism taken as perfect", in_units(r.separation.confused), "{:.4f}");
  fmt::print(
      "  faces: azimuth {:.4f} arcsec, tilt {:.4f} arcsec, distance {:.4f} um; chi-square {:.1f} with {} degrees of "
      "freedom\n",
      r.separation.azimuth_error / kArcsec, r.separation.tilt_error / kArcsec,
      r.separation.distance_error / kMicrometre, r.separation.result.chi_square,
      r.separation.result.degrees_of_freedom);
}

}  // namespace

int reproduce_ma(const ReproduceOptions& options) {
  if (!options.output.empty()) {
    throw InputError({.field = "--output"}, "reproduce ma writes no folder", "no --output; --json prints the figures");
  }
  const MaResults r = ma_results();
  if (options.json) {
    fmt::print("{}", json_text(json_of(r)));
    return r.agrees ? kDone : kNegative;
  }
  fmt::print("Ma, Li, Feng, He, Ding, Cui (2021), Applied Sciences 11, 3960\n");
  fmt::print("12-face polygon prism, two autocollimators and three displacement sensors on a rotary table\n\n");
  fmt::print("Ray-traced readings against the reference (independent program), 13 positions x 7 readings\n");
  for (std::size_t v = 0; v < 2; ++v) {
    fmt::print("  {:<14} one by one {:.0e} arcsec, {:.0e} mm; vectorised {:.0e} arcsec, {:.0e} mm (limit {:.0e})\n",
               kVariants[v].name, r.one_by_one[v].angle / kArcsec, r.one_by_one[v].length, r.traced[v].angle / kArcsec,
               r.traced[v].length, kMaAgreement);
  }
  fmt::print("\n");
  print_section_33(r);
  print_table_3(r.table);
  print_separation(r);
  fmt::print("\n{}\n", r.agrees ? "agrees with the reference" : "DOES NOT agree with the reference");
  return r.agrees ? kDone : kNegative;
}

}  // namespace abbe
