#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/formats/errors_file.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/map_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/report/report.h"
#include "reproduce/wang_integrated.h"
#include "reproduce/wang_results.h"
#include "study/report_data.h"
#include "study/summary.h"

namespace abbe {

namespace {

constexpr const char* kWangGridWords =
    "|E| of equation (18), grid of 4 of the measured positions per axis, angles in degrees as printed";

std::string verdict_of(const std::vector<WangPopulationRow>& populations) {
  const SampleStatistics &degrees = populations[0].population.norm, &small = populations[2].population.norm;
  return fmt::format(
      "Integrated error |E| of equation (18) over all {} combinations of the measured positions: mean {:.0f} um, "
      "largest {:.0f} um with the angles in degrees as printed; mean {:.1f} um, largest {:.1f} um if they are "
      "millidegrees.",
      degrees.count, 1e3 * degrees.mean, 1e3 * degrees.maximum, 1e3 * small.mean, 1e3 * small.maximum);
}

nlohmann::ordered_json population_table(const std::vector<WangPopulationRow>& populations,
                                        const SampleStatistics& grid) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const WangPopulationRow& row : populations) {
    const SampleStatistics& s = row.population.norm;
    rows.push_back({row.name, s.count, 1e3 * s.mean, 1e3 * s.p95, 1e3 * s.maximum});
  }
  rows.push_back({"poses of the map: 4^6 of the 11^6, degrees as printed", grid.count, 1e3 * grid.mean, 1e3 * grid.p95,
                  1e3 * grid.maximum});
  return {
      {"title", "Integrated error |E| of equation (18) / um"},
      {"columns", {"", "poses", "mean", "95 %", "largest"}},
      {"rows", rows},
      {"note", "Share of angle and displacement errors: compare the rows with angles only and displacements only."}};
}

nlohmann::ordered_json points_table(const std::vector<WangPoints>& points) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  rows.push_back({"paper, Figure 14", "complete", "", 1000, ""});
  rows.push_back({"paper, Figure 15", "displacements only", "", 100, ""});
  for (const WangPoints& set : points) {
    const auto add = [&](const char* reading, const SampleStatistics& s) {
      rows.push_back({set.words, reading, 1e3 * s.minimum, 1e3 * s.mean, 1e3 * s.maximum});
    };
    add("degrees as printed", set.degrees.statistics);
    add("millidegrees", set.millidegrees.statistics);
    add("displacements only", set.no_angles.statistics);
  }
  return {{"title", "Figures 13 and 14: |E| at 36 machining points / um"},
          {"columns", {"points", "angles", "smallest", "mean", "largest"}},
          {"rows", rows},
          {"note",
           "The paper shows the points in a picture without coordinates; these are three readings of it. "
           "machining_points.csv, figure_13.svg and figure_14_*.svg hold the points and E at each of them."}};
}

nlohmann::ordered_json conclusions_table(const WangConclusions& conclusions) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  // The verdict before the long text, which a narrow page cuts off.
  for (const auto& row : wang_conclusion_rows(conclusions)) rows.push_back({row[0], row[1], row[3], row[2]});
  return {{"title", "Conclusions of the paper beside the tables"},
          {"columns", {"claim", "paper", "holds", "here"}},
          {"rows", rows}};
}

nlohmann::ordered_json histograms_of(const std::vector<WangPopulationRow>& populations) {
  nlohmann::ordered_json histograms = nlohmann::ordered_json::array();
  for (const WangPopulationRow& row : populations) {
    const WangPopulation& p = row.population;
    if (!row.reading.displacements || row.reading.angles == WangAngleUnit::none) continue;
    std::vector<double> edges;
    for (std::size_t i = 0; i <= p.histogram.counts.size(); ++i) {
      edges.push_back(for_drawing(1e3 * (p.histogram.from + p.histogram.width * static_cast<double>(i))));
    }
    histograms.push_back({{"title", "|E| of equation (18), " + row.name},
                          {"edges_um", edges},
                          {"before_counts", p.histogram.counts},
                          {"before_percentiles_um", {{"median", 1e3 * p.norm.median}, {"p95", 1e3 * p.norm.p95}}}});
  }
  return histograms;
}

nlohmann::ordered_json page_of(const WangResults& r, const WangMap& map, const nlohmann::ordered_json& summary) {
  nlohmann::ordered_json data;
  data["format"] = "abbe-report/1";
  data["title"] = "Integrated error of a gear grinder (Wang et al. 2020, Tables A1 to A6)";
  data["generator"] = "abbe " ABBE_VERSION;
  data["machine"] = report_machine(wang_machine());
  data["summary"] = summary;
  data["map"] = wang_report_map(map, kWangGridWords);
  data["histograms"] = histograms_of(r.populations);
  data["tables"] = {population_table(r.populations, map.statistics), points_table(r.points),
                    conclusions_table(r.conclusions)};
  data["assumptions"] = {
      "Integrated error: E = (W_actual - T_actual) - (W_nominal - T_nominal), equation (18), machine frame, with "
      "T_B in (13) and (16) and the matrices of the tables' row i, not those printed in (36) to (43).",
      "Order of errors against the motion: iso (the paper leaves it open; the zero pose does not depend on it).",
      "Tables A1 to A6 as printed; the 12th column is the cut-off mean of the others, not a measurement.",
      "Angles in degrees as printed; probably a factor 1000 too large (inferred, not proven)."};
  data["references"] = {"Wang, Ran, Zhang and Li (2020), Applied Sciences 10, 2164"};
  return data;
}

}  // namespace

void write_wang_folder(const WangResults& r, const std::filesystem::path& output) {
  const Machine machine = wang_machine();
  const ErrorSet errors = wang_errors({});
  const ErrorSet small = wang_errors({.angles = WangAngleUnit::millidegrees, .composition = {}});
  const DecoupledErrors& decoupled = r.dials.study.with_noise;
  const WangMap map = wang_grid_map(errors);

  nlohmann::ordered_json summary;
  summary["format"] = "abbe-summary/1";
  summary["study"] = "Wang et al. (2020)";
  summary["machine"] = machine.name;
  summary["chain"] = machine.chain();
  summary["verdict"] = verdict_of(r.populations);
  summary["map"] = {{"poses", map.norm.size()},
                    {"description", kWangGridWords},
                    {"reference", "model"},
                    {"position_before_um", statistics_um(map.statistics)}};
  summary["figures"] = wang_json(r);

  ResultsFolder folder(output);
  folder.write("machine.machine.toml", machine_text(machine));
  folder.write(
      "errors.toml",
      errors_text(machine, {errors, {}, {{"source", "Wang et al. (2020), Tables A1 to A6, degrees as printed"}}}));
  folder.write(
      "errors_millidegrees.toml",
      errors_text(machine,
                  {small, {}, {{"source", "Wang et al. (2020), Tables A1 to A6, angles read as millidegrees"}}}));
  const MapData map_file = wang_map_data(map);
  folder.write("maps/integrated_error_degrees.csv", map_csv(map_file));
  folder.write("maps/integrated_error_degrees.vtu", map_vtk(map_file));
  folder.write("maps/integrated_error_millidegrees.csv", map_csv(wang_map_data(wang_grid_map(small))));
  folder.write("maps/integrated_error_decoupled.csv",
               map_csv(wang_map_data(wang_grid_map(decoupled.errors, &decoupled.covariance))));
  const ErrorsFile contents{decoupled.errors, decoupled.covariance, {{"source", "simulated dial and laser readings"}}};
  folder.write("decoupled.errors.toml", errors_text(machine, contents, "decoupled.covariance.csv"));
  folder.write("decoupled.covariance.csv", covariance_text(machine, contents));
  for (const auto& [name, text] : wang_point_files(r.points)) folder.write(name, text);
  for (const auto& [name, text] : wang_indication_files(r.dials.study)) folder.write("grids/" + name, text);
  for (const auto& [name, text] : wang_ball_bar_files(r.dials.study)) folder.write("ball_bar/" + name, text);
  folder.write("summary.json", json_text(summary));
  folder.write("report.html", report_page(nlohmann::json(page_of(r, map, summary))));
  folder.commit();
}

}  // namespace abbe
