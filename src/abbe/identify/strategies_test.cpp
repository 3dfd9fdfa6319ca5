#include "abbe/identify/strategies.h"

#include <gtest/gtest.h>

#include <memory>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/order_selection.h"
#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"

namespace abbe {
namespace {

constexpr double kTrackerNoise_mm = 0.005;  // mm

/// Aguado's machine with low orders, and readings simulated at given poses with all three reflectors.
struct Campaign {
  test::AguadoCase given = test::aguado_case();
  ErrorSet truth;  // location errors added, nothing that the gauge would move
  TrackerReadings readings;
  std::unique_ptr<TrackerObservations> observations;
  Problem problem;

  Campaign(const std::vector<std::vector<double>>& poses, std::uint64_t seed, int highest_order = 2) {
    truth = given.truth;
    for (ErrorMotion& motion : truth.motions) {
      const int order = motion.axis == 0 ? 1 : 2;
      motion.basis.order = motion.axis == 0 ? std::min(highest_order, 3) : highest_order;
      const std::size_t kept =
          motion.axis == 0 ? 2 * static_cast<std::size_t>(order) + 1 : static_cast<std::size_t>(order) + 1;
      motion.coefficients.resize(motion.basis.size());
      for (std::size_t k = 0; k < motion.coefficients.size(); ++k)
        if (k >= kept || k == 0) motion.coefficients[k] = 0;
    }
    readings.reserve(3, poses.size() * 3);
    RandomStream random(seed);
    const ChainPlan plan(given.machine, truth, Body::tool, Body::workpiece);
    const RigidTransform tracker_from_body = given.setup.stations[0].body_from_tracker.inverse();
    for (const std::vector<double>& pose : poses)
      for (std::uint16_t reflector = 0; reflector < 3; ++reflector) {
        const double* axis[3] = {&pose[0], &pose[1], &pose[2]};
        Eigen::Vector3d point = given.setup.reflectors[reflector].offset;
        plan.transform({axis, 1}, {&point[0], &point[1], &point[2]}, {&point[0], &point[1], &point[2]});
        const Eigen::Vector3d seen = tracker_from_body * point;
        for (std::size_t a = 0; a < 3; ++a) readings.poses.axis[a].push_back(pose[a]);
        readings.station.push_back(0);
        readings.reflector.push_back(reflector);
        for (std::size_t k = 0; k < 3; ++k)
          readings.measured[k].push_back(seen[static_cast<Eigen::Index>(k)] + kTrackerNoise_mm * random.normal());
      }
    given.setup.stations[0].noise = TrackerNoise::isotropic(1000 * kTrackerNoise_mm, 0);
    ErrorSet start = truth;
    for (ErrorMotion& motion : start.motions) std::fill(motion.coefficients.begin(), motion.coefficients.end(), 0.0);
    observations = std::make_unique<TrackerObservations>(given.machine, start, given.setup, readings);
    problem = estimate_everything(given.machine, start, {borrowed(*observations)});
    for (int i = 0; i < 3; ++i) problem.machine_parameters.pop_back();
  }

  double mean_distance() const {
    double sum = 0;
    for (std::size_t i = 0; i < observations->reading_count(); ++i) sum += observations->distance(i).norm();
    return sum / static_cast<double>(observations->reading_count());
  }
};

std::vector<std::vector<double>> two_tests(bool rotary_with_linear) {
  std::vector<std::vector<double>> poses;
  for (int i = 0; i <= 7; ++i)
    for (int j = 0; j <= 5; ++j) poses.push_back({0, 200.0 * i, 120.0 * j});
  RandomStream random(3);
  for (int k = 1; k < 48; ++k)
    poses.push_back({k * std::numbers::pi / 24, rotary_with_linear ? random.uniform(0, 1400) : 700.0,
                     rotary_with_linear ? random.uniform(0, 600) : 300.0});
  return poses;
}

TEST(Strategies, readings_are_classified_by_what_moves) {
  std::vector<std::vector<double>> poses = two_tests(false);
  poses.push_back({1.0, 100, 100});
  const Campaign campaign(poses, 1);
  const std::vector<ReadingClass> classes = classify_readings(campaign.problem.machine, *campaign.observations);
  ASSERT_EQ(classes.size(), 3 * poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ReadingClass wanted = i < 48                 ? ReadingClass::linear_moves
                                : i + 1 < poses.size() ? ReadingClass::rotary_moves
                                                       : ReadingClass::both_move;
    EXPECT_EQ(classes[3 * i], wanted) << i;
  }
}

TEST(Strategies, joint_and_combined_predict_alike_at_unseen_poses) {
  std::vector<double> unseen;
  for (const Strategy strategy : {Strategy::joint, Strategy::combined}) {
    Campaign campaign(two_tests(true), 5);
    const StagedIdentification result = identify_in_stages(campaign.problem, strategy);
    ASSERT_EQ(result.total.estimates.size(), static_cast<Eigen::Index>(estimated_count(campaign.problem)));
    ASSERT_GT(result.total.covariance.size(), 0);
    // The truth at poses that were not measured, seen by the identified model.
    Campaign elsewhere({{0.5, 333, 111}, {2.5, 1111, 555}, {4.5, 70, 300}, {6.0, 900, 20}}, 9);
    elsewhere.observations->set_parameters(campaign.problem.errors.parameters(),
                                           campaign.observations->unknown_values());
    unseen.push_back(elsewhere.mean_distance());
  }
  // Noise of one reading: 1.6 sigma in the mean of the distance.
  EXPECT_LT(unseen[0], 2.5 * kTrackerNoise_mm);
  EXPECT_LT(unseen[1], 2.5 * kTrackerNoise_mm);
  EXPECT_NEAR(unseen[0], unseen[1], 0.3 * kTrackerNoise_mm);
}

TEST(Strategies, independent_identifies_each_kind_of_axis_from_its_own_test) {
  Campaign campaign(two_tests(false), 6);
  const StagedIdentification result = identify_in_stages(campaign.problem, Strategy::independent);
  ASSERT_EQ(result.stages.size(), 2u);
  for (const Identification& stage : result.stages) {
    EXPECT_EQ(stage.status, IdentifyStatus::converged);
    EXPECT_TRUE(stage.converged);
    EXPECT_NEAR(stage.statistics.variance_factor, 1, 0.2);  // each test is described to the noise
  }
  // Elsewhere the angles of C, seen with offsets of 0.1 m, reach out to 0.7 m: worse than the noise, by little.
  EXPECT_LT(campaign.mean_distance(), 3 * kTrackerNoise_mm);
  EXPECT_TRUE(result.total.converged);
  ASSERT_GT(result.total.covariance.size(), 0);
  for (const EstimatedParameter& parameter : result.stages[1].parameters)
    if (parameter.id.is_machine()) {
      EXPECT_LT(parameter.id.index, 6u * 5u);  // C comes first in the error set
    }
  // What the second stage took over from the first adds to its uncertainty.
  bool larger = false;
  for (std::size_t i = 0; i < result.stages[1].parameters.size(); ++i) {
    const Eigen::Index k =
        static_cast<Eigen::Index>(find_estimated(campaign.problem, result.stages[1].parameters[i].id));
    const double alone = result.stages[1].standard_uncertainties[static_cast<Eigen::Index>(i)];
    EXPECT_GE(result.total.standard_uncertainties[k], alone * (1 - 1e-9));
    larger = larger || result.total.standard_uncertainties[k] > 1.2 * alone;
  }
  EXPECT_TRUE(larger);
}

SolverOptions summed_by(PieceSummer& summer) {
  SolverOptions options;
  options.summation = [&](const SumRequest& request, const std::stop_token&) {
    std::vector<SumOfReadings> parts;
    for (const std::size_t process : {2, 0, 1}) {
      parts.push_back(summer.sum(request, share_of_pieces(request.pieces, process, 3), {.threads = 1}));
    }
    return merge_all(std::move(parts));
  };
  return options;
}

TEST(Strategies, have_the_same_bits_where_their_readings_are_summed_elsewhere) {
  for (const Strategy strategy : {Strategy::joint, Strategy::independent, Strategy::combined}) {
    const auto poses = two_tests(strategy != Strategy::independent);
    Campaign here(poses, 5), there(poses, 5);
    const Campaign elsewhere(poses, 5);
    PieceSummer summer(elsewhere.problem);
    const StagedIdentification a = identify_in_stages(here.problem, strategy);
    const StagedIdentification b = identify_in_stages(there.problem, strategy, {.solver = summed_by(summer)});
    EXPECT_EQ(a.total.estimates, b.total.estimates);
    EXPECT_EQ(a.total.covariance, b.total.covariance);
    EXPECT_EQ(a.total.message, b.total.message);
    ASSERT_GT(b.total.covariance.size(), 0);
  }
}

TEST(Strategies, refuse_sums_of_a_model_that_differs_only_where_there_are_errors) {
  Campaign here(two_tests(true), 5), elsewhere(two_tests(true), 5);
  ErrorSet start = elsewhere.problem.errors;
  start.motions.back().basis.to *= 1.001;
  TrackerObservations other(elsewhere.given.machine, start, elsewhere.given.setup, elsewhere.readings);
  elsewhere.problem.observations[0].observations = borrowed(other);
  PieceSummer summer(elsewhere.problem);
  EXPECT_THROW(identify_in_stages(here.problem, Strategy::joint, {.solver = summed_by(summer)}), SumError);
}

TEST(OrderSelection, stops_at_the_orders_of_the_truth) {
  std::vector<std::vector<double>> poses;
  RandomStream random(8);
  for (int i = 0; i < 120; ++i)
    poses.push_back({random.uniform(0, 6.28), random.uniform(0, 1400), random.uniform(0, 600)});
  const Campaign campaign(poses, 7, 4);
  const std::vector<OrderGroup> groups = order_groups_by_axis(campaign.problem.machine, campaign.problem.errors);
  ASSERT_EQ(groups.size(), 3u);
  OrderSelectionOptions options;
  options.folds = 3;
  const OrderSelection selection = select_orders(campaign.problem, groups, options);
  ASSERT_TRUE(selection.done);
  EXPECT_EQ(selection.orders, (std::vector<int>{1, 2, 2}));
  EXPECT_GE(selection.trials.size(), 5u);
  EXPECT_GT(selection.trials.front().held_out_rms, 2);
  double best = 1e9;
  for (const OrderTrial& trial : selection.trials)
    if (trial.accepted) best = std::min(best, trial.held_out_rms);
  EXPECT_NEAR(best, 1, 0.15);
  EXPECT_EQ(selection.machine_parameters.size(), 6u * 3 + 6u * 3 + 6u * 3);
}

}  // namespace
}  // namespace abbe
