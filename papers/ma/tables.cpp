#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "ma/results.h"

namespace abbe {
namespace {

std::vector<ReproducedColumn> with_motions(std::vector<ReproducedColumn> columns, int decimals) {
  for (std::size_t i = 0; i < 6; ++i) columns.push_back({kMaMotionNames[i], ma_unit(i), decimals});
  return columns;
}

std::vector<ReproducedCell> motion_row(std::vector<ReproducedCell> cells, const SixMotions& in_unit) {
  for (const double value : in_unit) cells.emplace_back(value);
  return cells;
}

/// Adds a row of one text and six motions in their units.
void add_motions(ReproducedTable& table, const char* words, const SixMotions& in_unit) {
  table.rows.push_back(motion_row({words}, in_unit));
}

ReproducedTable reference_readings(const MaResults& r) {
  ReproducedTable table{"reference",
                        "Ray-traced readings against the reference (independent program), 13 positions x 7 readings",
                        {{"order of the tilt"}, {"traced"}, {"angles", "arcsec"}, {"lengths", "mm"}},
                        {},
                        {}};
  constexpr const char* kOrders[] = {"paper", "face"};
  for (std::size_t v = 0; v < 2; ++v) {
    table.rows.push_back({kOrders[v], "one by one", r.one_by_one[v].angle / kArcsec, r.one_by_one[v].length});
    table.rows.push_back({kOrders[v], "vectorised", r.traced[v].angle / kArcsec, r.traced[v].length});
  }
  table.notes = {
      "Paper: equation (3) applies a face's tilt before its turn, so that it goes with cos(theta). Face: a "
      "tilt of the glass is a constant of its face. (10) holds in the paper's order only."};
  return table;
}

std::string marked_motions(const std::array<bool, 6>& seen) {
  std::string text;
  for (std::size_t i = 0; i < 6; ++i) {
    if (seen[i]) text += fmt::format("{}{}", text.empty() ? "" : " ", kMaMotionNames[i]);
  }
  return text;
}

ReproducedTable prism_table(const MaResults& r) {
  ReproducedTable table{"table-1",
                        "Table 1: what one second of arc of each error of the prism does to the motions found",
                        with_motions({{"error"}}, 4),
                        {},
                        {}};
  table.columns.push_back({"marked in the paper"});
  table.columns.push_back({"same here"});
  for (const MaPrismEffect& effect : r.prism) {
    std::vector<ReproducedCell> row = motion_row({effect.effect.symbol}, in_ma_units(effect.effect.change));
    row.emplace_back(marked_motions(effect.paper));
    row.emplace_back(effect.agrees() ? "yes" : "NO");
    table.rows.push_back(std::move(row));
  }
  table.notes = {"Largest change over the positions, instruments where section 3.3 puts them, no other errors."};
  return table;
}

ReproducedTable effects_table(const MaResults& r) {
  ReproducedTable table{"errors-46",
                        fmt::format("The {} errors of the model, and what each does in section 3.3", r.effects.size()),
                        {{"number", "", 0}, {"error"}, {"of"}, {"size"}, {"unit"}},
                        {},
                        {}};
  table.columns = with_motions(std::move(table.columns), 4);
  for (std::size_t n = 0; n < r.effects.size(); ++n) {
    const MaEffect& e = r.effects[n];
    table.rows.push_back(motion_row(
        {n + 1, e.symbol, e.words, e.size / (e.is_angle ? kArcsec : kMicrometre), e.is_angle ? "arcsec" : "um"},
        in_ma_units(e.change)));
  }
  table.notes = {
      "The paper counts 46 and lists none; 6 motions, 5 of the installation and 5 of the prism, 3 angles and 3 "
      "coordinates of five instruments add up to it. Change of the reading of each motion, largest over the positions: "
      "motions in full, installation and instruments against the first position, faces at their own position."};
  return table;
}

ReproducedTable section_33(const MaResults& r) {
  ReproducedTable table{"section-3-3",
                        "Section 3.3: 13 positions, errors of 100 arcsec, 100 um and 10 um; largest |found - set|",
                        with_motions({{"evaluation"}}, 4),
                        {},
                        {}};
  const MaInversions &paper = r.inversions[0], &face = r.inversions[1];
  add_motions(table, "paper", kMaPaper33);
  add_motions(table, "formulas as printed, paper order", in_ma_units(paper.printed));
  add_motions(table, "formulas corrected, paper order", in_ma_units(paper.corrected));
  add_motions(table, "formulas corrected, face order", in_ma_units(face.corrected));
  add_motions(table, "exact inversion, stepwise, paper order", in_ma_units(paper.stepwise));
  add_motions(table, "exact inversion, simultaneous, paper order", in_ma_units(paper.simultaneous));
  add_motions(table, "exact inversion, stepwise, face order", in_ma_units(face.stepwise));
  add_motions(table, "exact inversion, simultaneous, face order", in_ma_units(face.simultaneous));
  return table;
}

ReproducedTable figure_3(const MaResults& r) {
  ReproducedTable table{"figure-3",
                        "Figure 3: found minus set at every position, paper order",
                        with_motions({{"evaluation"}, {"position", "deg", 0}}, 5),
                        {},
                        {}};
  const MaInversions& paper = r.inversions[0];
  const std::pair<const char*, const std::vector<SixMotions>*> kinds[] = {{"formulas as printed", &paper.printed_at},
                                                                          {"formulas corrected", &paper.corrected_at},
                                                                          {"exact inversion", &paper.simultaneous_at}};
  for (const auto& [words, at] : kinds) {
    for (std::size_t k = 0; k < at->size(); ++k) {
      table.rows.push_back(motion_row({words, r.positions[k].angle / kDegree}, in_ma_units((*at)[k])));
    }
  }
  return table;
}

ReproducedTable motion_table_3(const MaTable& t) {
  ReproducedTable table{"table-3",
                        fmt::format("Table 3: largest motion over the positions, mean of {} runs of a simulated table "
                                    "like the SKQ-12200",
                                    kMaRuns),
                        with_motions({{"evaluation"}}, 2),
                        {},
                        {}};
  add_motions(table, "paper, before compensation", kMaPaperBefore);
  add_motions(table, "simulated, before", in_ma_units(t.before));
  add_motions(table, "paper, after compensation", kMaPaperAfter);
  add_motions(table, "simulated, after the paper's trigonometric fit", in_ma_units(t.fitted));
  add_motions(table, "simulated, exact inversion, installation known", in_ma_units(t.inverted));
  add_motions(table, "what the simulated table did", in_ma_units(t.truth));
  add_motions(table, "true motion that the fit takes for installation", in_ma_units(t.absorbed));
  return table;
}

ReproducedTable repeatability_table(const MaTable& t) {
  ReproducedTable table{"repeatability",
                        "Section 4: repeatability, half the peak-to-peak value of the runs, largest over the positions",
                        with_motions({{"evaluation"}}, 2),
                        {},
                        {}};
  add_motions(table, "paper, before compensation", kMaPaperRepeatabilityBefore);
  add_motions(table, "simulated, before", in_ma_units(t.repeatability_before));
  add_motions(table, "paper, after compensation", kMaPaperRepeatability);
  add_motions(table, "simulated, after the trigonometric fit", in_ma_units(t.repeatability_fitted));
  add_motions(table, "simulated, exact inversion", in_ma_units(t.repeatability_inverted));
  add_motions(table, "what the simulated table did", in_ma_units(t.repeatability_truth));
  return table;
}

/// 100 (1 - after / before).
SixMotions reduction_percent(const SixMotions& before, const SixMotions& after) {
  SixMotions percent{};
  for (std::size_t i = 0; i < 6; ++i) percent[i] = 100 * (1 - after[i] / before[i]);
  return percent;
}

ReproducedTable reductions(const MaTable& t) {
  ReproducedTable table{"reductions", "Reduction by the compensation", {{"of"}, {"evaluation"}}, {}, {}};
  add_columns(table, {kMaMotionNames.begin(), kMaMotionNames.end()}, "%");
  const auto add = [&](const char* of, const char* words, const SixMotions& before, const SixMotions& after) {
    table.rows.push_back(motion_row({of, words}, reduction_percent(before, after)));
  };
  add("largest motion", "paper, from the rows of Table 3", kMaPaperBefore, kMaPaperAfter);
  add("largest motion", "simulated, trigonometric fit", t.before, t.fitted);
  add("largest motion", "simulated, exact inversion", t.before, t.inverted);
  add("repeatability", "paper, from its numbers", kMaPaperRepeatabilityBefore, kMaPaperRepeatability);
  add("repeatability", "simulated, trigonometric fit", t.repeatability_before, t.repeatability_fitted);
  add("repeatability", "simulated, exact inversion", t.repeatability_before, t.repeatability_inverted);
  return table;
}

ReproducedTable figure_5(const MaTable& t) {
  ReproducedTable table{
      "figure-5",
      fmt::format("Figure 5: motions by position, mean of {} runs, and half of their peak-to-peak value", kMaRuns),
      with_motions({{"evaluation"}, {"value"}, {"position", "deg", 0}}, 3),
      {},
      {}};
  const std::pair<const char*, const MaCourses*> kinds[] = {{"before", &t.courses_before},
                                                            {"trigonometric fit", &t.courses_fitted},
                                                            {"exact inversion", &t.courses_inverted},
                                                            {"truth", &t.courses_truth}};
  for (const auto& [words, courses] : kinds) {
    for (const bool mean : {true, false}) {
      for (std::size_t k = 0; k < t.angles.size(); ++k) {
        table.rows.push_back(motion_row({words, mean ? "mean" : "half range", t.angles[k] / kDegree},
                                        in_ma_units((mean ? courses->mean : courses->half_range)[k])));
      }
    }
  }
  return table;
}

ReproducedTable rank_table(const MaResults& r) {
  ReproducedTable table{"rank",
                        "What the readings can see (six readings per position, 12 positions; rank of first order)",
                        {{"mounts"}, {"unknowns", "", 0}, {"readings", "", 0}, {"rank", "", 0}},
                        {},
                        {}};
  for (const MaRank& line : r.ranks) table.rows.push_back({line.words, line.unknowns, line.readings, line.rank});
  return table;
}

ReproducedTable gauge_table(const MaResults& r) {
  ReproducedTable table{"gauge", "Gauge of the two mounts", {{"equation"}}, {}, {}};
  for (const PolygonGaugeEquation& equation : r.separation.gauge) table.rows.push_back({equation.words});
  return table;
}

ReproducedTable separation_table(const MaResults& r) {
  ReproducedTable table{"two-mounts",
                        "Two mounts, second turned by one face: largest |found - true| in that gauge",
                        with_motions({{"case"}}, 4),
                        {},
                        {}};
  add_motions(table, "noise 0.05 arcsec and 0.03 um", in_ma_units(r.separation.error));
  add_motions(table, "without noise (second order of the gauge)", in_ma_units(r.noise_free.error));
  add_motions(table, "stated standard uncertainty, largest", in_ma_units(r.separation.uncertainty));
  add_motions(table, "one mount alone, prism taken as perfect", in_ma_units(r.separation.confused));
  table.notes = {fmt::format(
      "Faces: azimuth {:.4f} arcsec, tilt {:.4f} arcsec, distance {:.4f} um; chi-square {:.1f} with {} degrees of "
      "freedom.",
      r.separation.azimuth_error / kArcsec, r.separation.tilt_error / kArcsec,
      r.separation.distance_error / kMicrometre, r.separation.result.chi_square,
      r.separation.result.degrees_of_freedom)};
  return table;
}

/// Largest of the six motions.
double largest_reduction(const SixMotions& before, const SixMotions& after) {
  const SixMotions percent = reduction_percent(before, after);
  return *std::max_element(percent.begin(), percent.end());
}

}  // namespace

SixMotions in_ma_units(const SixMotions& motions) {
  SixMotions result = motions;
  for (std::size_t i = 0; i < 6; ++i) result[i] /= i < 3 ? kArcsec : kMicrometre;
  return result;
}

const char* ma_unit(std::size_t motion) { return motion < 3 ? "arcsec" : "um"; }

std::vector<ReproducedTable> ma_tables(const MaResults& r) {
  std::vector<ReproducedTable> tables = {reference_readings(r), prism_table(r), effects_table(r), section_33(r)};
  tables.push_back(motion_table_3(r.table));
  tables.push_back(repeatability_table(r.table));
  tables.push_back(reductions(r.table));
  tables.push_back(rank_table(r));
  tables.push_back(gauge_table(r));
  tables.push_back(separation_table(r));
  for (ReproducedTable table : {figure_3(r), figure_5(r.table)}) {
    table.in_text = false;
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<PublishedNumber> ma_published(const MaResults& r) {
  std::vector<PublishedNumber> numbers;
  const SixMotions corrected = in_ma_units(r.inversions[0].corrected), before = in_ma_units(r.table.before),
                   fitted = in_ma_units(r.table.fitted), unsteady = in_ma_units(r.table.repeatability_before),
                   steady = in_ma_units(r.table.repeatability_fitted);
  const auto add = [&](const std::string& where, const SixMotions& paper, const SixMotions& here, const char* note,
                       int decimals) {
    for (std::size_t i = 0; i < 6; ++i) {
      numbers.push_back(
          {fmt::format("{}, {}", where, kMaMotionNames[i]), ma_unit(i), paper[i], here[i], note, decimals});
    }
  };
  numbers.push_back({"Section 5, errors of the model", "", 46.0, static_cast<double>(r.effects.size()),
                     "they are listed in tables/errors-46.csv", 0});
  add("Section 3.3", kMaPaper33, corrected, "corrected formulas; which face errors were drawn is not published", 4);
  add("Table 3, before", kMaPaperBefore, before, "simulated", 2);
  add("Table 3, after", kMaPaperAfter, fitted, "simulated, trigonometric fit", 2);
  add("Repeatability, before", kMaPaperRepeatabilityBefore, unsteady, "simulated", 2);
  add("Repeatability, after", kMaPaperRepeatability, steady, "simulated, trigonometric fit", 2);
  numbers.push_back(
      {"Section 4, largest reduction of a motion", "%", 79.1, largest_reduction(r.table.before, r.table.fitted),
       fmt::format("the rows of Table 3 give {:.2f} %", largest_reduction(kMaPaperBefore, kMaPaperAfter))});
  numbers.push_back({"Section 4, largest reduction of a repeatability", "%", 54.69,
                     largest_reduction(r.table.repeatability_before, r.table.repeatability_fitted),
                     fmt::format("the paper's numbers give {:.2f} %",
                                 largest_reduction(kMaPaperRepeatabilityBefore, kMaPaperRepeatability))});
  return numbers;
}

std::vector<std::string> ma_conclusions(const MaResults& r) {
  std::size_t same = 0;
  for (const MaPrismEffect& effect : r.prism) same += effect.agrees() ? 1U : 0U;
  const double fit = largest_reduction(r.table.before, r.table.fitted),
               exact = largest_reduction(r.table.before, r.table.inverted);
  return {
      fmt::format("Table 1: {} of {} lines have the marks of the paper.", same, r.prism.size()),
      "A fit of constant, cosine and sine removes real once-per-turn motion together with the installation: it is a "
      "choice of gauge (the axis average line), not a compensation. A constant offset of the prism cannot change the "
      "repeatability; what the fit changes there is motion of the table.",
      fmt::format("The largest reduction of a motion is {:.1f} % by the fit and {:.1f} % by exact inversion with the "
                  "installation known: only the second is due to the installation.",
                  fit, exact),
      "With one mount any error of a face looks like a motion at its position. Two mounts turned by one face separate "
      "them; only the constants and the once-per-turn parts, which the installation has too, stay open.",
      "Table 3 and Figure 5 are measurements of one table, available from the authors on request only. Here a table "
      "with motions as large as those of Table 3 is simulated: its numbers can be compared in size, not one by one."};
}

}  // namespace abbe
