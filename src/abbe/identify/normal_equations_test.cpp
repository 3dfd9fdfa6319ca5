#include "abbe/identify/normal_equations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/identify.h"

namespace abbe {
namespace {

using Complex = FunctionObservations::Complex;

Complex wave_and_decay(std::size_t k, std::size_t row, const std::vector<Complex>& b) {
  const double t = static_cast<double>(k) / 300;
  if (row == 0) return b[0] + b[1] * t + std::sin(b[2] * t);
  return b[3] * std::exp(-b[4] * t);
}

std::vector<double> data(std::size_t readings, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<double> values;
  const std::vector<Complex> truth = {1, 2, 3, 4, 0.7};
  for (std::size_t k = 0; k < readings; ++k)
    for (std::size_t r = 0; r < 2; ++r) values.push_back(wave_and_decay(k, r, truth).real() + 0.05 * random.normal());
  return values;
}

TEST(CrossProducts, agree_with_plain_sums_for_every_padded_size) {
  RandomStream random(7);
  for (const std::size_t count : {4, 8, 20, 64})
    for (const std::size_t length : {8, 24, 384, 1032}) {
      const std::size_t stride = length + 8;
      std::vector<double> a(count * stride), b(12 * stride);
      for (double& value : a) value = random.normal();
      for (double& value : b) value = random.normal();
      std::vector<double> own(count * count, 1.0), cross(count * 10, 2.0);
      add_self_products(a.data(), count, stride, length, own.data(), count);
      add_cross_products(a.data(), count, stride, b.data(), 10, stride, length, cross.data(), count);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
          double sum = 1;
          for (std::size_t k = 0; k < length; ++k) sum += a[i * stride + k] * a[j * stride + k];
          ASSERT_NEAR(own[i + j * count], sum, 1e-12 * static_cast<double>(length));
        }
        for (std::size_t j = 0; j < 10; ++j) {
          double sum = 2;
          for (std::size_t k = 0; k < length; ++k) sum += a[i * stride + k] * b[j * stride + k];
          ASSERT_NEAR(cross[i + j * count], sum, 1e-12 * static_cast<double>(length));
        }
      }
    }
}

TEST(CrossProducts, fold_the_rows_of_all_pairs_and_of_a_triangle) {
  RandomStream random(8);
  for (const std::size_t rows : {1, 3})
    for (const std::size_t count : {1, 5, 128})
      for (std::size_t others = 1; others <= 9; ++others) {
        constexpr std::size_t kOut = 128, kColumns = 9;
        const std::size_t length = rows * count + kLengthMultiple;
        std::vector<double> values(2 * kColumns * length);
        for (double& value : values) value = random.normal();
        std::vector<const double*> a, b;
        for (std::size_t i = 0; i < kColumns; ++i) a.push_back(&values[i * length]);
        for (std::size_t i = 0; i < others; ++i) b.push_back(&values[(kColumns + i) * length]);
        for (const bool triangle : {false, true}) {
          const std::vector<const double*>& left = triangle ? b : a;
          const std::size_t begin = others / 3, end = left.size();
          std::vector<double> out((kColumns * kColumns + 1) * kOut, -7.0);
          fold_products(left.data(), begin, end, b.data(), others, triangle, rows, count, out.data(), kOut);
          std::size_t column = 0;
          for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = triangle ? i : 0; j < others; ++j, ++column)
              for (std::size_t k = 0; k < count; ++k) {
                double sum = 0;
                for (std::size_t r = 0; r < rows; ++r) sum += left[i][r * count + k] * b[j][r * count + k];
                ASSERT_NEAR(out[column * kOut + k], sum, 1e-14) << others << " columns, " << i << ", " << j;
              }
          EXPECT_EQ(out[column * kOut], -7.0) << "wrote past the last column";
        }
      }
}

TEST(NormalEquations, sums_agree_with_the_stored_jacobian_and_leave_out_what_is_masked) {
  FunctionObservations first(5, 2, data(300, 1), 0.05, wave_and_decay),
      second(5, 2, data(131, 2), 0.05, wave_and_decay);
  first.start({0.9, 2.1, 2.9, 4.2, 0.8});
  second.start({1.1, 1.9, 3.1, 3.9, 0.6});
  Problem problem = function_problem({&first, &second});
  problem.observations[1].unknowns = {0, 2, 4};
  problem.observations[0].use.assign(300, 1);
  for (std::size_t k = 0; k < 300; k += 3) problem.observations[0].use[k] = 0;
  for (std::size_t k = 128; k < 256; ++k) problem.observations[0].use[k] = 0;  // one whole block
  first.data()[0] = std::nan("");                                              // left out, so harmless
  problem.priors.push_back({{1, 2}, 3.0, 0.5});
  const Eigen::VectorXd x = present_values(problem);
  const NormalEquations sums = ReadingStream(problem, 2).sums(x, Loss{}, Wanted::normal);
  ASSERT_TRUE(sums.finite);

  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(8, 8);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(8);
  double cost = 0;
  for (std::size_t o = 0; o < 2; ++o) {
    const SelectedObservations& selected = problem.observations[o];
    for (std::size_t k = 0; k < selected.observations->reading_count(); ++k) {
      if (!selected.use.empty() && !selected.use[k]) continue;
      double residuals[2];
      std::vector<double> jacobian(10);
      selected.observations->evaluate(k, 1, {}, selected.unknowns, residuals, jacobian.data(), 2);
      for (std::size_t r = 0; r < 2; ++r) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(8);
        for (std::size_t c = 0; c < selected.unknowns.size(); ++c)
          row[static_cast<Eigen::Index>(o * 5 + c)] = jacobian[c * 2 + r];
        normal += row * row.transpose();
        gradient += row * residuals[r];
        cost += residuals[r] * residuals[r] / 2;
      }
    }
  }
  normal(6, 6) += 4;
  gradient[6] += (3.0 - x[6]) / 0.25;
  cost += std::pow((3.0 - x[6]) / 0.5, 2) / 2;
  EXPECT_LT((sums.normal - normal).norm(), 1e-12 * normal.norm());
  EXPECT_LT((sums.gradient - gradient).norm(), 1e-12 * gradient.norm());
  EXPECT_NEAR(sums.cost, cost, 1e-12 * cost);

  const NormalEquations only_gradient = ReadingStream(problem, 1).sums(x, Loss{}, Wanted::gradient);
  EXPECT_LT((only_gradient.gradient - gradient).norm(), 1e-12 * gradient.norm());
  const Eigen::MatrixXd factor = ReadingStream(problem, 2).orthogonal_factor(x, Loss{});
  EXPECT_LT((factor.transpose() * factor - normal).norm(), 1e-12 * normal.norm());
}

TEST(NormalEquations, gradient_is_the_slope_of_the_robust_cost) {
  FunctionObservations observations(5, 2, data(200, 3), 0.05, wave_and_decay);
  observations.start({0.9, 2.1, 2.9, 4.2, 0.8});
  const Problem problem = function_problem({&observations});
  const ReadingStream stream(problem, 1);
  const Eigen::VectorXd x = present_values(problem);
  for (const LossKind kind : {LossKind::none, LossKind::huber, LossKind::cauchy, LossKind::tukey}) {
    const Loss loss{kind, 0, 1.5};
    const Eigen::VectorXd gradient = stream.sums(x, loss, Wanted::gradient).gradient;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::VectorXd forward = x, backward = x;
      forward[i] += 1e-6;
      backward[i] -= 1e-6;
      const double slope =
          (stream.sums(forward, loss, Wanted::cost).cost - stream.sums(backward, loss, Wanted::cost).cost) / 2e-6;
      EXPECT_NEAR(-slope, gradient[i], 1e-5 * std::max(1.0, gradient.norm()));
    }
  }
}

TEST(NormalEquations, every_number_of_threads_gives_the_same_bits) {
  std::vector<Eigen::VectorXd> estimates;
  std::vector<Eigen::MatrixXd> covariances;
  for (const int threads : {1, 3, 8}) {
    // 48 pieces of 128 readings, and a last one that is shorter
    FunctionObservations observations(5, 2, data(6200, 4), 0.05, wave_and_decay);
    observations.start({0.9, 2.1, 2.9, 4.2, 0.8});
    Problem problem = function_problem({&observations});
    IdentifyOptions options;
    options.solver.threads = threads;
    options.loss = LossKind::huber;
    const Identification result = identify(problem, options);
    ASSERT_EQ(result.status, IdentifyStatus::converged);
    estimates.push_back(result.estimates);
    covariances.push_back(result.covariance);
  }
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    EXPECT_TRUE((estimates[i].array() == estimates[0].array()).all());
    EXPECT_TRUE((covariances[i].array() == covariances[0].array()).all());
  }
}

}  // namespace
}  // namespace abbe
