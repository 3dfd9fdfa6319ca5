#include "aguado/tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "abbe/instruments/measurement_plan.h"

namespace abbe {
namespace {

/// Two reflectors at one place of X and Z, C at `count` angles.
AguadoFit fit_of_rotary_axis(std::size_t count, const AguadoOrders& orders) {
  const AguadoTruth truth = read_aguado_truth();
  TrackerSetup setup = truth.setup;
  setup.stations[0].noise = aguado_noise();
  TrackerSimulationOptions options;
  options.sights = {{0, 0}, {0, 1}};
  const Machine machine = aguado_machine();
  const double last = 2 * std::numbers::pi * static_cast<double>(count - 1) / static_cast<double>(count);
  const PoseList poses = grid_plan(machine, {{0, last, count, 0}, AxisRange::fixed(700), AxisRange::fixed(300)});
  return fit_aguado(truth, simulate_tracker(machine, truth.errors, setup, poses, options).readings, aguado_noise(),
                    orders);
}

AguadoRow row_with(std::size_t parameters, std::size_t rank, std::size_t open_alone, double angle) {
  AguadoRow row;
  row.experiment = AguadoExperiment::table_1;
  row.model = "model";
  row.fit.identification.parameters.resize(parameters);
  row.fit.identification.errors.motions = {{0, Component::A, {}, {0, -angle}, {}}};
  row.fit.rank = rank;
  row.fit.open_alone = open_alone;
  row.fit.residual.mean = 0.25;
  row.fit.initial.mean = row.fit.unseen_before.mean = 1;
  return row;
}

const ReproducedTable& table_of(const std::vector<ReproducedTable>& tables, const std::string& name) {
  return *std::find_if(tables.begin(), tables.end(), [&](const ReproducedTable& t) { return t.name == name; });
}

TEST(AguadoFits, OfTwoReflectorsLeaveTheRotationAboutTheirLineOpen) {
  AguadoOrders orders{.estimate_pose = true, .linear = false};
  const AguadoFit fit = fit_of_rotary_axis(24, orders);
  EXPECT_TRUE(fit.identification.converged) << fit.identification.message;
  EXPECT_EQ(fit.identification.status, IdentifyStatus::rank_deficient);
  EXPECT_EQ(fit.identification.parameters.size(), 60U);
  EXPECT_EQ(fit.rank, 45U);
  EXPECT_EQ(fit.open_alone, 9U);  // a constant, four cosines and four sines
  EXPECT_EQ(fit.shared_with_pose(), 6);
  orders.estimate_pose = false;
  const AguadoFit too_few = fit_of_rotary_axis(2, orders);
  EXPECT_FALSE(too_few.identification.converged);
  EXPECT_EQ(too_few.identification.status, IdentifyStatus::too_few_readings);
}

TEST(AguadoTables, SayWhatIsOpenAndWhetherTheFitHasConverged) {
  ErrorSet truth;
  truth.motions = {{0, Component::B, {}, {1e-4}, {}}};
  std::vector<AguadoRow> rows = {row_with(24, 15, 3, 0.5e-4), row_with(12, 10, 3, 0.5e-4)};
  rows[0].fit.identification.converged = true;
  const std::vector<ReproducedTable> tables = aguado_tables(rows, truth);
  const ReproducedTable& rank = table_of(tables, "table-1-rank");
  const auto number = [&](std::size_t row, std::size_t column) { return rank.rows[row][column].number(); };
  ASSERT_TRUE(number(0, 3) && number(0, 4) && number(1, 4));
  EXPECT_EQ(*number(0, 3), 3);
  EXPECT_EQ(*number(0, 4), 6);
  EXPECT_EQ(*number(1, 4), -1);  // of two ranks that contradict each other, not 2^64 - 1
  EXPECT_EQ(rank.notes.size(), 2U);
  const ReproducedTable& table_1 = table_of(tables, "table-1");
  ASSERT_EQ(table_1.rows.size(), 3U);  // the paper's row first
  const std::size_t converged = table_1.columns.size() - 2;
  EXPECT_EQ(table_1.columns[converged].name, "converged");
  const auto converged_of = [&](std::size_t row) { return table_1.rows[row][converged].text(); };
  ASSERT_TRUE(converged_of(1) && converged_of(2));
  EXPECT_EQ(*converged_of(1), "yes");
  EXPECT_EQ(*converged_of(2), "NO");

  rows[1] = row_with(12, 10, 2, 7e-3);
  const std::vector<ReproducedTable> far = aguado_tables(rows, truth);
  const std::string& note = table_of(far, "table-1-rank").notes.back();
  EXPECT_TRUE(
      note.starts_with("1 of these models finds angles of more than 50 times the largest of the machine's C "
                       "(0.100 mrad) and misfits by 250 um"))
      << note;
}

TEST(AguadoConclusions, SayThatAResidualIsNotAValidationWhereUnseenPosesShowIt) {
  std::vector<AguadoRow> rows = {row_with(24, 15, 3, 0.5e-4)};
  const auto validation = [&] { return aguado_conclusions(rows)[3]; };
  rows[0].fit.unseen.mean = 0.4;  // of 1, at the readings 0.25
  EXPECT_TRUE(validation().starts_with("In 0 of 1 fits of one kind of axis alone, and in 0 of 0 fits")) << validation();
  EXPECT_TRUE(validation().ends_with("twice the share at the readings.")) << validation();
  rows[0].fit.unseen.mean = 0.6;
  EXPECT_TRUE(validation().starts_with("In 1 of 1 fits")) << validation();
  EXPECT_TRUE(validation().ends_with("at the readings: a residual is not a validation.")) << validation();
}

}  // namespace
}  // namespace abbe
