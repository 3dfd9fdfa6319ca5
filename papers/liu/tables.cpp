#include <fmt/format.h>

#include <algorithm>

#include "abbe/geometry/angle_units.h"
#include "liu/results.h"

namespace abbe {
namespace {

std::optional<double> stated(double paper) { return paper > 0 ? std::optional<double>(paper) : std::nullopt; }

ReproducedTable closed_form_table(const LiuResults& r) {
  ReproducedTable table{"reference",
                        "Points from axis positions and indications against the reference (independent program)",
                        {{"evaluation"}, {"largest difference", "mm", 3}},
                        {{"closed form, perfect machine", r.reference[0]},
                         {"closed form, shifts of Table 3 in mm", r.reference[1]},
                         {"closed form, shifts of Table 3 in um", r.reference[2]},
                         {"recursion (8), (9) as worded", r.recursion[0]},
                         {"recursion with R_C R_A, A where C has brought it", r.recursion[1]}},
                        {}};
  table.notes = {fmt::format("The limit is {:.0e} mm; the recursion is compared with the closed form.", kLiuAgreement)};
  return table;
}

ReproducedTable group_table(const LiuSensitivity& s) {
  ReproducedTable table{"table-1",
                        "Table 1: share of the error terms, root mean square along the normal, cross cylinder",
                        {{"terms"},
                         {"paper", "%", 3},
                         {"stated ranges", "%", 3},
                         {"stated ranges registered", "%", 3},
                         {"sizes of Table 3", "%", 3},
                         {"sizes of Table 3 registered", "%", 3}},
                        {},
                        {}};
  for (const LiuGroup& g : s.groups) {
    table.rows.push_back({g.name, g.paper, g.stated, g.stated_remaining, g.as_found, g.as_found_remaining});
  }
  table.notes = {"Registered: after the best motion of the whole part is taken out, and all clamping errors with it."};
  return table;
}

ReproducedTable term_table(const LiuSensitivity& s) {
  ReproducedTable table{"terms",
                        "Change along the normal per unit of every error term, root mean square, cross cylinder",
                        {{"term"}, {"unit"}, {"change", "", 3}, {"change registered", "", 3}},
                        {},
                        {}};
  for (const LiuTerm& t : s.terms) {
    table.rows.push_back({t.name, t.is_angle ? "um/mrad" : "um/um", t.across, t.remaining});
  }
  return table;
}

/// "3 rotary, 2 raster"
std::string path_words(const ScanPlan& plan) {
  std::string words;
  for (const ScanPathKind kind : {ScanPathKind::rotary, ScanPathKind::raster, ScanPathKind::free}) {
    std::size_t faces = 0;
    for (const PlannedFace& face : plan.faces) faces += face.kind == kind && face.area > 0 ? 1U : 0U;
    if (faces == 0) continue;
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", faces, scan_path_name(kind));
  }
  return words;
}

/// "hidden 1.2 %, collision 0.3 %", of the area that is wanted
std::string uncovered_words(const ScanPlan& plan) {
  std::string words;
  for (std::size_t k = 1; k < kScanObstacleCount; ++k) {
    double area = 0;
    for (const PlannedFace& face : plan.faces) area += face.uncovered[k];
    if (!(area > 5e-5 * plan.area())) continue;
    words += fmt::format("{}{} {:.2f} %", words.empty() ? "" : ", ", scan_obstacle_name(static_cast<ScanObstacle>(k)),
                         100 * area / plan.area());
  }
  return words;
}

ReproducedTable path_table(const LiuResults& r) {
  ReproducedTable table{"paths",
                        "Paths, planned on the models where the calibrated clamping holds them",
                        {{"part"},
                         {"faces"},
                         {"points", "", 0},
                         {"time", "s", 0},
                         {"covered", "%", 2},
                         {"largest angle", "deg", 1},
                         {"not covered"}},
                        {},
                        {}};
  for (const LiuMeasuredPart& p : r.units.back().parts) {
    double angle = 0;
    for (const PlannedFace& face : p.plan.faces) angle = std::max(angle, face.largest_angle);
    table.rows.push_back({p.model.name, path_words(p.plan), p.plan.points(), p.plan.time, 100 * p.plan.covered_share(),
                          angle / kDegree, uncovered_words(p.plan)});
  }
  table.notes = {
      "Tilted by 5.7 and 2.3 degrees; points and lines 1 mm apart; probe 10 mm in diameter at 10 mm, table of 30 mm "
      "and a stalk of 2.5 mm below the part. The paper does not give the dimensions of its parts."};
  return table;
}

ReproducedTable measured_table(const LiuResults& r) {
  ReproducedTable table{"parts",
                        "Virtual measurement: deviation from the model after registration, root mean square (16)",
                        {{"shifts"},
                         {"part"},
                         {"planned", "", 0},
                         {"points", "", 0},
                         {"paper before", "um"},
                         {"before", "um"},
                         {"paper after", "um"},
                         {"after", "um"},
                         {"largest after", "um"}},
                        {},
                        {}};
  for (const LiuUnitResults& results : r.units) {
    for (const LiuMeasuredPart& p : results.parts) {
      const LiuMeasurement& m = p.measurement;
      table.rows.push_back({liu_unit_name(results.unit), m.part, m.planned, m.after.points, stated(p.paper_before),
                            1e3 * m.before.rms, stated(p.paper_after), 1e3 * m.after.rms, 1e3 * m.after.largest});
    }
  }
  table.notes = {
      "Noise of Table 2 (axes 1 um and 0.004 degrees, probe 0.1 um), standard cylinder with 14 um of taper; the shifts "
      "of Table 3 are read in mm and in um."};
  return table;
}

std::vector<ReproducedCell> axes_cells(const LiuCalibration& c) {
  return {c.direction[0] / kArcsec, 1e3 * c.distance[0], c.direction[1] / kArcsec, 1e3 * c.distance[1]};
}

ReproducedTable standard_table(const LiuResults& r) {
  ReproducedTable table{"standards",
                        "What the calibration cylinder decides, shifts in um: deviations after registration, and how "
                        "far the axes found are beside the true ones",
                        {{"calibrated with"},
                         {"cylinder", "um"},
                         {"sphere 25 %", "um"},
                         {"50 %", "um"},
                         {"70 %", "um"},
                         {"radius 70 %", "mm", 4},
                         {"A", "arcsec", 1},
                         {"A", "um", 2},
                         {"C", "arcsec", 1},
                         {"C", "um", 2}},
                        {},
                        {}};
  for (const LiuVariant& v : r.variants) {
    std::vector<ReproducedCell> row = {v.words,
                                       1e3 * v.cylinder.after.rms,
                                       1e3 * v.spheres[0].after.rms,
                                       1e3 * v.spheres[1].after.rms,
                                       1e3 * v.spheres[2].after.rms,
                                       v.spheres[2].after.fitted_radius};
    for (ReproducedCell& cell : axes_cells(v.calibration)) row.push_back(std::move(cell));
    table.rows.push_back(std::move(row));
  }
  table.rows.push_back({"paper", 12.42, 9.60, ReproducedCell(), 29.07, 12.682, ReproducedCell(), ReproducedCell(),
                        ReproducedCell(), ReproducedCell()});
  table.notes = {"Paper, 50 %: 26.51 um by the CMM, fitted radius 12.693 mm against 12.703 mm."};
  return table;
}

}  // namespace

std::vector<ReproducedTable> liu_tables(const LiuResults& r) {
  std::vector<ReproducedTable> tables = {closed_form_table(r), group_table(r.sensitivity), term_table(r.sensitivity)};
  for (ReproducedTable& table : liu_figure_tables(r.figures)) tables.push_back(std::move(table));
  tables.push_back(path_table(r));
  tables.push_back(measured_table(r));
  tables.push_back(standard_table(r));
  return tables;
}

}  // namespace abbe
