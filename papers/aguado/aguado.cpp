#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "aguado/study.h"
#include "aguado/tables.h"
#include "papers.h"
#include "progress.h"
#include "reproduce_output.h"

namespace abbe {
namespace {

// Noise-free readings are rounded to 1e-9 m in the files; the weights are then all equal.
const TrackerNoise kAguadoExact = TrackerNoise::isotropic(1, 0);

/// Reference readings with known truth, and what an independent program found from them.
struct AguadoReference {
  std::string name;
  AguadoFit fit;
  AguadoTruth::Expected expected;

  bool has_noise() const { return name.find("noiseLT") != std::string::npos; }
  bool agrees() const {
    const auto within = [](double ours, double reference) { return std::abs(ours - reference) <= 0.1 * reference; };
    if (fit.identification.status != IdentifyStatus::converged) return false;
    const double residual = 1e3 * fit.residual.mean, unseen = 1e3 * fit.unseen.mean;
    return has_noise() ? within(residual, expected.residual_mean) && within(unseen, expected.validation_mean)
                       : residual < 0.001 && unseen < 0.001;
  }
};

std::vector<AguadoReference> fit_reference(const AguadoTruth& truth, int threads) {
  std::vector<AguadoReference> found;
  for (const char* name : {"500_noise0", "500_noiseLT", "5000_noise0", "5000_noiseLT"}) {
    AguadoReference reference{name, {}, truth.expected(std::string("n") + name)};
    reference.fit = fit_aguado(truth, read_aguado_readings(name), reference.has_noise() ? aguado_noise() : kAguadoExact,
                               {}, Strategy::joint, threads);
    found.push_back(std::move(reference));
  }
  return found;
}

ReproducedTable reference_table(const std::vector<AguadoReference>& references) {
  ReproducedTable table{
      "reference",
      "Reference readings with known truth; order 4 of X and Z, 4 harmonics of C, pose of the tracker found",
      {{"readings"},
       {"before", "um"},
       {"residual", "um", 5},
       {"residual expected", "um", 5},
       {"unseen poses", "um", 5},
       {"unseen expected", "um", 5},
       {"rank", "", 0},
       {"parameters", "", 0}},
      {},
      {"Mean distances. Unseen: identified against true at 2,000 random poses with offsets that were not measured. "
       "Expected: by an independent program; agreement means 10 %, and 0.001 um without noise."}};
  for (const AguadoReference& reference : references) {
    const AguadoFit& fit = reference.fit;
    table.rows.push_back({reference.name, 1e3 * fit.initial.mean, 1e3 * fit.residual.mean,
                          reference.expected.residual_mean, 1e3 * fit.unseen.mean, reference.expected.validation_mean,
                          fit.identification.gauge.rank_at_start, fit.identification.parameters.size()});
  }
  return table;
}

nlohmann::ordered_json reference_json(const std::vector<AguadoReference>& references) {
  nlohmann::ordered_json json;
  for (const AguadoReference& row : references) {
    json["reference"][row.name] = {{"status", status_text(row.fit.identification.status)},
                                   {"initial_mean_um", 1e3 * row.fit.initial.mean},
                                   {"residual_mean_um", 1e3 * row.fit.residual.mean},
                                   {"unseen_mean_um", 1e3 * row.fit.unseen.mean},
                                   {"unseen_max_um", 1e3 * row.fit.unseen.maximum},
                                   {"expected_residual_mean_um", row.expected.residual_mean},
                                   {"expected_validation_mean_um", row.expected.validation_mean},
                                   {"parameters", row.fit.identification.parameters.size()},
                                   {"rank", row.fit.identification.gauge.rank_at_start}};
  }
  return json;
}

ReproducedTable workspace_table(const AguadoFigures& figures) {
  ReproducedTable table{"figure-6",
                        "Figure 6: volumetric error at 2,000 poses of the whole workspace",
                        {{""}, {"mean", "um"}, {"median", "um"}, {"95 %", "um"}, {"largest", "um"}},
                        {},
                        {}};
  table.columns[0].name = "machine";
  const auto add = [&](const char* name, const SampleStatistics& s) {
    table.rows.push_back({name, 1e3 * s.mean, 1e3 * s.median, 1e3 * s.p95, 1e3 * s.maximum});
  };
  add("uncompensated", figures.before);
  add("compensated, order 3, C by (15) as printed", figures.as_paper);
  add("compensated, order 4, 4 harmonics and a constant", figures.complete);
  return table;
}

Reproduction aguado_reproduction(int threads) {
  const AguadoTruth truth = read_aguado_truth();
  Progress progress("identifying the reference readings");
  const std::vector<AguadoReference> references = fit_reference(truth, threads);
  progress(1, 3);
  const std::vector<AguadoRow> rows = aguado_rows(truth, threads);
  progress(2, 3);
  const AguadoFigures figures = aguado_figures(truth, rows);

  Reproduction made;
  made.paper = "aguado";
  made.citation = "Aguado, Santolaria, Samper, Aguilar (2014)";
  made.title = "Geometric errors of a machine by a laser tracker: strategies of identification";
  made.facts = {{"machine", aguado_machine().chain() + ", X 0..1400 mm, Z 0..600 mm, C one turn"}};
  made.agrees = true;
  for (const AguadoReference& reference : references) made.agrees = *made.agrees && reference.agrees();
  made.tables = {reference_table(references)};
  for (ReproducedTable& table : aguado_tables(rows, truth.errors)) made.tables.push_back(std::move(table));
  made.tables.push_back(workspace_table(figures));
  made.published = aguado_published(rows);
  made.figures = figures.plots;
  made.conclusions = aguado_conclusions(rows);
  made.corrections = {
      "(3) holds with passive rotations only, that is with the transposes of (5); exact rotations are used.",
      "(7) ECX means EYX; (8) is (EXC, EYC, EZC); (9) lacks the squareness of C.",
      "(11) needs +R_LTx in row 2, column 3, and a full rotation: one degree in small-angle form costs 213 um at "
      "1.4 m.",
      "(15) with one shared period is a single sinusoid without a constant; a constant and harmonics are used.",
      "Table 2: 122.38/598.48 = 20.45 %, printed as 21.01. Table 3: the unit of the residual error is %, not um."};
  made.details = reference_json(references);
  const AguadoFit& joint = references[3].fit;
  const ErrorSet identified = joint.identification.errors;
  made.write_study = [truth, identified](ResultsFolder& folder) {
    const Machine machine = aguado_machine();
    folder.write("study/aguado.machine.toml", machine_text(machine));
    folder.write("study/true.errors.toml",
                 errors_text(machine, {truth.errors, {}, {{"source", "known errors of the reference readings"}}}));
    folder.write("study/identified.errors.toml",
                 errors_text(machine, {identified, {}, {{"source", "5,000 reference readings with noise, jointly"}}}));
  };
  return made;
}

}  // namespace

int reproduce_aguado(const ReproduceOptions& options) {
  return run_reproduction(options, [&] { return aguado_reproduction(options.threads); });
}

}  // namespace abbe
