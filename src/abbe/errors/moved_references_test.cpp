#include "abbe/errors/moved_references.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "abbe/machine/chain.h"

namespace abbe {
namespace {

constexpr double kStays = std::numeric_limits<double>::quiet_NaN();

Machine mill_of_moved_references() {
  Machine mill = parse_chain("w X' Y' b Z t").machine;
  mill.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
  mill.states.push_back({.name = "ram", .kind = StateKind::axis, .reference = 30, .axis = 2});
  mill.states.push_back({.name = "payload", .unit = "kg"});
  mill.states.push_back({.name = "bending", .kind = StateKind::product, .first = 2, .second = 1});
  mill.states.push_back({.name = "loaded", .kind = StateKind::product, .first = 2, .second = 0});
  return mill;
}

ErrorSet errors_of_moved_references() {
  ErrorSet errors;
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = -250, .to = 250};
  Basis cubic = line;
  cubic.order = 3;
  errors.motions.push_back({0, Component::X, cubic, {0.001, 0.002, -0.003, 0.004}, {}});
  errors.motions.push_back({0, Component::X, line, {0.0, 0.004}, {}, 0});
  errors.motions.push_back({0, Component::X, line, {1e-4, -3e-4}, {}, 4});
  errors.motions.push_back({1, Component::A, line, {1e-6, 2e-6}, {}, 3});
  errors.locations.push_back({1, Component::C, 1e-5, 1.5e-6, 0});
  errors.locations.push_back({2, Component::A, 2e-6, 0, 3});
  errors.tool_offset_error = {0.01, 0.02, 0.03};
  return errors;
}

/// Location errors and motions at a state, by their definition: coefficients times functions times the factor.
double value_of(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                const std::vector<double>& given, std::size_t axis, Component component, bool is_location) {
  const std::vector<double> factors = state_factors(machine, commands, given);
  if (!is_location) return errors.evaluate(axis, commands[axis], factors)[static_cast<std::size_t>(component)];
  double sum = 0;
  for (const LocationError& one : errors.locations) {
    if (one.axis != axis || one.component != component) continue;
    sum += one.value * (one.state == kNoState ? 1 : factors[one.state]);
  }
  return sum;
}

TEST(MovedReferences, ErrorsAtEveryStateStayWhatTheyAre) {
  const Machine machine = mill_of_moved_references();
  const ErrorSet errors = errors_of_moved_references();
  const std::vector<double> references = {26.5, kStays, 4, kStays, kStays};
  const ErrorSet moved = with_references(machine, errors, references);
  const Machine there = with_references(machine, references);
  EXPECT_EQ(there.states[0].reference, 26.5);
  EXPECT_EQ(there.states[1].reference, 30);
  for (const double ambient : {12.0, 20.0, 26.5, 31.0}) {
    for (const double payload : {0.0, 4.0, 11.0}) {
      const std::vector<double> given = {ambient, kStays, payload, kStays, kStays}, commands = {-180, 70, 110};
      const auto same = [&](std::size_t axis, Component component, bool is_location) {
        EXPECT_NEAR(value_of(there, moved, commands, given, axis, component, is_location),
                    value_of(machine, errors, commands, given, axis, component, is_location), 1e-15);
      };
      same(0, Component::X, false);
      same(1, Component::A, false);
      same(1, Component::C, true);
      same(2, Component::A, true);
    }
  }
  // EXX has grown no term: the line is the beginning of the cubic.
  EXPECT_EQ(moved.motions[0].coefficients.size(), 4U);
  EXPECT_EQ(moved.motions[0].coefficients[3], 0.004);
  EXPECT_NEAR(moved.motions[0].coefficients[1], 0.002 + 6.5 * 0.004 + 4 * 6.5 * -3e-4, 1e-15);
  EXPECT_EQ(moved.tool_offset_error, errors.tool_offset_error);
}

TEST(MovedReferences, ParametersFollowByTheMatrixAndComeBack) {
  const Machine machine = mill_of_moved_references();
  const ErrorSet errors = errors_of_moved_references();
  const std::vector<double> references = {26.5, kStays, 4, kStays, kStays};
  Eigen::MatrixXd there, back;
  const ErrorSet moved = with_references(machine, errors, references, &there);
  ASSERT_EQ(static_cast<std::size_t>(there.rows()), moved.parameter_count());
  const std::vector<double> before = errors.parameters(), after = moved.parameters();
  const Eigen::VectorXd by_matrix =
      there * Eigen::Map<const Eigen::VectorXd>(before.data(), static_cast<Eigen::Index>(before.size()));
  for (std::size_t p = 0; p < after.size(); ++p) EXPECT_NEAR(by_matrix[static_cast<Eigen::Index>(p)], after[p], 1e-16);
  const std::vector<double> home = {20, kStays, 0, kStays, kStays};
  const ErrorSet returned = with_references(with_references(machine, references), moved, home, &back);
  ASSERT_EQ(static_cast<std::size_t>(back.cols()), after.size());
  // What has become a term of its own is zero again.
  for (const ErrorMotion& motion : errors.motions) {
    EXPECT_TRUE(std::any_of(returned.motions.begin(), returned.motions.end(), [&](const ErrorMotion& one) {
      if (one.basis != motion.basis || one.state != motion.state || one.component != motion.component) return false;
      for (std::size_t k = 0; k < one.coefficients.size(); ++k) {
        if (std::abs(one.coefficients[k] - motion.coefficients[k]) > 1e-15) return false;
      }
      return true;
    }));
  }
}

TEST(MovedReferences, NothingMovesWhereTheReferencesStay) {
  const Machine machine = mill_of_moved_references();
  const ErrorSet errors = errors_of_moved_references();
  const std::vector<double> home = {20, kStays, 0, kStays, kStays};
  Eigen::MatrixXd by_parameters;
  const ErrorSet moved = with_references(machine, errors, home, &by_parameters);
  EXPECT_EQ(moved.parameters(), errors.parameters());
  EXPECT_EQ(moved.motions, errors.motions);
  EXPECT_TRUE(by_parameters.isIdentity(0));
}

}  // namespace
}  // namespace abbe
