#include "abbe/errors/calibrated_machine.h"

#include <gtest/gtest.h>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

TEST(CalibratedMachine, ItsNominalPoseIsTheActualOneForAllLocationErrors) {
  for (const char* chain :
       {"w C2' X Y b Z C1 A t", "w C2' b X Y Z C1 A t", "w A' C' X' b Y Z t", "w B' X' b Z Y C A t"}) {
    Machine machine = parse_chain(chain).machine;
    machine.axes.front().direction = Eigen::Vector3d(-0.6, 0.48, -0.64);
    machine.axes.back().direction = Eigen::Vector3d(0.1, 0.2, 0.9).normalized();
    RandomStream random(11);
    ErrorSet errors;
    for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
      for (int k = 0; k < kComponentCount; ++k) {
        const auto component = static_cast<Component>(k);
        if (!location_error_is_valid(machine.axes[axis], component)) continue;
        errors.locations.push_back({axis, component, 0.02 * random.normal(), 0});
      }
    }
    errors.tool_offset_error = {0.1, -0.2, 0.3};
    const CalibratedMachine calibrated = calibrated_machine(machine, errors);
    EXPECT_EQ(calibrated.variable, "");
    for (int i = 0; i < 20; ++i) {
      std::vector<double> command, position;
      for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
        command.push_back(machine.axes[axis].kind == AxisKind::linear ? random.uniform(-200, 200)
                                                                      : random.uniform(-2, 2));
        position.push_back(command.back() + calibrated.zero[axis]);
      }
      const RigidTransform actual = actual_workpiece_from_tool(machine, errors, command);
      const RigidTransform nominal = nominal_workpiece_from_tool(calibrated.machine, position);
      EXPECT_LT((actual.translation - nominal.translation).norm(), 1e-10) << chain;
      EXPECT_LT((actual.rotation - nominal.rotation).norm(), 1e-13) << chain;
      // The errors are no small thing here.
      EXPECT_GT((actual.translation - nominal_workpiece_from_tool(machine, command).translation).norm(), 0.1);
    }
  }
}

TEST(CalibratedMachine, NamesAnErrorThatDependsOnThePosition) {
  const Machine machine = parse_chain("w X' b Z t").machine;
  ErrorSet errors;
  ErrorMotion motion;
  motion.axis = 0;
  motion.component = Component::Y;
  motion.basis.kind = BasisKind::monomial;
  motion.coefficients = {0.0};
  errors.motions = {motion};
  EXPECT_EQ(calibrated_machine(machine, errors).variable, "");
  errors.motions[0].coefficients = {1e-3};
  EXPECT_EQ(calibrated_machine(machine, errors).variable, "EYX");
}

}  // namespace
}  // namespace abbe
