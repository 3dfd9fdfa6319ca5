#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/formats/readings/indication_file.h"
#include "abbe/report/evaluations/machine_json.h"
#include "abbe/study/report/report_data.h"
#include "wang/integrated.h"
#include "wang/results.h"
#include "wang/tables.h"

namespace abbe {
namespace {

constexpr const char* kWangGridWords = "grid of 4 of the measured positions per axis, angles in degrees as printed";

std::string verdict_of(const std::vector<WangPopulationRow>& populations) {
  const SampleStatistics &degrees = populations[0].population.norm, &small = populations[2].population.norm;
  return fmt::format(
      "Integrated error |E| of equation (18) over all {} combinations of the measured positions: mean {:.0f} um, "
      "largest {:.0f} um with the angles in degrees as printed; mean {:.1f} um, largest {:.1f} um if they are "
      "millidegrees.",
      degrees.count, 1e3 * degrees.mean, 1e3 * degrees.maximum, 1e3 * small.mean, 1e3 * small.maximum);
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
                          {"quantity", "|E|"},
                          {"edges_um", edges},
                          {"before_counts", p.histogram.counts},
                          {"before_percentiles_um", {{"median", 1e3 * p.norm.median}, {"p95", 1e3 * p.norm.p95}}}});
  }
  return histograms;
}

/// Simulated indications of all six axes as files that --grids reads: {"X.csv", text}, ...
std::vector<std::pair<std::string, std::string>> indication_files(const WangDialStudy& study) {
  const Machine machine = wang_machine();
  std::vector<std::pair<std::string, std::string>> files;
  for (const WangDialAxis& axis : study.axes) {
    const IndicationTable table{machine.find_axis(kWangAxisNames[axis.table]), axis.readings};
    files.emplace_back(std::string(kWangAxisNames[axis.table]) + ".csv", indications_text(machine, table));
  }
  return files;
}

}  // namespace

nlohmann::json wang_page(const WangResults& r) {
  nlohmann::json page;
  page["machine"] = report_machine(wang_machine());
  page["summary"] = {{"format", "abbe-summary/1"},
                     {"machine", wang_machine().name},
                     {"chain", wang_machine().chain()},
                     {"verdict", verdict_of(r.populations)}};
  // Figures over the poses of the map stand in the table of populations: on the first screen they would be taken for
  // those of the verdict.
  page["map"] = wang_report_map(r.grid, kWangGridWords);
  page["histograms"] = histograms_of(r.populations);
  return page;
}

void write_wang_study(const WangResults& r, ResultsFolder& folder) {
  const Machine machine = wang_machine();
  const ErrorSet small = wang_errors({.angles = WangAngleUnit::millidegrees, .composition = {}});
  const DecoupledErrors& decoupled = r.dials.study.with_noise;
  const std::filesystem::path study = "study", maps = study / "maps", grids = study / "grids";
  folder.write(study / "wang-grinder.machine.toml", machine_text(machine));
  folder.write(
      study / "degrees.errors.toml",
      errors_text(machine,
                  {wang_errors({}), {}, {{"source", "Wang et al. (2020), Tables A1 to A6, degrees as printed"}}}));
  folder.write(
      study / "millidegrees.errors.toml",
      errors_text(machine,
                  {small, {}, {{"source", "Wang et al. (2020), Tables A1 to A6, angles read as millidegrees"}}}));
  const ErrorsFile contents{decoupled.errors, decoupled.covariance, {{"source", "simulated dial and laser readings"}}};
  folder.write(study / "decoupled.errors.toml", errors_text(machine, contents, "decoupled.covariance.csv"));
  folder.write(study / "decoupled.covariance.csv", covariance_text(machine, contents));
  const MapData degrees = wang_map_data(r.grid);
  folder.write(maps / "integrated-error-degrees.csv", map_csv(degrees));
  folder.write(maps / "integrated-error-degrees.vtu", map_vtk(degrees));
  folder.write(maps / "integrated-error-millidegrees.csv", map_csv(wang_map_data(wang_grid_map(small))));
  folder.write(maps / "integrated-error-decoupled.csv",
               map_csv(wang_map_data(wang_grid_map(decoupled.errors, &decoupled.covariance))));
  for (const auto& [name, text] : indication_files(r.dials.study)) folder.write(grids / name, text);
}

}  // namespace abbe
