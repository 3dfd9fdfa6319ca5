#include "aguado/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/measurement_plan.h"

namespace abbe {
namespace {

TrackerReadings aguado_readings(const AguadoTruth& truth, const PoseList& poses, std::size_t reflectors,
                                std::uint64_t seed) {
  TrackerSetup setup = truth.setup;
  setup.stations[0].noise = aguado_noise();
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
  constexpr double kStep = 5 * kDegree;
  return grid_plan(aguado_machine(), {{0, 71 * kStep, 72, 0}, AxisRange::fixed(x), AxisRange::fixed(z)});
}

/// Fits models to readings; every experiment has its own noise, all models of one experiment the same readings.
class AguadoRunner {
 public:
  AguadoRunner(const AguadoTruth& truth, int threads) : truth_(truth), threads_(threads) {}

  void measure(AguadoExperiment experiment, const PoseList& poses, std::size_t reflectors) {
    experiment_ = experiment;
    readings_ = aguado_readings(truth_, poses, reflectors, ++seed_);
  }
  AguadoRow& fit(std::string model, const AguadoOrders& orders, Strategy strategy = Strategy::joint) {
    AguadoRow row;
    row.experiment = experiment_;
    row.model = std::move(model);
    row.constant = orders.constant_of_c;
    row.fit = fit_aguado(truth_, readings_, aguado_noise(), orders, strategy, threads_);
    rows.push_back(std::move(row));
    return rows.back();
  }

  std::vector<AguadoRow> rows;

 private:
  const AguadoTruth& truth_;
  int threads_;
  std::uint64_t seed_ = 0;
  AguadoExperiment experiment_ = AguadoExperiment::table_1;
  TrackerReadings readings_;
};

void fit_rotary_axis(AguadoRunner& run) {
  run.measure(AguadoExperiment::table_1, rotary_circle(700, 300), 2);
  const AguadoOrders rotary{.linear = false};
  const auto with = [&](int harmonics, bool constant, bool pose) {
    AguadoOrders orders = rotary;
    orders.c = harmonics;
    orders.constant_of_c = constant;
    orders.estimate_pose = pose;
    return orders;
  };
  run.fit("(15) as printed: one sinusoid, no constant", with(1, false, false)).as_paper = true;
  run.fit("(15) as printed, pose of the tracker found", with(1, false, true));
  run.fit("one sinusoid and a constant", with(1, true, false));
  run.fit("4 harmonics, no constant", with(4, false, false));
  run.fit("4 harmonics and a constant", with(4, true, false));
  run.fit("4 harmonics and a constant, pose found", with(4, true, true));
}

void fit_linear_axes(AguadoRunner& run) {
  run.measure(AguadoExperiment::table_2, linear_grid(0, 15), 3);
  for (const int order : {1, 2, 3, 4}) {
    AguadoRow& row = run.fit(fmt::format("polynomials of order {}", order), {.x = order, .z = order, .rotary = false});
    row.order = order;
    row.as_paper = order == 3;
  }
}

void fit_jointly(AguadoRunner& run, const PoseList& poses) {
  run.measure(AguadoExperiment::table_3, poses, 3);
  AguadoRow& printed = run.fit("order 3, C by (15) as printed", {.x = 3, .z = 3, .c = 1, .constant_of_c = false});
  printed.as_paper = true;
  for (const int order : {1, 2, 3, 4}) {
    run.fit(fmt::format("order {}, C by 4 harmonics and a constant", order), {.x = order, .z = order}).order = order;
  }
}

const AguadoPublished* published_of(AguadoExperiment experiment) {
  return experiment == AguadoExperiment::strategy ? nullptr : &kAguadoPublished[static_cast<std::size_t>(experiment)];
}

std::vector<ReproducedCell> paper_row(const AguadoPublished& paper) {
  return {
      "paper", paper.initial_mean, paper.initial_largest, paper.final_mean, paper.final_largest, paper.percent, {}, {},
      {}};
}

/// Largest coefficient of the angular error motions of C, rad.
double largest_angle(const ErrorSet& errors) {
  const std::size_t c = aguado_machine().find_axis("C");
  double angle = 0;
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis != c || !is_rotation(motion.component)) continue;
    for (const double coefficient : motion.coefficients) angle = std::max(angle, std::abs(coefficient));
  }
  return angle;
}

/// What fits with angles far beyond those of the machine are worth; empty if there are none.
std::string far_angle_words(const std::vector<AguadoRow>& rows, const ErrorSet& truth) {
  constexpr double kFarBeyond = 50;
  const double of_machine = largest_angle(truth);
  double least_misfit = std::numeric_limits<double>::infinity();
  std::size_t fits = 0;
  for (const AguadoRow& row : rows) {
    if (row.experiment != AguadoExperiment::table_1) continue;
    if (largest_angle(row.fit.identification.errors) <= kFarBeyond * of_machine) continue;
    ++fits;
    least_misfit = std::min(least_misfit, row.fit.residual.mean);
  }
  if (fits == 0) return "";
  return fmt::format(
      "{} of these models find{} angles of more than {:.0f} times the largest of the machine's C ({:.3f} mrad) and "
      "misfit{} by {:.0f} um or more on average. Where the misfit is far above the noise of the tracker, the model "
      "lacks terms: the open combinations then lower the residual at second order, and the least-squares solution goes "
      "to large angles. It minimises the sum of squares but is not a property of the machine.",
      fits, fits == 1 ? "s" : "", kFarBeyond, 1e3 * of_machine, fits == 1 ? "s" : "", 1e3 * least_misfit);
}

ReproducedTable aguado_rank_table(const std::vector<AguadoRow>& rows, const ErrorSet& truth) {
  ReproducedTable table{"table-1-rank",
                        "What the readings of Table 1 determine",
                        {{"model"},
                         {"parameters", "", 0},
                         {"determined", "", 0},
                         {"rotations about the line", "", 0},
                         {"shared with the pose", "", 0},
                         {"largest angle found", "mrad", 2}},
                        {},
                        {}};
  for (const AguadoRow& row : rows) {
    if (row.experiment != AguadoExperiment::table_1) continue;
    const Identification& found = row.fit.identification;
    table.rows.push_back({row.model, found.parameters.size(), row.fit.rank, row.fit.open_alone,
                          row.fit.shared_with_pose(), 1e3 * largest_angle(found.errors)});
  }
  table.notes = {
      "Determined: rank of the readings at the nominal machine. Rotations about the line: combinations of "
      "the errors that the readings leave open when the pose of the tracker is known. A rotation of C about the line "
      "through the two reflectors "
      "moves neither of them, so one combination of EXC, EYC, EZC, EAC, EBC and ECC is open for each function of C "
      "(constant, cosine, sine). The other five are determined: they are the displacements of the two reflectors. With "
      "the pose of the tracker found, the constants and the once-per-turn parts of C are shared with it.",
      "A fit that is rank deficient and has converged has reached a minimum; the open combinations are fixed by "
      "convention or keep their start value of zero. Its residual holds for these two reflectors and says nothing "
      "about others."};
  if (const std::string words = far_angle_words(rows, truth); !words.empty()) table.notes.push_back(words);
  return table;
}

}  // namespace

TrackerNoise aguado_noise() { return TrackerNoise::isotropic(10, 5); }

std::vector<AguadoRow> aguado_rows(const AguadoTruth& truth, int threads) {
  AguadoRunner run(truth, threads);
  const PoseList random = random_plan(aguado_machine(), full_ranges(aguado_machine(), 2), 1000, 11);
  fit_rotary_axis(run);
  fit_linear_axes(run);
  fit_jointly(run, random);
  run.measure(AguadoExperiment::strategy, random, 3);
  run.fit("1: joint, all axes at once", {});
  run.measure(AguadoExperiment::strategy, join(linear_grid(0, 15), rotary_circle(700, 300)), 3);
  run.fit("2: independent, X and Z at C = 0, then C", {}, Strategy::independent);
  run.measure(AguadoExperiment::strategy, join(linear_grid(0, 15), random), 3);
  run.fit("3: combined, X and Z at C = 0, then all", {}, Strategy::combined);
  return std::move(run.rows);
}

std::vector<ReproducedTable> aguado_tables(const std::vector<AguadoRow>& rows, const ErrorSet& truth) {
  const std::vector<ReproducedColumn> columns = {{"model"},
                                                 {"average initial", "um"},
                                                 {"maximum initial", "um"},
                                                 {"average final", "um"},
                                                 {"maximum final", "um"},
                                                 {"residual", "%"},
                                                 {"at unseen poses", "%"},
                                                 {"converged"},
                                                 {"status"}};
  std::vector<ReproducedTable> tables = {
      {"table-1",
       "Table 1: rotary axis, two reflectors at one place of X and Z, C from 0 to 355 degrees in steps of 5",
       columns,
       {},
       {}},
      {"table-2",
       "Table 2: linear axes, 15 x 15 positions of X 0..1400 and Z 0..600 mm at C = 0, three reflectors",
       columns,
       {},
       {}},
      {"table-3", "Table 3: joint characterisation, 1,000 random poses, three reflectors", columns, {}, {}},
      {"strategies", "Section 4: the three strategies, order 4 and 4 harmonics", columns, {}, {}}};
  for (const AguadoRow& row : rows) {
    ReproducedTable& table = tables[static_cast<std::size_t>(row.experiment)];
    const AguadoPublished* paper = published_of(row.experiment);
    if (paper != nullptr && table.rows.empty()) table.rows.push_back(paper_row(*paper));
    const AguadoFit& fit = row.fit;
    table.rows.push_back({row.model, 1e3 * fit.initial.mean, 1e3 * fit.initial.maximum, 1e3 * fit.residual.mean,
                          1e3 * fit.residual.maximum, row.percent_left(), row.percent_left_unseen(),
                          fit.identification.converged ? "yes" : "NO", status_text(fit.identification.status)});
  }
  tables.insert(tables.begin() + 1, aguado_rank_table(rows, truth));
  tables.back().notes = {
      "Initial: nominal machine and the tracker's true pose against the readings (tracker 10 um + 5 um/m). At unseen "
      "poses: what is left of the mean error at 2,000 random poses with reflector offsets that were not measured."};
  return tables;
}

std::vector<PublishedNumber> aguado_published(const std::vector<AguadoRow>& rows) {
  std::vector<PublishedNumber> numbers;
  for (const AguadoRow& row : rows) {
    const AguadoPublished* paper = published_of(row.experiment);
    if (paper == nullptr || !row.as_paper) continue;
    const auto add = [&](const char* what, const char* unit, double printed, double here, const std::string& note) {
      numbers.push_back({fmt::format("{}, {}", paper->name, what), unit, printed, here, note});
    };
    const std::string before = "here: simulated machine", after = "here: " + row.model;
    add("average initial error", "um", paper->initial_mean, 1e3 * row.fit.initial.mean, before);
    add("maximum initial error", "um", paper->initial_largest, 1e3 * row.fit.initial.maximum, before);
    add("average final error", "um", paper->final_mean, 1e3 * row.fit.residual.mean, after);
    add("maximum final error", "um", paper->final_largest, 1e3 * row.fit.residual.maximum, after);
    const double from_rows = 100 * paper->final_mean / paper->initial_mean;
    const bool slip = std::abs(from_rows - paper->percent) > 0.01;
    add("residual error", "%", paper->percent, row.percent_left(),
        slip ? fmt::format("{}; the paper's own rows give {}/{} = {:.2f} %", after, paper->final_mean,
                           paper->initial_mean, from_rows)
             : after);
  }
  return numbers;
}

}  // namespace abbe
