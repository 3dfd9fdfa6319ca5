#include "abbe/errors/error_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

Machine mill_with_states() {
  Machine mill = parse_chain("w X' Y' b Z t").machine;
  mill.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
  mill.states.push_back({.name = "ram", .kind = StateKind::axis, .axis = 2});
  mill.states.push_back({.name = "payload", .unit = "kg"});
  mill.states.push_back({.name = "bending", .kind = StateKind::product, .first = 2, .second = 1});
  return mill;
}

ErrorSet errors_with_states() {
  ErrorSet errors;
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = -250, .to = 250};
  errors.motions.push_back({0, Component::X, line, {0.001, 0.002}, {}});
  errors.motions.push_back({0, Component::X, line, {0.0, 0.004}, {0.0, 0.001}, 0});
  errors.motions.push_back({1, Component::A, line, {1e-6, 0.0}, {}, 3});
  errors.locations.push_back({1, Component::C, 3e-5, 4e-6});
  errors.locations.push_back({1, Component::C, 1e-5, 1.5e-6, 0});
  errors.locations.push_back({2, Component::A, 2e-6, 0, 1});
  return errors;
}

TEST(ErrorStates, NamesTellTermsApartByTheirStates) {
  const Machine mill = mill_with_states();
  EXPECT_THAT(parameter_names(mill, errors_with_states()),
              ElementsAre("EXX[P0]", "EXX[P1]", "EXX*ambient[P0]", "EXX*ambient[P1]", "EAY*bending[P0]",
                          "EAY*bending[P1]", "EC0Y", "EC0Y*ambient", "EA0Z*ram", "tool_X", "tool_Y", "tool_Z"));
  EXPECT_EQ(first_error_with_state(mill, errors_with_states()), "EXX*ambient");
  EXPECT_FALSE(has_states(ErrorSet{}));
}

TEST(ErrorStates, ErrorsThatDifferInTheirStateAloneAreNotEqual) {
  ErrorMotion motion = errors_with_states().motions[0], other = motion;
  EXPECT_EQ(motion, other);
  other.state = 0;
  EXPECT_NE(motion, other);
  LocationError location = errors_with_states().locations[0], moved = location;
  moved.state = 1;
  EXPECT_NE(location, moved);
}

TEST(ErrorStates, FoldingLeavesWhatIsComputedAtThePose) {
  const Machine mill = mill_with_states();
  const std::vector<double> values = {22.5, std::nan(""), 4, std::nan("")};
  Eigen::MatrixXd by;
  const ErrorSet folded = at_state(mill, errors_with_states(), values, &by);
  ASSERT_EQ(folded.motions.size(), 3U);
  EXPECT_THAT(folded.motions[1].coefficients, ElementsAre(0.0, DoubleEq(0.01)));
  EXPECT_THAT(folded.motions[1].standard_uncertainty, ElementsAre(0.0, DoubleEq(0.0025)));
  EXPECT_EQ(folded.motions[1].state, kNoState);
  EXPECT_THAT(folded.motions[2].coefficients, ElementsAre(DoubleEq(4e-6), 0.0));
  EXPECT_EQ(folded.motions[2].state, 1U) << "of payload times ram, the ram remains";
  ASSERT_EQ(folded.locations.size(), 2U) << "one squareness, the mean and what the temperature makes of it";
  EXPECT_DOUBLE_EQ(folded.locations[0].value, 5.5e-5);
  EXPECT_DOUBLE_EQ(folded.locations[0].standard_uncertainty, std::hypot(4e-6, 3.75e-6));
  EXPECT_EQ(folded.locations[1].state, 1U);
  EXPECT_EQ(by.rows(), 11);
  EXPECT_EQ(by.cols(), 12);
  EXPECT_DOUBLE_EQ(by(6, 7), 2.5);
  EXPECT_DOUBLE_EQ(by(10, 11), 1);
}

TEST(ErrorStates, FoldingRefusesAStateThatIsNotGiven) {
  const Machine mill = mill_with_states();
  try {
    at_state(mill, errors_with_states(), std::vector<double>{20});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "the state payload is not given");
  }
}

TEST(ErrorStates, MissingStatesAreFoundWithTheFactorsOfProducts) {
  const Machine mill = mill_with_states();
  const ErrorSet errors = errors_with_states();
  PoseList poses;
  poses.append({0, 0, 0});
  poses.append({10, 0, 0});
  EXPECT_EQ(missing_state(mill, errors, poses), 0U);
  poses.state.resize(4);
  poses.state[0] = {20, 21};
  EXPECT_EQ(missing_state(mill, errors, poses), 2U);
  EXPECT_THROW(require_states(mill, errors, poses), std::invalid_argument);
  poses.state[2] = {0, std::nan("")};
  EXPECT_EQ(missing_state(mill, errors, poses), 2U);
  poses.state[2] = {0, 1};
  EXPECT_EQ(missing_state(mill, errors, poses), kNoState);
  EXPECT_EQ(missing_state(mill, ErrorSet{}, PoseList{}), kNoState);
  EXPECT_EQ(reference_words(mill, errors), "ambient 20 degC, payload 0 kg");
}

TEST(ErrorStates, JoinedPosesHaveNoValueWhereOneListHasNone) {
  PoseList first, second;
  first.append({1});
  second.append({2});
  second.state = {{}, {7}};
  join_poses(first, second);
  ASSERT_EQ(first.state.size(), 2U);
  EXPECT_TRUE(first.state[0].empty());
  ASSERT_EQ(first.state[1].size(), 2U);
  EXPECT_TRUE(std::isnan(first.state[1][0]));
  EXPECT_EQ(first.state[1][1], 7);
}

TEST(ErrorStates, PosesThatAreMadeStandAtTheReferences) {
  const Machine mill = mill_with_states();
  PoseList poses;
  poses.append({0, 0, 0});
  poses.state.resize(4);
  poses.state[2] = {3};
  stand_at_references(mill, poses);
  EXPECT_THAT(poses.state, ElementsAre(ElementsAre(20), ElementsAre(), ElementsAre(3), ElementsAre()));
  const PoseSource source = at_states(pose_source(poses), {21, 0, 5, 0});
  double values[4] = {};
  double* out[] = {&values[0], &values[1], &values[2], &values[3]};
  source.fill_states(0, 1, out);
  EXPECT_THAT(values, ElementsAre(21, 0, 5, 0));
}

TEST(ErrorStates, AStateIsNoConstantOfTheGeometry) {
  EXPECT_THROW(calibrated_machine(mill_with_states(), errors_with_states()), std::invalid_argument);
  EXPECT_TRUE(std::isnan(errors_with_states().evaluate(0, 100)[0]));
  EXPECT_EQ(errors_with_states().evaluate(0, 100)[1], 0);
}

}  // namespace
}  // namespace abbe
