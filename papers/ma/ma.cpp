#include <fmt/format.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"
#include "ma/results.h"
#include "papers.h"

namespace abbe {
namespace {

constexpr std::uint64_t kMaSeed = 2021;
constexpr std::array<PolygonFaceOrder, 2> kMaOrders = {PolygonFaceOrder::paper, PolygonFaceOrder::face};

MaResults ma_results() {
  MaResults r;
  for (std::size_t v = 0; v < 2; ++v) {
    const MaExample example = ma_example(kMaOrders[v]);
    const std::vector<PolygonReadings> reference = read_ma_reference(kMaOrders[v]);
    if (reference.size() != example.positions.size()) {
      throw InputError({.file = "golden/ma"}, fmt::format("{} reference positions", reference.size()),
                       fmt::format("{}", example.positions.size()));
    }
    r.positions = example.positions;
    r.one_by_one[v] = largest_difference(ma_readings(example), reference);
    r.traced[v] = largest_difference(ma_traced(example), reference);
    r.inversions[v] = ma_inversions(example);
    for (const ReadingDifference& d : {r.one_by_one[v], r.traced[v]}) {
      r.agrees = r.agrees && d.angle < kMaAgreement * kArcsec && d.length < kMaAgreement;
    }
    for (const SixMotions& exact : {in_ma_units(r.inversions[v].stepwise), in_ma_units(r.inversions[v].simultaneous)}) {
      for (std::size_t i = 0; i < 6; ++i) r.agrees = r.agrees && exact[i] < (i < 3 ? 1e-11 : 1e-10);
    }
    r.agrees = r.agrees && r.inversions[v].all_converged;
  }
  r.prism = ma_prism_effects();
  r.effects = ma_all_effects();
  r.table = ma_table(kMaRuns, kMaSeed);
  r.ranks = ma_rank_table();
  r.agrees = r.agrees && r.ranks[0].rank == 72 && r.ranks[1].rank == 107;
  const PolygonNoise noise;
  r.separation = ma_separation(noise, true, kMaSeed);
  r.noise_free = ma_separation(noise, false, kMaSeed);
  r.agrees = r.agrees && r.separation.result.status == PolygonSeparationStatus::converged &&
             r.noise_free.result.status == PolygonSeparationStatus::converged;
  return r;
}

/// The readings of section 3.3 as computed here.
std::string section_33_readings(PolygonFaceOrder order) {
  const MaExample example = ma_example(order);
  std::string text = "position_deg";
  for (std::size_t i = 0; i < kPolygonReadings; ++i) {
    const auto reading = static_cast<PolygonReading>(i);
    text += fmt::format(",{}_{}", reading_name(reading), is_angle(reading) ? "arcsec" : "mm");
  }
  text += '\n';
  const std::vector<PolygonReadings> readings = ma_readings(example);
  for (std::size_t k = 0; k < readings.size(); ++k) {
    text += shortest_text(example.positions[k].angle / kDegree);
    for (std::size_t i = 0; i < kPolygonReadings; ++i) {
      text += ',' + shortest_text(readings[k][i] / (is_angle(static_cast<PolygonReading>(i)) ? kArcsec : 1));
    }
    text += '\n';
  }
  return text;
}

Reproduction ma_reproduction() {
  const MaResults r = ma_results();
  Reproduction made;
  made.paper = "ma";
  made.citation = "Ma, Li, Feng, He, Ding, Cui (2021), Applied Sciences 11, 3960";
  made.title =
      "Six motions of a rotary table by a 12-face polygon prism, two autocollimators and three displacement "
      "sensors";
  made.facts = {{"instruments", "two autocollimators, three displacement sensors, polygon of 12 faces"}};
  made.tables = ma_tables(r);
  made.published = ma_published(r);
  made.figures = ma_figures(r);
  made.conclusions = ma_conclusions(r);
  made.corrections = {
      "(11) the sign of eps_ybc sin(theta); (13) the signs of delta_xbc sin and eps_ybc sin; (18) V_x + V_x8; (17) has "
      "the opposite sign of (18).",
      "(3) applies a face's tilt before its turn; (7) the last matrix is T_0^4; theta_SCz loses its sign.",
      "A distance of its own per face is missing and enters the radial motions 1:1; 12.94 mm is half a face.",
      "Repeatability of delta_y: 0.87 um in section 4, 0.89 um in section 5."};
  made.agrees = r.agrees;
  made.details = ma_details(r);
  made.write_study = [](ResultsFolder& folder) {
    folder.write("study/section-3-3-readings-paper-order.csv", section_33_readings(PolygonFaceOrder::paper));
    folder.write("study/section-3-3-readings-face-order.csv", section_33_readings(PolygonFaceOrder::face));
  };
  return made;
}

}  // namespace

int reproduce_ma(const ReproduceOptions& options) { return run_reproduction(options, ma_reproduction); }

}  // namespace abbe
