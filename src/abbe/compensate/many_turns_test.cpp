#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/compensate/one_pose_for_test.h"
#include "abbe/compensate/program/errors_for_test.h"

namespace abbe {
namespace {

TEST(ManyTurns, CorrectionsOfEndlessAxesAreThoseOfTurnZero) {
  for (const test::NamedMachine& named : test::all_machines()) {
    const Machine& machine = named.machine;
    const CompensatedInverse inverse(machine, test::tens_of_micrometres(machine, 3));
    std::mt19937_64 generator(7);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      if (!machine.axes[i].endless) continue;
      for (const double turns : {1000.0, -1000.0, 30000.0, 100000.0, -100000.0}) {
        for (int k = 0; k < 50; ++k) {
          const std::vector<double> zero = test::inner_commands(machine, generator);
          std::vector<double> far = zero;
          far[i] += 2 * std::numbers::pi * turns;
          CorrectionStatus status = CorrectionStatus::not_run, expected = CorrectionStatus::not_run;
          const std::vector<double> at_zero = test::corrected(inverse, zero, expected);
          const std::vector<double> there = test::corrected(inverse, far, status);
          EXPECT_EQ(status, expected) << named.name << " " << machine.axes[i].name << " " << turns;
          if (expected != CorrectionStatus::reached) continue;
          // The command itself is rounded by half of its last digit; near singularities turns are known less well.
          const double spare = 1e-9 + 2e-16 * std::abs(far[i]);
          EXPECT_NEAR(there[i] - far[i], at_zero[i] - zero[i], spare + 1e-6 * std::abs(at_zero[i] - zero[i]));
        }
      }
    }
  }
}

}  // namespace
}  // namespace abbe
