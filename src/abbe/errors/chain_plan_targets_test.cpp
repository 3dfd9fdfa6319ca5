#include <gtest/gtest.h>

#include <numeric>

#include "abbe/errors/chain_kernel_targets.h"
#include "abbe/errors/chain_plan_cases.h"
#include "hwy/highway.h"
#include "hwy/targets.h"

namespace abbe {
namespace {

using chain_cases::Batch;
using chain_cases::Case;
using chain_cases::random_case;

/// Lets HWY_DYNAMIC_DISPATCH choose among the given targets only, until destroyed.
struct OnlyTargets {
  explicit OnlyTargets(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  ~OnlyTargets() {
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST(ChainPlanTargets, EveryProcessorGenerationGivesTheSameToRounding) {
  const std::int64_t available = hwy::SupportedTargets() & HWY_TARGETS;
  int compared = 0;
  for (std::int64_t rest = available; rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    ++compared;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const Case c = random_case(seed, 0.1);
      const ChainPlan plan(c.machine, c.errors, Body::tool, Body::workpiece);
      RandomStream random(seed);
      Batch best(c.machine, 128, random), other = best;
      best.transform(plan);
      std::vector<std::size_t> parameters(c.errors.parameter_count());
      std::iota(parameters.begin(), parameters.end(), std::size_t{0});
      const std::vector<double> one(128, 1.0), none(128, 0.0);
      const RowArrays row{{one.data(), none.data(), one.data()}, {one.data(), one.data(), none.data()}};
      std::vector<double> best_jacobian(parameters.size() * 128), jacobian = best_jacobian;
      const std::size_t axes = c.machine.axes.size();
      std::vector<double> best_by_position(axes * 128), by_position = best_by_position;
      plan.differentiate(best.positions(), best.start_arrays(), best.const_seen(), {&row, 1}, parameters,
                         best_jacobian.data(), 128, nullptr, best_by_position.data());
      {
        const OnlyTargets only(target);
        other.transform(plan);
        plan.differentiate(best.positions(), best.start_arrays(), best.const_seen(), {&row, 1}, parameters,
                           jacobian.data(), 128, nullptr, by_position.data());
      }
      for (std::size_t k = 0; k < 128; ++k) {
        EXPECT_LE((best.seen_point(k) - other.seen_point(k)).norm(), 2e-12) << hwy::TargetName(target);
        EXPECT_LE((best.rotation_matrix(k) - other.rotation_matrix(k)).norm(), 1e-14) << hwy::TargetName(target);
      }
      for (std::size_t i = 0; i < jacobian.size(); ++i) EXPECT_NEAR(jacobian[i], best_jacobian[i], 1e-10);
      for (std::size_t i = 0; i < by_position.size(); ++i) EXPECT_NEAR(by_position[i], best_by_position[i], 1e-10);
    }
  }
  EXPECT_GE(compared, 1);
}

}  // namespace
}  // namespace abbe
