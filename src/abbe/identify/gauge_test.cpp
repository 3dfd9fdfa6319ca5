#include "abbe/identify/gauge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <memory>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/trust/monte_carlo.h"
#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"

namespace abbe {
namespace {

constexpr std::size_t kOrder = 4;  // of X, of Z and harmonics of C

/// The machine w C' X' b Z t with all 18 error motions, the place of the C axis and the pose of the tracker.
///
/// Aguado counts 6(nX+1) + 6(nZ+1) + 6(2H+1) + 12, the twelve being the points C0 and Z0 and the pose of the tracker. A
/// shift of a linear axis (Z0) and of a rotary axis along itself (C0.z) have no effect that the constants of EXZ, EYZ,
/// EZZ, EZC do not have, so they are no location errors here: four parameters and four unseen directions fewer. The
/// rank is the same.
struct Aguado {
  std::unique_ptr<TrackerObservations> observations;
  Problem problem;

  /// @param shift_mm, turn_rad  error of the tracker's start pose
  /// @param outlier_share  of the readings get gross errors of up to 50 mm
  Aguado(const std::vector<Eigen::Vector3d>& offsets, const std::string& file, double shift_mm = 0, double turn_rad = 0,
         double outlier_share = 0) {
    const test::AguadoCase given = test::aguado_case();
    TrackerReadings readings = test::aguado_readings(given, file);
    TrackerSetup setup = given.setup;
    if (!offsets.empty()) {
      setup.reflectors.resize(offsets.size());
      for (std::size_t i = 0; i < offsets.size(); ++i) {
        setup.reflectors[i] = given.setup.reflectors[0];
        setup.reflectors[i].offset = offsets[i];
      }
      for (std::size_t i = 0; i < readings.count(); ++i)
        readings.reflector[i] = static_cast<std::uint16_t>(i % offsets.size());
    }
    RigidTransform& pose = setup.stations[0].body_from_tracker;
    pose.rotation = rotation_from_error_angles({turn_rad, -turn_rad, turn_rad}) * pose.rotation;
    pose.translation += Eigen::Vector3d(shift_mm, -shift_mm, shift_mm);
    RandomStream random(11);
    for (std::size_t i = 0; i < readings.count(); ++i)
      if (random.uniform() < outlier_share)
        for (std::vector<double>& measured : readings.measured) measured[i] += random.uniform(1, 50);
    ErrorSet errors = given.truth;
    for (ErrorMotion& motion : errors.motions) std::fill(motion.coefficients.begin(), motion.coefficients.end(), 0.0);
    errors.locations = {{0, Component::X, 0, 0}, {0, Component::Y, 0, 0}};
    observations = std::make_unique<TrackerObservations>(given.machine, errors, setup, readings);
    problem = estimate_everything(given.machine, errors, {borrowed(*observations)});
    for (int i = 0; i < 3; ++i) problem.machine_parameters.pop_back();  // the tool offset error
  }
  NullSpace null_space() const { return find_null_space(problem, present_values(problem)); }
};

std::size_t unseen(const NullSpace& space) {
  return static_cast<std::size_t>(space.singular_values.size()) - space.rank;
}

const Eigen::Vector3d kFirst(60, 0, -150), kSecond(0, 80, -250);
const std::string kFile = "aguado_5000_noise0.csv";

TEST(Gauge, three_offsets_give_the_rank_of_the_theory) {
  Aguado aguado({}, kFile);
  const NullSpace space = aguado.null_space();
  EXPECT_EQ(space.singular_values.size(), 122);
  EXPECT_EQ(space.rank, 6 * (kOrder + kOrder + 2 * kOrder) + 6);
  EXPECT_EQ(unseen(space), 24u - 4u);
  EXPECT_EQ(space.weak, 0u);
}

TEST(Gauge, two_offsets_in_general_position_lose_the_roll_of_the_tool) {
  Aguado aguado({kFirst, kSecond}, kFile);
  EXPECT_EQ(unseen(aguado.null_space()), 20u + kOrder + 1);
}

TEST(Gauge, two_offsets_on_the_spindle_line_lose_more) {
  Aguado aguado({{0, 0, -150}, {0, 0, -250}}, kFile);
  EXPECT_EQ(unseen(aguado.null_space()), 20u + kOrder + kOrder);
}

TEST(Gauge, one_offset_loses_the_angles_of_the_tool_axis) {
  Aguado aguado({kFirst}, kFile);
  EXPECT_EQ(unseen(aguado.null_space()), 20u + 3 * kOrder + kOrder + 2);
}

TEST(Gauge, the_conventions_fix_everything_and_the_equations_hold_exactly) {
  Aguado aguado({}, "aguado_500_noiseLT.csv");
  const Identification result = identify(aguado.problem);
  ASSERT_EQ(result.status, IdentifyStatus::converged) << result.message;
  ASSERT_EQ(result.gauge.constraints.size(), 20u);
  for (const GaugeConstraint& constraint : result.gauge.constraints) {
    EXPECT_TRUE(constraint.by_convention) << constraint.words;
    const double size = constraint.functional.cwiseAbs().dot(result.estimates.cwiseAbs());
    EXPECT_LE(std::abs(constraint.functional.dot(result.estimates) - constraint.value), 1e-13 * (size + 1e-6))
        << constraint.words;
    EXPECT_LE(std::abs(constraint.functional.dot(result.covariance * constraint.functional)),
              1e-9 * constraint.functional.cwiseAbs2().dot(result.covariance.diagonal()) + 1e-30);
  }
  EXPECT_THAT(result.gauge.warnings,
              testing::Contains(testing::AllOf(testing::HasSubstr("constant of EXZ"), testing::HasSubstr("tracker1"))));
  EXPECT_NEAR(result.statistics.chi_square / result.statistics.degrees_of_freedom, 1, 0.15);
  EXPECT_GT(result.statistics.observability.o1, 0);
  EXPECT_LE(result.statistics.observability.o3, 1);
}

TEST(Gauge, a_roughly_known_tracker_pose_is_enough) {
  Aguado aguado({}, "aguado_5000_noiseLT.csv", 100 / std::sqrt(3.0), 0.1);  // 10 degrees, 100 mm
  const Identification result = identify(aguado.problem);
  ASSERT_EQ(result.status, IdentifyStatus::converged) << result.message;
  EXPECT_NEAR(result.statistics.variance_factor, 1, 0.05);
}

TEST(Gauge, thirty_percent_gross_outliers_leave_the_machine_at_unseen_poses_within_twice_the_clean_error) {
  Aguado clean({}, "aguado_500_noiseLT.csv"), dirty({}, "aguado_500_noiseLT.csv", 20, 0.02, 0.3);
  IdentifyOptions options;
  const Identification good = identify(clean.problem, options);
  options.loss = LossKind::tukey;
  const Identification robust = identify(dirty.problem, options);
  ASSERT_EQ(robust.status, IdentifyStatus::converged) << robust.message;
  EXPECT_NEAR(static_cast<double>(robust.outliers.size()), 150, 35);
  // Unseen: readings without noise at other poses.
  Aguado unseen({}, kFile);
  const auto error = [&](const Aguado& from) {
    double sum = 0;
    Problem problem = unseen.problem;
    problem.errors = from.problem.errors;
    problem.machine_parameters.clear();  // only the station's pose is fitted at the unseen poses
    const Identification pose = identify(problem);
    EXPECT_EQ(pose.status, IdentifyStatus::converged);
    for (std::size_t i = 0; i < unseen.observations->reading_count(); ++i)
      sum += unseen.observations->distance(i).norm();
    return sum / static_cast<double>(unseen.observations->reading_count());
  };
  const double clean_error = error(clean), dirty_error = error(dirty);
  EXPECT_LT(clean_error, 0.010);
  EXPECT_LT(dirty_error, 2 * clean_error);
}

TEST(Gauge, monte_carlo_stays_in_the_gauge_and_confirms_the_covariance) {
  Aguado aguado({}, "aguado_500_noiseLT.csv");
  const Identification result = identify(aguado.problem);
  MonteCarloOptions options;
  options.samples = 2000;
  const MonteCarloResult simulated = monte_carlo(aguado.problem, result, options);
  ASSERT_EQ(simulated.status, MonteCarloStatus::done);
  for (const GaugeConstraint& constraint : result.gauge.constraints)
    EXPECT_LE(std::abs(constraint.functional.dot(simulated.covariance * constraint.functional)),
              1e-9 * constraint.functional.cwiseAbs2().dot(simulated.covariance.diagonal()) + 1e-30);
  for (Eigen::Index i = 0; i < result.estimates.size(); ++i) {
    if (result.standard_uncertainties[i] < 1e-12) continue;
    EXPECT_NEAR(std::sqrt(simulated.covariance(i, i)) / result.standard_uncertainties[i], 1, 0.08) << i;
  }
}

TEST(Gauge, one_offset_is_an_answer_with_a_warning) {
  // Consistent data for the one offset: the readings of the first reflector only.
  const test::AguadoCase given = test::aguado_case();
  const TrackerReadings all = test::aguado_readings(given, kFile);
  Aguado whole({}, kFile);
  whole.problem.observations[0].use.assign(all.count(), 0);
  for (std::size_t i = 0; i < all.count(); ++i) whole.problem.observations[0].use[i] = all.reflector[i] == 0;
  const Identification result = identify(whole.problem);
  EXPECT_EQ(result.status, IdentifyStatus::rank_deficient);
  EXPECT_TRUE(result.converged);  // a minimum, at which combinations are open
  EXPECT_GT(result.estimates.size(), 0);
  EXPECT_GT(result.covariance.size(), 0);
  EXPECT_THAT(result.gauge.warnings, testing::Contains(testing::HasSubstr("no convention fixes")));
}

TEST(Gauge, noise_free_readings_give_the_machine_back_at_unseen_poses) {
  Aguado aguado({}, kFile);
  const std::size_t count = aguado.observations->reading_count();
  aguado.problem.observations[0].use.assign(count, 1);
  for (std::size_t i = 0; i < count; i += 2) aguado.problem.observations[0].use[i] = 0;
  const Identification result = identify(aguado.problem);
  ASSERT_EQ(result.status, IdentifyStatus::converged) << result.message;
  double sum = 0;
  const std::size_t held_out = (count + 1) / 2;
  for (std::size_t i = 0; i < count; i += 2) sum += aguado.observations->distance(i).norm();
  EXPECT_LT(sum / static_cast<double>(held_out), 1e-6);  // mm; 0.001 um
}

TEST(Gauge, the_choice_of_the_gauge_does_not_change_the_model) {
  Aguado iso({}, "aguado_500_noiseLT.csv"), shortest({}, "aguado_500_noiseLT.csv");
  IdentifyOptions options;
  const Identification a = identify(iso.problem, options);
  options.gauge = GaugeChoice::minimum_norm;
  const Identification b = identify(shortest.problem, options);
  ASSERT_EQ(a.status, IdentifyStatus::converged);
  ASSERT_EQ(b.status, IdentifyStatus::converged);
  // Equal to first order in the errors (0.1 mrad): the unseen directions are those of the nominal machine.
  EXPECT_NEAR(a.statistics.chi_square, b.statistics.chi_square, 1e-2 * a.statistics.chi_square);
  EXPECT_GT((a.estimates - b.estimates).norm(), 1e-3);
}

TEST(Gauge, a_singular_value_of_1e_minus_13_is_told_from_zero) {
  // Columns 0 and 1 differ by a relative 1e-12 (seen), columns 2 and 3 are equal (unseen).
  const auto make = [](double difference) {
    return [difference](std::size_t k, std::size_t, const std::vector<FunctionObservations::Complex>& b) {
      const double t = static_cast<double>(k) / 100;
      return (b[0] + b[1]) * std::cos(t) + difference * b[1] * std::sin(3 * t) + (b[2] + b[3]) * t;
    };
  };
  for (const double difference : {1e-3, 1e-6, 1e-9, 4e-13}) {
    FunctionObservations observations(4, 1, std::vector<double>(400, 0.0), 1, make(difference));
    observations.start({1, 1, 1, 1});
    Problem problem = function_problem({&observations});
    const NullSpace space = find_null_space(problem, present_values(problem));
    EXPECT_EQ(space.rank, 3u) << difference;
    EXPECT_EQ(space.weak, difference < 1e-8 ? 1u : 0u) << difference;
    const double seen = space.singular_values[2];
    EXPECT_NEAR(seen / difference, 0.5, 0.3) << difference;
  }
}

TEST(Gauge, what_is_left_open_is_told_the_same_in_whichever_basis_it_was_found) {
  // b0 and b1, b0 and b2, and b3 and b4 are not told apart: three directions, two of them as unseen as each other.
  FunctionObservations observations(
      6, 1, std::vector<double>(400, 0.0), 1,
      [](std::size_t k, std::size_t, const std::vector<FunctionObservations::Complex>& b) {
        const double t = static_cast<double>(k) / 100;
        return (b[0] + b[1] + 0.5 * b[2]) * std::cos(t) + (b[3] + 3.0 * b[4]) * t + b[5] * t * t;
      });
  observations.start({1, 1, 1, 1, 1, 1});
  Problem problem = function_problem({&observations});
  const Eigen::VectorXd start = present_values(problem);
  NullSpace space = find_null_space(problem, start);
  ASSERT_EQ(space.basis.cols(), 3);
  const std::vector<GaugeConstraint> one = fix_gauge(problem, space, start, GaugeChoice::minimum_norm);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.5, -0.3, 0.7, 0.2).normalized().toRotationMatrix();
  space.basis = (space.basis * turn).eval();
  const std::vector<GaugeConstraint> other = fix_gauge(problem, space, start, GaugeChoice::minimum_norm);
  ASSERT_EQ(one.size(), 3u);
  ASSERT_EQ(other.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(one[i].inseparable_words, other[i].inseparable_words);
    EXPECT_LT((one[i].functional - other[i].functional).norm(), 1e-12 * one[i].functional.norm());
    EXPECT_LT((one[i].direction - other[i].direction).norm(), 1e-12 * one[i].direction.norm());
  }
  // Each is one combination alone: nothing of the other pair is in it.
  EXPECT_EQ(one[0].inseparable.size() + one[1].inseparable.size() + one[2].inseparable.size(), 3u + 2u + 2u);
}

TEST(Gauge, what_has_to_be_fixed_keeps_the_value_of_a_fit_where_one_is_given) {
  FunctionObservations observations(
      2, 1, std::vector<double>(100, 0.0), 1,
      [](std::size_t k, std::size_t, const std::vector<FunctionObservations::Complex>& b) {
        return (b[0] + b[1]) * std::cos(static_cast<double>(k));
      });
  observations.start({1, 2});
  Problem problem = function_problem({&observations});
  const Eigen::VectorXd start = present_values(problem);
  const Eigen::VectorXd solution = Eigen::Vector2d(-3, 5);
  const NullSpace space = find_null_space(problem, start);
  const auto fixed = [&](const Eigen::VectorXd* at) {
    return fix_gauge(problem, space, start, GaugeChoice::iso, GaugeOrder::firmest, at);
  };
  const std::vector<GaugeConstraint> plain = fixed(nullptr);
  const std::vector<GaugeConstraint> kept = fixed(&solution);
  ASSERT_EQ(plain.size(), 1u);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_THAT(plain[0].words, testing::EndsWith(" keeps its start value"));
  EXPECT_EQ(plain[0].value, plain[0].functional.dot(start));
  EXPECT_THAT(kept[0].words, testing::EndsWith(" stays as the fit found it"));
  EXPECT_EQ(kept[0].value, kept[0].functional.dot(solution));
  EXPECT_TRUE(kept[0].by_convention);
}

}  // namespace
}  // namespace abbe
