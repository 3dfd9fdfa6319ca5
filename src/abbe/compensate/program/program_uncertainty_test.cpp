#include "abbe/compensate/program/program_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/compensate/tables/corrected_node.h"
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

void compare_with_corrections_with_errors_shifted(const Machine& machine,
                                                  CorrectionStatus status = CorrectionStatus::reached) {
  SCOPED_TRACE(machine.name);
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
    EXPECT_EQ(there.status, status);
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
  place.status = status;
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

TEST(ProgramUncertainty, EqualsThatOfCorrectionsWithErrorsShiftedOneByOne) {
  compare_with_corrections_with_errors_shifted(test::head_table_mill());
}

TEST(ProgramUncertainty, OfAxesThatKeepTheirCommandsIsZeroAndTheOthersTakeAll) {
  // Six axes, of which one is set beforehand.
  compare_with_corrections_with_errors_shifted(test::wang_grinder());
  compare_with_corrections_with_errors_shifted(test::yin_engraver('U'));
}

TEST(ProgramUncertainty, OfAMachineWithOneRotaryAxisIsThatOfTheTurnThatIsNearest) {
  Machine machine = test::trunnion_mill();
  machine.axes.erase(machine.axes.begin() + static_cast<std::ptrdiff_t>(machine.find_axis("C")));
  compare_with_corrections_with_errors_shifted(machine, CorrectionStatus::orientation_left);
}

TEST(ProgramUncertainty, WhereNothingIsCorrectedItIsThatOfTheDirectionInWhichItIsLargest) {
  const Machine machine = test::three_axis_mill();
  const Axis& x = machine.axes[machine.find_axis("X")];
  const Basis constant{.kind = BasisKind::legendre, .order = 0, .from = x.travel_min, .to = x.travel_max};
  ErrorSet errors;
  errors.motions.push_back({machine.find_axis("X"), Component::Y, constant, {0}, {1e-3}});
  errors.motions.push_back({machine.find_axis("X"), Component::Z, constant, {0}, {3e-3}});
  ProgramPlace place;
  place.status = CorrectionStatus::reached;
  const PlaceUncertainty stated =
      uncertainty_at(machine, errors, parameter_covariance(errors, {}), place, std::vector<bool>(3, true));
  EXPECT_NEAR(stated.point, 3e-3, 1e-12);
}

TEST(ProgramUncertainty, WithoutStatedOnesNothingIsStated) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::mixed_errors(machine, 3);
  const PlaceUncertainty none =
      uncertainty_at(machine, errors, parameter_covariance(errors, {}), {}, std::vector<bool>(3, true));
  EXPECT_FALSE(none.stated);
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

}  // namespace
}  // namespace abbe
