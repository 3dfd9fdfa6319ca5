#include "abbe/compensate/program_uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/compensate/corrected_node.h"
#include "abbe/compensate/program_moves_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

ErrorSet with_uncertainties(const Machine& machine, std::uint64_t seed) {
  ErrorSet errors = test::mixed_errors(machine, seed);
  double u = 1;
  for (ErrorMotion& motion : errors.motions) {
    const double unit = is_rotation(motion.component) ? 1e-6 : 5e-4;
    for (std::size_t i = 0; i < motion.coefficients.size(); ++i) motion.standard_uncertainty.push_back(unit * u);
    u = u > 2 ? 0.5 : u + 0.3;
  }
  for (LocationError& location : errors.locations)
    location.standard_uncertainty = is_rotation(location.component) ? 2e-6 : 1e-3;
  return errors;
}

TEST(ProgramUncertainty, EqualsThatOfCorrectionsWithErrorsShiftedOneByOne) {
  const Machine machine = test::head_table_mill();
  const ErrorSet errors = with_uncertainties(machine, 3);
  const WordAxes words = test::words_of(machine);
  std::mt19937_64 generator(2);
  CorrectedNode node;
  node.words = test::random_axis_words(machine, words, generator);
  const std::array<double, 3> length = {0, 0, 40};
  const auto corrected = [&](const ErrorSet& set) {
    NodeCorrection correction(machine, set, words, {}, {});
    CorrectedNode there = node;
    correction.correct(ProgramCoordinates::axes, correction.tool(length), {&there, 1});
    EXPECT_EQ(there.status, CorrectionStatus::reached);
    return there;
  };
  const CorrectedNode at = corrected(errors);
  const Eigen::MatrixXd covariance = parameter_covariance(errors, {});
  std::vector<double> parameters = errors.parameters();
  std::vector<double> variance(machine.axes.size(), 0.0);
  double point_variance = 0;
  const Eigen::Vector3d along = Eigen::Vector3d(at.shift[0], at.shift[1], at.shift[2]).normalized();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const auto i = static_cast<Eigen::Index>(p);
    if (covariance(i, i) == 0) continue;
    std::vector<double> shifted = parameters;
    shifted[p] += std::sqrt(covariance(i, i));
    ErrorSet changed = errors;
    changed.set_parameters(shifted);
    const CorrectedNode there = corrected(changed);
    for (std::size_t k = 0; k < variance.size(); ++k) {
      const double change = there.corrected_position[k] - at.corrected_position[k];
      variance[k] += change * change;
    }
    const Eigen::Vector3d moved(there.shift[0] - at.shift[0], there.shift[1] - at.shift[1],
                                there.shift[2] - at.shift[2]);
    point_variance += along.dot(moved) * along.dot(moved);
  }
  ProgramPlace place;
  place.position = at.position;
  place.tool_length = length;
  place.status = CorrectionStatus::reached;
  const PlaceUncertainty stated =
      uncertainty_at(machine, errors, covariance, place, std::vector<bool>(machine.axes.size(), true));
  ASSERT_TRUE(stated.stated);
  ASSERT_TRUE(stated.axes_known);
  for (std::size_t k = 0; k < variance.size(); ++k) {
    EXPECT_NEAR(stated.axis[k], std::sqrt(variance[k]), 0.01 * std::sqrt(variance[k])) << machine.axes[k].name;
  }
  // The shift by the correction holds the turns of the axes too, which carry the point along.
  EXPECT_NEAR(stated.point, std::sqrt(point_variance), 0.02 * stated.point);
}

TEST(ProgramUncertainty, WithoutStatedOnesNothingIsStated) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::mixed_errors(machine, 3);
  const PlaceUncertainty none =
      uncertainty_at(machine, errors, parameter_covariance(errors, {}), {}, std::vector<bool>(3, true));
  EXPECT_FALSE(none.stated);
  ErrorSet all = errors;
  EXPECT_TRUE(leave_out_uncertain(machine, all, parameter_covariance(errors, {}), 2).empty());
  EXPECT_EQ(all.parameters(), errors.parameters());
}

TEST(ProgramUncertainty, ErrorsBelowTheirUncertaintyEverywhereAreLeftOutByName) {
  const Machine machine = test::three_axis_mill();
  const std::size_t x = machine.find_axis("X"), y = machine.find_axis("Y");
  const Axis& travel = machine.axes[x];
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = travel.travel_min, .to = travel.travel_max};
  ErrorSet errors;
  // 1 um everywhere, u 1 um: below 2 u. A line that crosses zero but leaves its uncertainty at the ends stays.
  errors.motions.push_back({x, Component::Y, line, {1e-3, 0}, {1e-3, 0}});
  errors.motions.push_back({x, Component::Z, line, {0, 5e-3}, {1e-3, 0}});
  errors.motions.push_back({x, Component::A, line, {1e-9, 0}, {}});  // nothing is stated about it
  // A slope and its uncertainty are zero together in the middle.
  errors.motions.push_back({x, Component::B, line, {0, 1e-6}, {0, 1e-6}});
  errors.locations.push_back({y, Component::C, 5e-6, 3e-6});
  errors.locations.push_back({y, Component::A, 9e-6, 3e-6});
  ErrorSet kept = errors;
  const std::vector<std::string> names = leave_out_uncertain(machine, kept, parameter_covariance(errors, {}), 2);
  EXPECT_THAT(names, testing::ElementsAre("EYX", "EBX", "EC0Y"));
  EXPECT_EQ(kept.motions[0].coefficients, (std::vector<double>{0, 0}));
  EXPECT_EQ(kept.motions[1].coefficients, errors.motions[1].coefficients);
  EXPECT_EQ(kept.locations[0].value, 0);
  EXPECT_EQ(kept.locations[1].value, 9e-6);
  // Two terms of one motion count together.
  errors.motions.push_back({x, Component::Y, line, {4e-3, 0}, {1e-4, 0}});
  kept = errors;
  EXPECT_THAT(leave_out_uncertain(machine, kept, parameter_covariance(errors, {}), 2),
              testing::ElementsAre("EBX", "EC0Y"));
}

TEST(ProgramUncertainty, ReversalValuesEnterByHalfInTheDirectionOfTheApproach) {
  const Machine machine = test::three_axis_mill();
  const std::size_t x = machine.find_axis("X"), y = machine.find_axis("Y");
  ErrorSet errors;
  errors.locations.push_back({y, Component::C, 50e-6, 0});
  errors.reversals = {{x, -0.012, 0.002}, {y, -0.01, 0.004}};
  const Eigen::MatrixXd covariance = parameter_covariance(errors, {});
  ProgramPlace place;
  place.status = CorrectionStatus::reached;
  place.approach[x] = -1;
  const std::vector<bool> moved(3, true);
  PlaceUncertainty stated = uncertainty_at(machine, errors, covariance, place, moved);
  ASSERT_TRUE(stated.axes_known);
  EXPECT_NEAR(stated.axis[x], 0.001, 1e-6);
  EXPECT_NEAR(stated.axis[y], 0, 1e-6);  // not moved yet: nothing is added for it
  EXPECT_NEAR(stated.point, 0.001, 1e-6);
  place.approach[y] = 1;
  stated = uncertainty_at(machine, errors, covariance, place, moved);
  EXPECT_NEAR(stated.axis[y], 0.002, 1e-6);
}

TEST(ProgramUncertainty, ReversalValuesBelowTheirUncertaintyAreLeftOutByName) {
  const Machine machine = test::three_axis_mill();
  const std::size_t x = machine.find_axis("X"), y = machine.find_axis("Y"), z = machine.find_axis("Z");
  ErrorSet errors;
  errors.locations.push_back({y, Component::C, 50e-6, 3e-6});
  errors.reversals = {{x, -0.002, 0.0015}, {y, -0.004, 0.0015}, {z, 0.001, 0}};
  ErrorSet kept = errors;
  EXPECT_THAT(leave_out_uncertain(machine, kept, parameter_covariance(errors, {}), 2),
              testing::ElementsAre("reversal_X"));
  EXPECT_EQ(kept.reversals[0].value, 0);
  EXPECT_EQ(kept.reversals[1].value, -0.004);
  EXPECT_EQ(kept.reversals[2].value, 0.001);
}

}  // namespace
}  // namespace abbe
