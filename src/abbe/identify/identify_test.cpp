#include "abbe/identify/identify.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <set>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/kept_blocks_for_test.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/trust/monte_carlo.h"
#include "abbe/identify/trust/prediction.h"

namespace abbe {
namespace {

using Complex = FunctionObservations::Complex;
const std::vector<double> kTruth = {2, 0.8, 0.3, -1};

Complex decay_and_line(std::size_t k, std::size_t row, const std::vector<Complex>& b) {
  const double t = static_cast<double>(k % 50) / 25;
  return row == 0 ? b[0] * std::exp(-b[1] * t) + b[2] : b[3] * t + b[2] * b[2];
}

std::vector<double> simulate(std::uint64_t seed, std::size_t readings = 50, double noise = 0.02) {
  RandomStream random(seed);
  const std::vector<Complex> truth(kTruth.begin(), kTruth.end());
  std::vector<double> data;
  for (std::size_t k = 0; k < readings; ++k)
    for (std::size_t r = 0; r < 2; ++r) data.push_back(decay_and_line(k, r, truth).real() + noise * random.normal());
  return data;
}

struct Fit {
  FunctionObservations observations;
  Problem problem;
  explicit Fit(std::vector<double> data, double uncertainty = 0.02)
      : observations(4, 2, std::move(data), uncertainty, decay_and_line) {
    observations.start({1, 1, 0.5, 0});
    problem = function_problem({&observations});
  }
};

TEST(Identify, intervals_cover_the_truth_in_about_95_percent_of_campaigns) {
  int inside = 0, total = 0;
  double chi_square = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Fit fit(simulate(seed));
    const Identification result = identify(fit.problem);
    ASSERT_EQ(result.status, IdentifyStatus::converged);
    chi_square += result.statistics.chi_square / result.statistics.degrees_of_freedom;
    for (Eigen::Index i = 0; i < 4; ++i, ++total)
      inside +=
          std::abs(result.estimates[i] - kTruth[static_cast<std::size_t>(i)]) < 1.96 * result.standard_uncertainties[i];
  }
  EXPECT_NEAR(static_cast<double>(inside) / total, 0.95, 0.02);
  EXPECT_NEAR(chi_square / 400, 1, 0.02);
}

TEST(Identify, p_values_are_uniform_when_the_model_is_right) {
  int below = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Fit fit(simulate(seed + 5000));
    below += identify(fit.problem).statistics.p_value < 0.2;
  }
  EXPECT_NEAR(below / 400.0, 0.2, 0.06);
}

TEST(Identify, covariance_is_the_inverse_of_the_curvature_of_the_cost) {
  Fit fit(simulate(9, 50, 1e-7));  // nearly no residuals: curvature and J'J agree
  const Identification result = identify(fit.problem);
  ASSERT_EQ(result.status, IdentifyStatus::converged);
  const auto cost = [&](const Eigen::VectorXd& x) {
    set_observations(fit.problem, x);
    double sum = 0;
    for (const double r : residuals_by_reading(fit.observations)) sum += r * r / 2;
    return sum;
  };
  Eigen::MatrixXd curvature(4, 4);
  const double h = 1e-3;
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 4; ++j) {
      double sum = 0;
      for (const double si : {1.0, -1.0})
        for (const double sj : {1.0, -1.0}) {
          Eigen::VectorXd x = result.estimates;
          x[i] += si * h;
          x[j] += sj * h;
          sum += si * sj * cost(x);
        }
      curvature(i, j) = sum / (4 * h * h);
    }
  const Eigen::MatrixXd inverse = PartialLu(curvature).inverse();
  EXPECT_LT((inverse - result.covariance).norm(), 1e-3 * inverse.norm());
}

TEST(Identify, the_variance_factor_is_stated_and_applied_only_on_request) {
  Fit plain(simulate(4, 50, 0.06)), applied(simulate(4, 50, 0.06));
  const Identification a = identify(plain.problem);
  IdentifyOptions options;
  options.apply_variance_factor = true;
  const Identification b = identify(applied.problem, options);
  EXPECT_NEAR(a.statistics.variance_factor, 9, 2.5);
  EXPECT_LT(a.statistics.p_value, 1e-6);
  EXPECT_LT((a.covariance * a.statistics.variance_factor - b.covariance).norm(), 1e-12 * b.covariance.norm());
}

TEST(Identify, a_prior_acts_like_one_more_reading) {
  Fit free(simulate(5)), with_prior(simulate(5));
  const Identification a = identify(free.problem);
  const double u = a.standard_uncertainties[1];
  with_prior.problem.priors.push_back({{0, 1}, a.estimates[1] + 4 * u, u});
  const Identification b = identify(with_prior.problem);
  EXPECT_NEAR(b.estimates[1], a.estimates[1] + 2 * u, 0.1 * u);
  EXPECT_NEAR(b.standard_uncertainties[1], u / std::sqrt(2.0), 0.05 * u);
  EXPECT_EQ(b.statistics.residual_count, a.statistics.residual_count + 1);
}

TEST(Identify, a_joint_prior_replaces_the_readings_it_came_from) {
  std::vector<double> all = simulate(6, 100);
  Fit whole(all), first(std::vector<double>(all.begin(), all.begin() + 100)),
      second(std::vector<double>(all.begin() + 100, all.end()));
  const Identification together = identify(whole.problem);
  const Identification one = identify(first.problem);
  JointPrior prior;
  for (const EstimatedParameter& parameter : one.parameters) prior.parameters.push_back(parameter.id);
  prior.value = one.estimates;
  prior.information = PartialLu(one.covariance).inverse();
  prior.residual_count = 4;
  second.problem.joint_priors.push_back(prior);
  const Identification two = identify(second.problem);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(two.estimates[i], together.estimates[i], 0.05 * together.standard_uncertainties[i]);
    EXPECT_NEAR(two.standard_uncertainties[i], together.standard_uncertainties[i],
                0.02 * together.standard_uncertainties[i]);
  }
}

TEST(Identify, failures_have_their_status_and_leave_the_start) {
  Fit few(simulate(1, 1));
  EXPECT_EQ(identify(few.problem).status, IdentifyStatus::too_few_readings);
  Fit limited(simulate(1));
  IdentifyOptions options;
  options.solver.max_iterations = 2;
  const Identification stopped = identify(limited.problem, options);
  EXPECT_EQ(stopped.status, IdentifyStatus::no_convergence);
  EXPECT_FALSE(stopped.converged);
  EXPECT_GT(stopped.covariance.size(), 0);  // of where it stopped, which is no minimum
  std::vector<double> broken = simulate(1);
  broken[7] = std::nan("");
  Fit not_finite(broken);
  const Identification result = identify(not_finite.problem);
  EXPECT_EQ(result.status, IdentifyStatus::not_finite);
  EXPECT_EQ(result.estimates.size(), 0);
  EXPECT_EQ(not_finite.observations.unknown_values(), (std::vector<double>{1, 1, 0.5, 0}));
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(Identification{}.status, IdentifyStatus::not_run);
  EXPECT_FALSE(Identification{}.converged);
}

TEST(Identify, all_readings_at_one_place_are_rank_deficient) {
  const auto same_place = [](std::size_t, std::size_t row, const std::vector<Complex>& b) {
    return decay_and_line(20, row, b);
  };
  for (const GaugeChoice gauge : {GaugeChoice::iso, GaugeChoice::none}) {
    FunctionObservations observations(4, 2, std::vector<double>(200, 1.0), 0.02, same_place);
    observations.start({1, 1, 0.5, 0.2});
    Problem problem = function_problem({&observations});
    IdentifyOptions options;
    options.gauge = gauge;
    const Identification result = identify(problem, options);
    EXPECT_EQ(result.gauge.rank_at_start, 2u);
    EXPECT_EQ(result.status, gauge == GaugeChoice::none ? IdentifyStatus::rank_deficient : IdentifyStatus::converged);
    EXPECT_EQ(result.converged, gauge != GaugeChoice::none);
    // With set-up unknowns only, the convention keeps start values and says so.
    EXPECT_EQ(result.gauge.constraints.size(), gauge == GaugeChoice::none ? 0u : 2u);
  }
}

TEST(Identify, held_out_readings_have_the_stated_spread) {
  double square = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Fit fit(simulate(seed));
    fit.problem.observations[0].use.assign(50, 1);
    for (std::size_t k = 0; k < 50; k += 2) fit.problem.observations[0].use[k] = 0;
    const Identification result = identify(fit.problem);
    for (const HeldOutReading& reading : held_out_readings(fit.problem, result)) {
      EXPECT_EQ(reading.reading % 2, 0u);
      square += reading.normalised_square;
      count += 2;
    }
  }
  EXPECT_NEAR(square / count, 1, 0.05);
}

TEST(MonteCarlo, agrees_with_repeated_identification_of_simulated_data) {
  // Strong noise, so that the nonlinearity shows: the mean moves away from the estimate.
  const double noise = 0.1;
  Fit truth(simulate(1, 50, 0), noise);
  truth.observations.start(kTruth);
  const Identification solution = identify(truth.problem);
  MonteCarloOptions options;
  options.samples = 4000;
  options.chord_iterations = 3;
  const Eigen::MatrixXd prediction = Eigen::MatrixXd::Identity(4, 4).topRows(2);
  const MonteCarloResult simulated = monte_carlo(truth.problem, solution, options, &prediction);
  ASSERT_EQ(simulated.status, MonteCarloStatus::done);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(4), square = Eigen::VectorXd::Zero(4);
  const int repetitions = 2000;
  for (int i = 0; i < repetitions; ++i) {
    Fit fit(simulate(static_cast<std::uint64_t>(i) + 100, 50, noise), noise);
    fit.observations.start(kTruth);
    const Identification one = identify(fit.problem);
    ASSERT_EQ(one.status, IdentifyStatus::converged);
    sum += one.estimates;
    square += one.estimates.cwiseAbs2();
  }
  const Eigen::VectorXd mean = sum / repetitions;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double spread = std::sqrt(square[i] / repetitions - mean[i] * mean[i]);
    EXPECT_NEAR(std::sqrt(simulated.covariance(i, i)), spread, 0.08 * spread) << i;
    EXPECT_NEAR(simulated.mean[i], mean[i], 0.12 * spread) << i;
    EXPECT_LT(simulated.percentiles(i, 0), simulated.percentiles(i, 1));
    EXPECT_NEAR(simulated.percentiles(i, 2) - simulated.percentiles(i, 0), 3.92 * spread, 0.5 * spread);
  }
  EXPECT_NEAR(simulated.prediction_uncertainty[1], std::sqrt(simulated.covariance(1, 1)), 1e-12);
}

TEST(MonteCarlo, results_of_batches_can_come_from_elsewhere) {
  Fit fit(simulate(3));
  const Identification solution = identify(fit.problem);
  MonteCarloOptions options;
  options.samples = 200;
  const MonteCarloResult alone = monte_carlo(fit.problem, solution, options);
  test::KeptBlocks kept;
  options.work = kept.keeping();
  monte_carlo(fit.problem, solution, options);
  options.work = kept.giving();
  const MonteCarloResult given = monte_carlo(fit.problem, solution, options);
  EXPECT_EQ(given.mean, alone.mean);
  EXPECT_EQ(given.covariance, alone.covariance);
  EXPECT_EQ(given.percentiles, alone.percentiles);

  options.work = kept.keeping();
  options.seed = 2;
  monte_carlo(fit.problem, solution, options);
  options.samples = 201;
  monte_carlo(fit.problem, solution, options);
  Fit other(simulate(4));
  monte_carlo(other.problem, identify(other.problem), options);
  // Of the samples, their moments and their percentiles.
  EXPECT_EQ(std::set<std::uint64_t>(kept.fingerprints.begin(), kept.fingerprints.end()).size(), 3 * 4u);
}

TEST(MonteCarlo, does_not_depend_on_threads_and_matches_the_covariance_for_small_noise) {
  Fit fit(simulate(3));
  const Identification solution = identify(fit.problem);
  MonteCarloOptions options;
  options.samples = 3000;
  options.threads = 1;
  const MonteCarloResult one = monte_carlo(fit.problem, solution, options);
  options.threads = 3;
  const MonteCarloResult three = monte_carlo(fit.problem, solution, options);
  EXPECT_EQ(one.covariance, three.covariance);
  EXPECT_EQ(one.percentiles, three.percentiles);
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(std::sqrt(one.covariance(i, i)) / solution.standard_uncertainties[i], 1, 0.06);
}

}  // namespace
}  // namespace abbe
