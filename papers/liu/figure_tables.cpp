#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/angle_units.h"
#include "liu/results.h"

namespace abbe {
namespace {

ReproducedTable clamped_profiles(const LiuFigureStudy& study) {
  ReproducedTable table{"figure-4b",
                        fmt::format("Figure 4b: section of the standard cylinder {:.0f} mm above the middle, clamped "
                                    "wrongly on a perfect machine",
                                    kLiuClampingHeight),
                        {{"clamping errors"},
                         {"centre off", "um", 1},
                         {"radius minus 10 mm", "um", 2},
                         {"out of round", "um", 2},
                         {"largest deviation", "um", 1}},
                        {},
                        {}};
  for (const LiuProfile& p : study.clamped) {
    const LiuSection& s = p.sections.front();
    table.rows.push_back(
        {p.words, 1e3 * std::hypot(s.x, s.z), 1e3 * (s.radius - kLiuRadius), 1e3 * s.out_of_round, 1e3 * p.deviation});
  }
  table.notes = {"Least-squares circle; largest deviation of a point from the circle of 10 mm about the axis of C."};
  return table;
}

ReproducedTable profile_points(const LiuFigureStudy& study) {
  ReproducedTable table{"figure-4b-points",
                        "Figure 4b: distance of the section from the axis of C, less 10 mm",
                        {{"clamping errors"}, {"position of C", "deg", 0}, {"deviation", "um", 3}},
                        {},
                        {}};
  for (const LiuProfile& p : study.clamped) {
    const LiuSection& s = p.sections.front();
    for (std::size_t k = 0; k < s.angle.size(); ++k) {
      table.rows.push_back({p.words, s.angle[k] / kDegree, 1e3 * (s.distance[k] - kLiuRadius)});
    }
  }
  table.in_text = false;
  return table;
}

struct NamedPlaces {
  const char *step, *readings;
  const LiuPlaces* places;
};

std::vector<NamedPlaces> all_places(const LiuClampingStudy& s) {
  std::vector<NamedPlaces> places;
  const std::pair<const char*, const LiuCampaign*> cases[] = {
      {"exact", &s.exact}, {"noise of Table 2", &s.noisy}, {"exact, standard with taper", &s.tapered}};
  for (const auto& [words, campaign] : cases) {
    places.push_back({"stage A", words, &campaign->a.places});
    places.push_back({"stage C", words, &campaign->c.places});
    places.push_back({"clamping", words, &campaign->clamping.places});
  }
  return places;
}

ReproducedTable left_over(const LiuFigureStudy& study) {
  ReproducedTable table{"figures-6-to-8",
                        "Figures 6 to 8: height of the cylinder turned about the axis, virtual minus measured (11), "
                        "largest of 117 places",
                        {{"shifts"}, {"calibration of"}, {"readings"}, {"axis"}},
                        {},
                        {}};
  add_columns(table, {"0 deg", "90 deg", "180 deg", "270 deg"}, "um");
  const auto add = [&](const LiuClampingStudy& s, const NamedPlaces& p, bool nominal) {
    std::vector<ReproducedCell> row = {liu_unit_name(s.unit), p.step, p.readings, nominal ? "nominal" : "found"};
    for (std::size_t q = 0; q < kLiuQuarters; ++q) {
      row.emplace_back(1e3 * largest_magnitude(nominal ? p.places->nominal_difference(q) : p.places->remaining(q)));
    }
    table.rows.push_back(std::move(row));
  };
  for (const LiuClampingStudy& s : study.clampings) {
    const std::vector<NamedPlaces> places = all_places(s);
    for (std::size_t i = 0; i < 3; ++i) add(s, places[i], true);
    for (const NamedPlaces& p : places) add(s, p, false);
  }
  const LiuClampingStudy& s = study.micrometres();
  if (s.tapered.converged()) {
    table.notes = {
        fmt::format("A taper is seen only in part. The axis takes up the rest ({:.0f} arcsec), and the same standard "
                    "does not show it.",
                    std::abs(s.tapered.clamping.found[0] - s.truth[0]) / kArcsec)};
  }
  return table;
}

ReproducedTable place_values(const LiuFigureStudy& study) {
  ReproducedTable table{"figures-6-to-8-points",
                        "Figures 6 to 8, shifts in um: heights at the places of the four patches",
                        {{"calibration of"},
                         {"readings"},
                         {"angle", "deg", 0},
                         {"along", "mm", 0},
                         {"across", "mm", 0},
                         {"measured", "mm", 6},
                         {"virtual about nominal axis", "mm", 6},
                         {"virtual about axis found", "mm", 6}},
                        {},
                        {}};
  for (const NamedPlaces& p : all_places(study.micrometres())) {
    for (std::size_t q = 0; q < kLiuQuarters; ++q) {
      for (std::size_t k = 0; k < p.places->measured[q].size(); ++k) {
        const double along = 2.0 * (static_cast<double>(k / kLiuAcross) - 6),
                     across = static_cast<double>(k % kLiuAcross) - 4;
        table.rows.push_back({p.step, p.readings, 90.0 * static_cast<double>(q), along, across,
                              p.places->measured[q][k], p.places->nominal[q][k], p.places->found[q][k]});
      }
    }
  }
  table.in_text = false;
  return table;
}

ReproducedTable clamping_table(const LiuFigureStudy& study) {
  ReproducedTable table{
      "clamping",
      "Clamping errors, calibrated in steps (a), (b), (c): found minus true, and standard uncertainty",
      {{"shifts"},
       {"error"},
       {"unit"},
       {"true", "", 4},
       {"exact", "", 3},
       {"noise", "", 3},
       {"taper", "", 3},
       {"u axes exact", "", 3},
       {"spread", "", 3},
       {"mean", "", 3},
       {"u joint", "", 3},
       {"spread joint", "", 3}},
      {},
      {}};
  constexpr const char* kNames[] = {"tilt about x", "tilt about z", "shift along x", "shift along z"};
  for (const LiuClampingStudy& s : study.clampings) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double unit = i < 2 ? kArcsec : 1e-3;
      const auto error = [&](const LiuCampaign& c) { return (c.clamping.found[i] - s.truth[i]) / unit; };
      table.rows.push_back({liu_unit_name(s.unit), kNames[i], i < 2 ? "arcsec" : "um", s.truth[i] / unit,
                            error(s.exact), error(s.noisy), error(s.tapered), s.noisy.clamping.uncertainty[i] / unit,
                            s.spread.steps.deviation[i] / unit, s.spread.steps.mean[i] / unit,
                            s.joint.uncertainty[i] / unit, s.spread.joint.deviation[i] / unit});
    }
  }
  table.notes = {fmt::format(
      "u axes exact: stated by step (c), which takes the axes for exact. Spread and mean: standard deviation and mean "
      "of found minus true in {} simulated campaigns with the noise of Table 2. Joint: one fit of both stages and the "
      "clamping to the same readings. From the readings of the independent program the axis of the cylinder is found "
      "to {:.0e} mm.",
      study.micrometres().spread.steps.campaigns, study.reference.difference)};
  return table;
}

ReproducedTable corrected_profiles(const LiuFigureStudy& study) {
  ReproducedTable table{"figure-9",
                        "Figure 9: sections of the cylinder over 23.5 mm as the evaluation sees them, shifts in um",
                        {{"case"},
                         {"lean of the centres", "deg", 4},
                         {"radius top minus bottom", "um", 3},
                         {"out of round", "um", 3},
                         {"largest deviation", "um", 3}},
                        {},
                        {}};
  for (const LiuProfile& p : study.corrected) {
    table.rows.push_back({p.words, p.lean / kDegree, 23.5e3 * p.growth, 1e3 * p.out_of_round, 1e3 * p.deviation});
  }
  table.notes = {
      "Centres that run off along the axis make an oblique cylinder, a radius that changes makes a frustum of a cone. "
      "Largest deviation of a point from the cylinder of 10 mm about y."};
  return table;
}

ReproducedTable section_values(const LiuFigureStudy& study) {
  ReproducedTable table{
      "figure-9-sections",
      "Figure 9: least-squares circles of the sections",
      {{"case"}, {"height", "mm", 2}, {"centre x", "um", 3}, {"centre z", "um", 3}, {"radius minus 10 mm", "um", 3}},
      {},
      {}};
  for (const LiuProfile& p : study.corrected) {
    for (const LiuSection& s : p.sections) {
      table.rows.push_back({p.words, s.height, 1e3 * s.x, 1e3 * s.z, 1e3 * (s.radius - kLiuRadius)});
    }
  }
  table.in_text = false;
  return table;
}

ReproducedTable repeat_table(const LiuFigureStudy& study) {
  ReproducedTable table{"figure-11b",
                        "Figure 11b: the standard cylinder measured four times along one path, calibrated machine, "
                        "noise of Table 2",
                        {{"standard"}},
                        {},
                        {}};
  add_columns(table, {"run 1", "run 2", "run 3", "run 4", "repeatability"}, "um");
  table.columns.push_back({"correlation of runs", "", 3});
  for (const LiuRepeats& r : study.repeats) {
    std::vector<ReproducedCell> row = {r.words};
    for (const double rms : r.rms) row.emplace_back(1e3 * rms);
    row.emplace_back(1e3 * r.repeatability);
    row.emplace_back(r.correlation);
    table.rows.push_back(std::move(row));
  }
  table.notes = {
      "Runs: root mean square distance from the least-squares cylinder. Repeatability: standard deviation at one "
      "place. The stages are calibrated with an exact cylinder, or with the tapered one where that is measured. Three "
      "lobes are an assumption: the paper states the cylindricity, not the form."};
  return table;
}

ReproducedTable repeat_values(const LiuFigureStudy& study) {
  ReproducedTable table{"figure-11b-points",
                        "Figure 11b: distance from the cylinder's axis less the radius",
                        {{"standard"}, {"height", "mm", 0}, {"position of C", "deg", 0}},
                        {},
                        {}};
  add_columns(table, {"run 1", "run 2", "run 3", "run 4"}, "um", 3);
  for (const LiuRepeats& r : study.repeats) {
    for (std::size_t k = 0; k < r.deviations[0].size(); ++k) {
      std::vector<ReproducedCell> row = {r.words, r.heights[k / LiuRepeats::kSteps],
                                         5.0 * static_cast<double>(k % LiuRepeats::kSteps)};
      for (const std::vector<double>& run : r.deviations) row.emplace_back(1e3 * run[k]);
      table.rows.push_back(std::move(row));
    }
  }
  table.in_text = false;
  return table;
}

}  // namespace

std::vector<ReproducedTable> liu_figure_tables(const LiuFigureStudy& study) {
  std::vector<ReproducedTable> tables = {clamping_table(study), left_over(study)};
  if (study.complete()) {
    for (const auto& make : {clamped_profiles, corrected_profiles, repeat_table, profile_points, place_values,
                             section_values, repeat_values}) {
      tables.push_back(make(study));
    }
  }
  return tables;
}

}  // namespace abbe
