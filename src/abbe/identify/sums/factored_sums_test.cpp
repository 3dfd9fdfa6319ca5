#include "abbe/identify/sums/factored_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Every seventh reading is left out.
std::vector<std::uint8_t> most_readings(std::size_t count) {
  std::vector<std::uint8_t> use(count, 1);
  for (std::size_t k = 3; k < count; k += 7) use[k] = 0;
  return use;
}

/// Other observations, in which nothing that belongs to readings that are left out is a number.
class Spoiled : public Observations {
 public:
  /// @param factors  false: the Jacobian has none, and is summed column by column
  Spoiled(std::shared_ptr<Observations> observations, bool factors)
      : own_(std::move(observations)), use_(most_readings(own_->reading_count())), factors_(factors) {}
  std::string name() const override { return own_->name(); }
  std::size_t reading_count() const override { return own_->reading_count(); }
  int rows() const override { return own_->rows(); }
  const std::vector<ReadingComponent>& components() const override { return own_->components(); }
  const std::vector<SetupUnknown>& unknowns() const override { return own_->unknowns(); }
  std::vector<double> unknown_values() const override { return own_->unknown_values(); }
  std::vector<double> positions(std::size_t reading) const override { return own_->positions(reading); }
  std::vector<double> deviation(std::size_t reading) const override { return own_->deviation(reading); }
  void set_parameters(std::span<const double> machine, std::span<const double> setup) override {
    own_->set_parameters(machine, setup);
  }
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                std::size_t stride) const override {
    own_->evaluate(first, count, machine_parameters, setup_parameters, residuals, jacobian, stride);
    const std::size_t rows = static_cast<std::size_t>(own_->rows());
    spoil(first, count, rows, residuals);
    for (std::size_t c = 0; jacobian && c < machine_parameters.size() + setup_parameters.size(); ++c)
      spoil(first, count, rows, jacobian + c * stride);
  }
  std::optional<FactoredColumns> column_factors(std::span<const std::size_t> machine_parameters,
                                                std::span<const std::size_t> setup_parameters) const override {
    if (!factors_) return std::nullopt;
    return own_->column_factors(machine_parameters, setup_parameters);
  }
  void evaluate_factored(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                         std::span<const std::size_t> setup_parameters, double* residuals,
                         const JacobianFactors& factors) const override {
    own_->evaluate_factored(first, count, machine_parameters, setup_parameters, residuals, factors);
    const std::size_t rows = static_cast<std::size_t>(own_->rows());
    spoil(first, count, rows, residuals);
    for (std::size_t c = 0; c < factors.form.carriers(); ++c)
      spoil(first, count, rows, factors.carriers + c * factors.stride);
    for (std::size_t b = 0; b < factors.form.bases(); ++b)
      spoil(first, count, 1, factors.bases + b * factors.basis_stride);
  }

 private:
  void spoil(std::size_t first, std::size_t count, std::size_t rows, double* column) const {
    for (std::size_t i = 0; i < rows * count; ++i)
      if (use_[first + i % count] == 0) column[i] = kNaN;
  }

  std::shared_ptr<Observations> own_;
  std::vector<std::uint8_t> use_;
  bool factors_;
};

/// Every coefficient but the third of every motion, as a selection of terms leaves them.
std::vector<std::size_t> most_parameters(const ErrorSet& errors) {
  std::vector<std::size_t> parameters;
  std::size_t next = 0;
  for (std::size_t m = 0; m < errors.motions.size(); ++m)
    for (std::size_t k = 0; k < errors.motions[m].coefficients.size(); ++k, ++next)
      if (k != 2 && (k != 0 || m % 2 == 0)) parameters.push_back(next);
  for (; next < errors.parameter_count(); ++next) parameters.push_back(next);
  return parameters;
}

/// A problem with all unknowns and most parameters and readings.
Problem most_of(const Machine& machine, const ErrorSet& errors, std::shared_ptr<Observations> observations,
                bool factors) {
  Problem problem = estimate_everything(machine, errors, {std::make_shared<Spoiled>(std::move(observations), factors)});
  problem.machine_parameters = most_parameters(errors);
  problem.observations[0].use = most_readings(problem.observations[0].observations->reading_count());
  return problem;
}

/// Two stations, on the bed and on the workpiece, and reflectors on the tool and on the bed: three pairs of bodies in
/// one block.
Problem tracker_problem(std::size_t poses, TrackerMeasure measure, bool factors) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors = test::some_errors(machine);
  errors.reversals.push_back({machine.find_axis("X"), 0.004, 0});
  TrackerSetup setup;
  setup.stations.resize(2);
  for (TrackerStation& station : setup.stations) {
    station.noise = TrackerNoise::isotropic(5, 0);
    station.estimate_pose = true;
  }
  setup.stations[0].name = "bed";
  setup.stations[0].body = Body::bed;
  setup.stations[0].body_from_tracker.translation = {900, -1100, 200};
  setup.stations[1].name = "table";
  setup.stations[1].body = Body::workpiece;
  setup.stations[1].body_from_tracker.translation = {-150, 120, 160};
  setup.reflectors.resize(3);
  setup.reflectors[0].offset = {10, 20, -130};
  setup.reflectors[1].offset = {-40, 10, -110};
  setup.reflectors[1].estimate_offset = true;
  setup.reflectors[2].body = Body::workpiece;
  setup.reflectors[2].offset = {60, -20, 30};
  TrackerReadings readings;
  readings.measure = measure;
  readings.reserve(machine.axes.size(), poses);
  RandomStream random(5);
  for (std::size_t k = 0; k < poses; ++k) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i)
      readings.poses.axis[i].push_back(random.uniform(machine.axes[i].travel_min, machine.axes[i].travel_max) / 2);
    readings.station.push_back(k % 5 == 0 ? 1 : 0);
    readings.reflector.push_back(static_cast<std::uint16_t>(k % 5 == 0 ? 0 : k % 3));
    for (std::vector<double>& measured : readings.measured) measured.push_back(random.uniform(0.1, 0.9));
  }
  readings.poses.approach.resize(machine.axes.size());
  for (std::vector<std::int8_t>& approach : readings.poses.approach)
    for (std::size_t k = 0; k < poses; ++k) approach.push_back(static_cast<std::int8_t>(random.bits() % 3) - 1);
  return most_of(machine, errors, std::make_shared<TrackerObservations>(machine, errors, setup, std::move(readings)),
                 factors);
}

Problem ball_bar_problem(std::size_t poses, bool factors) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors = test::some_errors(machine);
  errors.locations.clear();
  RandomStream random(9);
  for (ErrorMotion& motion : errors.motions) {
    // With one row, factors pay for long series only.
    motion.basis.order = motion.basis.kind == BasisKind::fourier ? 4 : 8;
    motion.coefficients.resize(motion.basis.size());
    for (double& value : motion.coefficients) value = (is_rotation(motion.component) ? 1e-6 : 1e-3) * random.normal();
  }
  BallBarSetup setup;
  setup.name = "bar";
  setup.spindle_ball = SetupPoint::within({0.01, -0.02, -120}, 0.005);
  setup.balls = {{"centre", SetupPoint::open({20, 10, 60})}, {"edge", SetupPoint::open({80, -30, 90})}};
  setup.length_deviation = SetupNumber::within(0.003, 0.0005);
  const auto bar = std::make_shared<BallBar>(setup);
  InstrumentReadings plan = test::anywhere(machine, poses);
  for (std::size_t k = 0; k < plan.count(); ++k) plan.item[k] = static_cast<std::uint16_t>(k % 2);
  InstrumentReadings readings = test::exact_readings(machine, errors, bar, plan);
  for (double& length : readings.measured[0]) length += 1e-4 * random.normal();
  Problem problem = most_of(
      machine, errors, std::make_shared<InstrumentObservations>(machine, errors, bar, std::move(readings)), factors);
  problem.machine_parameters.resize(errors.parameter_count());
  std::iota(problem.machine_parameters.begin(), problem.machine_parameters.end(), std::size_t{0});
  return problem;
}

/// True if the sums of these observations come from factors.
bool uses_factors(const Problem& problem) {
  const SelectedObservations& selected = problem.observations.at(0);
  const auto form = selected.observations->column_factors(problem.machine_parameters, selected.unknowns);
  return form && FactoredSums(*form, static_cast<std::size_t>(selected.observations->rows())).is_quicker();
}

void expect_same_sums(const Problem& problem, const Problem& whole, const Loss& loss) {
  ASSERT_TRUE(uses_factors(problem));
  ASSERT_FALSE(uses_factors(whole));
  const Eigen::VectorXd x = present_values(problem);
  const NormalEquations ours = ReadingStream(problem, 2).sums(x, loss, Wanted::normal);
  const NormalEquations gradient = ReadingStream(problem, 1).sums(x, loss, Wanted::gradient);
  const NormalEquations theirs = ReadingStream(whole, 1).sums(x, loss, Wanted::normal);
  ASSERT_TRUE(theirs.finite);
  ASSERT_TRUE(ours.finite);
  EXPECT_EQ(ours.cost, theirs.cost);
  const Eigen::VectorXd norms = theirs.normal.diagonal().cwiseSqrt();
  const double residual_norm = std::sqrt(2 * theirs.cost);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(ours.gradient[i], theirs.gradient[i], 1e-13 * norms[i] * residual_norm);
    EXPECT_NEAR(gradient.gradient[i], theirs.gradient[i], 1e-13 * norms[i] * residual_norm);
    for (Eigen::Index j = 0; j < x.size(); ++j)
      EXPECT_NEAR(ours.normal(i, j), theirs.normal(i, j), 1e-13 * norms[i] * norms[j]) << i << ", " << j;
  }
}

TEST(FactoredSums, of_random_factors_are_the_sums_of_their_products) {
  RandomStream random(11);
  int compared = 0;
  for (int round = 0; round < 40; ++round) {
    const std::size_t rows = 1 + random.bits() % 4, count = 1 + random.bits() % 128;
    // Carriers of three axes with some terms missing, then whole columns.
    FactoredColumns form;
    std::vector<FactoredColumns::Column> wanted;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t k = 0; k < 6; ++k)
          if (random.bits() % 4 > 0 && k < 2 + (c + axis) % 5) wanted.push_back({6 * axis + c, 6 * axis + k});
    std::vector<std::size_t> carrier_number(18, FactoredColumns::kOne), basis_number = carrier_number;
    for (const FactoredColumns::Column& column : wanted) {
      std::size_t &carrier = carrier_number[column.carrier], &basis = basis_number[column.basis];
      if (carrier == FactoredColumns::kOne) {
        carrier = form.carriers();
        form.carrier_first.push_back(form.columns.size());
      }
      if (basis == FactoredColumns::kOne) {
        basis = form.bases();
        form.basis_first.push_back(form.columns.size());
      }
      form.columns.push_back({carrier, basis});
    }
    for (std::size_t i = random.bits() % 30; i > 0; --i) form.add_whole_column();

    const FactoredSums sums(form, rows);
    if (!sums.is_quicker()) continue;
    ++compared;
    constexpr std::size_t kStride = FactoredSums::kStride;
    const std::size_t stride = padded(rows * count, kLengthMultiple);
    std::vector<double> carriers((form.carriers() + 1) * stride + kLengthMultiple, kNaN);
    std::vector<double> bases((form.bases() + 1) * kStride, 0.0);
    for (std::size_t c = 0; c <= form.carriers(); ++c)
      for (std::size_t i = 0; i < rows * count; ++i) carriers[c * stride + i] = random.normal();
    for (std::size_t b = 0; b <= form.bases(); ++b)
      for (std::size_t k = 0; k < count; ++k) bases[b * kStride + k] = b == form.bases() ? 1.0 : random.normal();
    std::vector<double> scratch(sums.scratch_size(), kNaN);
    std::vector<double> products(sums.sums_size(true), 0.0), gradients(sums.sums_size(false), 0.0);
    for (int block = 0; block < 2; ++block) {
      sums.add(true, carriers.data(), stride, bases.data(), count, scratch.data(), products.data());
      sums.add(false, carriers.data(), stride, bases.data(), count, scratch.data(), gradients.data());
    }
    std::vector<double> values, gradient;
    sums.append(true, products, values);
    sums.append(false, gradients, gradient);
    const std::size_t columns = form.columns.size();
    ASSERT_EQ(values.size(), columns + columns * (columns + 1) / 2);
    ASSERT_EQ(gradient.size(), columns);

    std::vector<std::vector<double>> whole;
    for (const auto& [carrier, basis] : form.columns) {
      std::vector<double>& column = whole.emplace_back();
      for (std::size_t i = 0; i < rows * count; ++i)
        column.push_back(carriers[carrier * stride + i] *
                         (basis == FactoredColumns::kOne ? 1.0 : bases[basis * kStride + i % count]));
    }
    const double tolerance = 1e-12 * static_cast<double>(rows * count);
    std::size_t next = 0;
    for (std::size_t i = 0; i < columns; ++i, ++next) {
      double sum = 0;
      for (std::size_t k = 0; k < rows * count; ++k) sum += whole[i][k] * carriers[form.carriers() * stride + k];
      ASSERT_NEAR(values[next], 2 * sum, tolerance);
      ASSERT_NEAR(gradient[i], 2 * sum, tolerance);
    }
    for (std::size_t i = 0; i < columns; ++i)
      for (std::size_t j = i; j < columns; ++j, ++next) {
        double sum = 0;
        for (std::size_t k = 0; k < rows * count; ++k) sum += whole[i][k] * whole[j][k];
        ASSERT_NEAR(values[next], 2 * sum, tolerance) << i << ", " << j;
      }
  }
  EXPECT_GE(compared, 15);
}

TEST(FactoredSums, are_left_alone_where_whole_columns_take_less) {
  FactoredColumns form;
  for (int i = 0; i < 20; ++i) form.add_whole_column();
  EXPECT_FALSE(FactoredSums(form, 1).is_quicker());
}

TEST(FactoredSums, of_a_tracker_equal_those_of_its_columns) {
  for (const TrackerMeasure measure : {TrackerMeasure::cartesian, TrackerMeasure::range_and_angles})
    for (const LossKind kind : {LossKind::none, LossKind::huber, LossKind::tukey})
      expect_same_sums(tracker_problem(700, measure, true), tracker_problem(700, measure, false),
                       Loss{kind, 0, 3000.0});
}

TEST(FactoredSums, of_a_ball_bar_equal_those_of_its_columns) {
  for (const LossKind kind : {LossKind::none, LossKind::cauchy})
    expect_same_sums(ball_bar_problem(500, true), ball_bar_problem(500, false), Loss{kind, 0, 1});
}

TEST(FactoredSums, give_the_same_bits_with_every_number_of_threads) {
  const Problem problem = tracker_problem(700, TrackerMeasure::cartesian, true);
  const Eigen::VectorXd x = present_values(problem);
  const NormalEquations one = ReadingStream(problem, 1).sums(x, Loss{}, Wanted::normal);
  const NormalEquations five = ReadingStream(problem, 5).sums(x, Loss{}, Wanted::normal);
  EXPECT_TRUE((one.normal.array() == five.normal.array()).all());
  EXPECT_TRUE((one.gradient.array() == five.gradient.array()).all());
}

TEST(FactoredSums, lead_to_the_same_identification_as_whole_columns) {
  Problem ours = ball_bar_problem(600, true);
  // No gauge is left open, and what the readings leave open stays small.
  const std::vector<bool> angles = parameters_are_angles(ours.machine, ours.errors);
  for (const std::size_t i : ours.machine_parameters)
    ours.priors.push_back({{ParameterId::kMachine, i}, 0, angles[i] ? 1e-5 : 1e-2});
  for (std::size_t i = 0; i < ours.observations[0].unknowns.size(); ++i)
    ours.priors.push_back({{0, i}, ours.observations[0].observations->unknown_values()[i], 0.05});
  Problem theirs = ball_bar_problem(600, false);
  theirs.priors = ours.priors;
  ASSERT_TRUE(uses_factors(ours));
  ASSERT_FALSE(uses_factors(theirs));
  const Identification a = identify(ours), b = identify(theirs);
  ASSERT_EQ(a.status, IdentifyStatus::converged) << a.message;
  ASSERT_EQ(b.status, IdentifyStatus::converged) << b.message;
  for (Eigen::Index i = 0; i < a.estimates.size(); ++i) {
    EXPECT_NEAR(a.estimates[i], b.estimates[i], 1e-7 * b.standard_uncertainties[i]);
    EXPECT_NEAR(a.standard_uncertainties[i], b.standard_uncertainties[i], 1e-9 * b.standard_uncertainties[i]);
  }
  EXPECT_NEAR(a.statistics.chi_square, b.statistics.chi_square, 1e-9 * b.statistics.chi_square);
}

}  // namespace
}  // namespace abbe
