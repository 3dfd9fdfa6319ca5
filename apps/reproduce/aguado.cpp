#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "abbe/instruments/measurement_plan.h"
#include "exit_code.h"
#include "progress.h"
#include "reproduce/aguado_study.h"
#include "reproduce/reproduce.h"

namespace abbe {
namespace {

const TrackerNoise kTracker = TrackerNoise::isotropic(10, 5);
// Noise-free readings are rounded to 1e-9 m in the files; the weights are then all equal.
const TrackerNoise kExact = TrackerNoise::isotropic(1, 0);

struct GoldenRow {
  std::string name;
  AguadoFit fit;
  AguadoTruth::Expected expected;
};

/// A strategy of section 4 on simulated readings of the same machine.
struct StrategyRow {
  std::string name, published, note;
  AguadoFit fit;
};

TrackerReadings simulate(const AguadoTruth& truth, const PoseList& poses, const TrackerNoise& noise,
                         std::size_t reflectors, std::uint64_t seed) {
  TrackerSetup setup = truth.setup;
  setup.stations[0].noise = noise;
  TrackerSimulationOptions options;
  options.seed = seed;
  for (std::size_t i = 0; i < reflectors; ++i) options.sights.push_back({0, static_cast<std::uint16_t>(i)});
  return simulate_tracker(aguado_machine(), truth.errors, setup, poses, options).readings;
}

PoseList linear_grid(double c, std::size_t count) {
  return grid_plan(aguado_machine(), {AxisRange::fixed(c), {0, 1400, count, 0}, {0, 600, count, 0}});
}

/// One point of X and Z at C from 0 to 355 degrees in steps of 5 degrees, as the paper's Table 1.
PoseList rotary_circle(double x, double z) {
  const double step = 5 * std::numbers::pi / 180;
  return grid_plan(aguado_machine(), {{0, 71 * step, 72, 0}, AxisRange::fixed(x), AxisRange::fixed(z)});
}

std::vector<StrategyRow> strategies(const AguadoTruth& truth, int threads) {
  const Machine machine = aguado_machine();
  const PoseList random = random_plan(machine, full_ranges(machine, 2), 1000, 11);
  std::vector<StrategyRow> rows;
  const auto run = [&](std::string name, std::string published, std::string note, const PoseList& poses,
                       const TrackerNoise& noise, std::size_t reflectors, const AguadoOrders& orders,
                       Strategy strategy) {
    rows.push_back({std::move(name), std::move(published), std::move(note),
                    fit_aguado(truth, simulate(truth, poses, noise, reflectors, rows.size() + 1), noise, orders,
                               strategy, threads)});
  };
  const AguadoOrders full;
  AguadoOrders few{.x = 1, .z = 1, .c = 4}, three{.x = 3, .z = 3, .c = 4};
  run("joint, orders (4, 4), 4 harmonics", "20.53", "Table 3", random, kTracker, 3, full, Strategy::joint);
  run("joint, orders (1, 1)", "20.53", "too few coefficients", random, kTracker, 3, few, Strategy::joint);
  run("joint, orders (3, 3)", "20.53", "too few coefficients", random, kTracker, 3, three, Strategy::joint);

  // Table 2: linear axes alone, a grid at C = 0; the rotary axis then carries no error motion.
  AguadoOrders linear = full, linear_few = few, linear_three = three;
  linear.rotary = linear_few.rotary = linear_three.rotary = false;
  run("linear axes only, orders (4, 4)", "20.45", "Table 2: 122.38/598.48, printed as 21.01", linear_grid(0, 15),
      kTracker, 3, linear, Strategy::joint);
  run("linear axes only, orders (1, 1)", "20.45", "too few coefficients", linear_grid(0, 15), kTracker, 3, linear_few,
      Strategy::joint);
  run("linear axes only, orders (3, 3)", "20.45", "too few coefficients", linear_grid(0, 15), kTracker, 3, linear_three,
      Strategy::joint);

  // Table 1: the rotary axis alone, two reflectors, 5 degree steps; (15) collapses to one sinusoid without a constant.
  AguadoOrders rotary = full, paper = full;
  rotary.linear = paper.linear = false;
  paper.c = 1;
  paper.constant_of_c = false;
  paper.estimate_pose = false;
  run("rotary axis only, 4 harmonics and constant", "57.75", "Table 1", rotary_circle(700, 300), kTracker, 2, rotary,
      Strategy::joint);
  run("rotary axis only, (15) as printed", "57.75", "one sinusoid, no constant, pose held", rotary_circle(700, 300),
      kTracker, 2, paper, Strategy::joint);

  // Section 4, strategies 2 and 3.
  const PoseList independent = join(linear_grid(0, 15), rotary_circle(700, 300));
  run("independent: linear at C = 0, then rotary", "-", "section 4, strategy 2", independent, kTracker, 3, full,
      Strategy::independent);
  const PoseList combined = join(linear_grid(0, 15), random);
  run("combined: linear at C = 0, then all C", "-", "section 4, strategy 3", combined, kTracker, 3, full,
      Strategy::combined);
  return rows;
}

bool within(double ours, double reference, double share) { return std::abs(ours - reference) <= share * reference; }

}  // namespace

int reproduce_aguado(const ReproduceOptions& options) {
  const AguadoTruth truth = read_aguado_truth();
  std::vector<GoldenRow> golden;
  std::vector<StrategyRow> compared;
  {
    Progress progress("identifying the reference readings");
    for (const char* name : {"500_noise0", "500_noiseLT", "5000_noise0", "5000_noiseLT"}) {
      const std::string text = name;
      const TrackerNoise& noise = text.find("noise0") != std::string::npos ? kExact : kTracker;
      golden.push_back({text,
                        fit_aguado(truth, read_aguado_readings(text), noise, {}, Strategy::joint, options.threads),
                        truth.expected("n" + text)});
      progress(golden.size(), 5);
    }
    compared = strategies(truth, options.threads);
  }
  bool agrees = true;
  for (const GoldenRow& row : golden) {
    const bool noisy = row.name.find("noiseLT") != std::string::npos;
    agrees = agrees && row.fit.identification.status == IdentifyStatus::converged &&
             (noisy ? within(1e3 * row.fit.residual.mean, row.expected.residual_mean, 0.1) &&
                          within(1e3 * row.fit.unseen.mean, row.expected.validation_mean, 0.1)
                    : 1e3 * row.fit.residual.mean < 0.001 && 1e3 * row.fit.unseen.mean < 0.001);
  }

  nlohmann::ordered_json json;
  json["agrees_with_reference"] = agrees;
  for (const GoldenRow& row : golden) {
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
  for (const StrategyRow& row : compared) {
    json["strategies"].push_back({{"name", row.name},
                                  {"status", status_text(row.fit.identification.status)},
                                  {"percent_left", 100 * row.fit.residual.mean / row.fit.initial.mean},
                                  {"published_percent_left", row.published},
                                  {"unseen_percent_left", 100 * row.fit.unseen.mean / row.fit.unseen_before.mean},
                                  {"unseen_mean_um", 1e3 * row.fit.unseen.mean},
                                  {"note", row.note}});
  }
  if (!options.output.empty()) {
    ResultsFolder folder(options.output);
    folder.write("summary.json", json_text(json));
    folder.commit();
  }
  if (options.json) {
    fmt::print("{}", json_text(json));
    return agrees ? kDone : kNegative;
  }

  fmt::print("Aguado, Santolaria, Samper, Aguilar (2014), machine {}\n", aguado_machine().chain());
  fmt::print(
      "reference readings with known truth; orders X 4, Z 4, C 4 harmonics, pose of the tracker found from the "
      "data\n\n");
  fmt::print("  {:<14} {:>12} {:>12} {:>12} {:>14} {:>12} {:>9}\n", "readings", "before / um", "residual", "reference",
             "unseen poses", "reference", "rank");
  for (const GoldenRow& row : golden) {
    fmt::print("  {:<14} {:>12.2f} {:>12.5f} {:>12.5f} {:>14.5f} {:>12.5f} {:>5}/{:<3}\n", row.name,
               1e3 * row.fit.initial.mean, 1e3 * row.fit.residual.mean, row.expected.residual_mean,
               1e3 * row.fit.unseen.mean, row.expected.validation_mean, row.fit.identification.gauge.rank_at_start,
               row.fit.identification.parameters.size());
  }
  fmt::print(
      "  mean distances; unseen: identified against true at 2,000 random poses with offsets that were not measured\n");
  fmt::print("  agreement (10 %, and 0.001 um without noise): {}\n\n", agrees ? "yes" : "NO");

  fmt::print("The paper's strategies on this machine, tracker 10 um + 5 um/m: percent of the mean error left\n\n");
  fmt::print("  {:<46} {:>9} {:>9} {:>14}   {}\n", "", "paper", "here", "unseen poses", "");
  for (const StrategyRow& row : compared) {
    fmt::print("  {:<46} {:>9} {:>9.2f} {:>14.2f}   {}\n", row.name, row.published,
               100 * row.fit.residual.mean / row.fit.initial.mean,
               100 * row.fit.unseen.mean / row.fit.unseen_before.mean, row.note);
  }
  fmt::print(
      "\nWhy\n"
      "  The 20 % of Tables 2 and 3 is what too few coefficients leave; the measurement's noise leaves about 4 %.\n"
      "  The 57.75 % of Table 1 comes from (15): with one shared period it is a single sinusoid without constant "
      "term.\n"
      "  Table 2's 21.01 % is 122.38/598.48 = 20.45 %; the unit of Table 3's last line is %, not um.\n"
      "  A fit of the linear axes alone, or of the rotary axis alone, is right where it was measured and wrong "
      "elsewhere\n"
      "  (last column): validate at unseen poses and offsets.\n"
      "  Corrected: (3) needs transposes, (7) ECX means EYX, (8) is (EXC, EYC, EZC), (11) needs +R_LTx and a full "
      "rotation.\n");
  return agrees ? kDone : kNegative;
}

}  // namespace abbe
