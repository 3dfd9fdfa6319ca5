#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/machine/reference_rows_for_test.h"

/// Nominal kinematics of published machines against numbers computed by others; see tests/golden/*/README.md.
namespace abbe {
namespace {

using Row = test::ReferenceRow;

std::vector<Row> read_rows(const std::string& name) {
  return test::reference_rows(std::string(ABBE_GOLDEN "/") + name);
}

double value(const Row& row, const std::string& column) { return std::stod(row.at(column)); }

Eigen::Vector3d vector(const Row& row, const std::string& x, const std::string& y, const std::string& z) {
  return {value(row, x), value(row, y), value(row, z)};
}

/// Commands of Yin's machine in chain order from columns with a prefix.
std::vector<double> engraver_commands(const Row& row, const std::string& prefix, const std::string& suffix, double c2) {
  return {c2,
          value(row, prefix + "X" + suffix),
          value(row, prefix + "Y" + suffix),
          value(row, prefix + "Z" + suffix),
          value(row, prefix + "C1_deg") * kDegree,
          value(row, prefix + "A_deg") * kDegree};
}

/// Largest difference of a solution from commands, rotary ones as mm at 1000 mm.
double difference(const Machine& machine, const InverseSolution& solution, const std::vector<double>& commands) {
  double largest = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const double move = solution.position[i] - commands[i];
    largest = std::max(largest, machine.axes[i].kind == AxisKind::rotary
                                    ? 1000 * std::abs(std::remainder(move, 2 * std::numbers::pi))
                                    : std::abs(move));
  }
  return largest;
}

bool contains(const Machine& machine, const InverseResult& result, const std::vector<double>& commands) {
  for (const InverseSolution& solution : result.solutions) {
    if (difference(machine, solution, commands) <= 1e-9) return true;
  }
  return false;
}

TEST(YinEngraver, ForwardKinematicsAgreesInBothConventions) {
  for (const Row& row : read_rows("yin/forward_inverse.csv")) {
    const Machine machine = test::yin_engraver(row.at("conv")[0]);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, engraver_commands(row, "", "_mm", 0));
    EXPECT_LE((pose.translation - vector(row, "px", "py", "pz")).norm(), 1e-9) << row.at("pose") << row.at("conv");
    EXPECT_LE((pose.rotation.col(2) - vector(row, "i", "j", "k")).norm(), 1e-14) << row.at("pose") << row.at("conv");
  }
}

TEST(YinEngraver, InverseKinematicsFindsBothBranches) {
  int singular = 0, regular = 0;
  for (const Row& row : read_rows("yin/forward_inverse.csv")) {
    const Machine machine = test::yin_engraver(row.at("conv")[0]);
    InverseOptions options;
    options.all_turns = true;
    const InverseKinematics inverse(machine, options);
    const PoseTarget target = PoseTarget::at(vector(row, "px", "py", "pz"), vector(row, "i", "j", "k"));
    const InverseResult result = inverse.solve(target, engraver_commands(row, "", "_mm", 0));
    EXPECT_TRUE(contains(machine, result, engraver_commands(row, "pos_", "", 0))) << row.at("pose") << row.at("conv");
    EXPECT_TRUE(contains(machine, result, engraver_commands(row, "neg_", "", 0))) << row.at("pose") << row.at("conv");
    const bool free = result.solutions.at(0).singularity == PoseSingularity::tool_parallel;
    EXPECT_EQ(free, value(row, "singular") != 0) << row.at("pose");
    singular += free;
    regular += !free;
    if (free) {
      const std::string held = "C1 is free, held at " + row.at("C1_deg");
      EXPECT_NE(describe(machine, result.solutions[0]).find(held), std::string::npos) << held;
    }
  }
  EXPECT_EQ(singular, 8);
  EXPECT_EQ(regular, 24);
}

/// The positioning transformation (8) with the values of Table 3.
RigidTransform positioning_transform() {
  const double alpha = -0.103 * kDegree, beta = -0.034 * kDegree, gamma = -0.097 * kDegree;
  return {rotation_about(Eigen::Vector3d::UnitX(), alpha) * rotation_about(Eigen::Vector3d::UnitY(), beta) *
              rotation_about(Eigen::Vector3d::UnitZ(), gamma),
          {-73.896, 94.924, 33.385}};
}

TEST(YinEngraver, WorkpiecePointsOfTableA4GoThroughPositioningAndTheTurntable) {
  const std::vector<Row> rows = read_rows("yin/p0_A4_chain.csv");
  EXPECT_EQ(rows.size(), 120u);
  for (const Row& row : rows) {
    Machine machine = test::yin_engraver(row.at("conv")[0]);
    const RigidTransform d = positioning_transform();
    machine.bed_from_workpiece = row.at("eq8_means") == "DBW" ? d.inverse() : d;
    const double c2 = value(row, "C2_deg") * kDegree;
    InverseOptions options;
    options.held = {{machine.find_axis("C2"), c2}};
    const PoseTarget target =
        PoseTarget::at(vector(row, "p_WCS_x", "p_WCS_y", "p_WCS_z"), vector(row, "v_WCS_x", "v_WCS_y", "v_WCS_z"));
    const InverseResult result = InverseKinematics(machine, options).solve(target);
    for (const char* branch : {"pos_", "neg_"}) {
      EXPECT_TRUE(contains(machine, result, engraver_commands(row, branch, "", c2)))
          << row.at("point") << row.at("conv") << row.at("eq8_means") << branch;
    }
  }
}

/// Commands of Liu's scanner in chain order C A X Y Z.
std::vector<double> scanner_commands(double c_deg, double a_deg, double x, double y, double z) {
  return {c_deg * kDegree, a_deg * kDegree, x, y, z};
}

TEST(LiuScanner, ForwardKinematicsAgrees) {
  for (const Row& row : read_rows("liu/points.csv")) {
    Machine machine = test::liu_scanner();
    machine.tool_offset.z() = -value(row, "h_mm");
    const RigidTransform pose = nominal_workpiece_from_tool(
        machine, scanner_commands(value(row, "C_deg"), value(row, "A_deg"), value(row, "x_mm"), value(row, "y_mm"),
                                  value(row, "z_mm")));
    EXPECT_LE((pose.translation - vector(row, "nominal_x", "nominal_y", "nominal_z")).norm(), 1e-9);
  }
}

TEST(LiuScanner, InverseKinematicsFindsThePublishedBranch) {
  const Machine machine = test::liu_scanner();
  const InverseKinematics inverse(machine);
  for (const Row& row : read_rows("liu/inverse_pose.csv")) {
    const PoseTarget target = PoseTarget::at(vector(row, "p_x", "p_y", "p_z"), vector(row, "n_x", "n_y", "n_z"));
    const InverseResult result = inverse.solve(target);
    EXPECT_EQ(result.solutions.size(), std::abs(value(row, "n_y")) == 1 ? 1u : 2u);
    EXPECT_TRUE(contains(machine, result,
                         scanner_commands(value(row, "C_deg"), value(row, "A_deg"), value(row, "X"), value(row, "Y"),
                                          value(row, "Z_for_h=0.05(h0)"))));
  }
}

TEST(AguadoTable, ForwardKinematicsIsThePublishedModelWithoutErrors) {
  // p_bed = Z0 + (0, 0, z) + T; p_X = p_bed - (-x, 0, 0); p_C = Rz(c) (p_X - C0).
  Machine machine = test::aguado_table();
  const Eigen::Vector3d offset(60, 0, -150), z0(0, 0, 300), c0(699.7148742739481, -0.20895713340667849, -100);
  machine.tool_offset = offset;
  for (int i = 0; i < 50; ++i) {
    const double c = 0.12 * i, x = 28.0 * i, z = 600 - 12.0 * i;
    const Eigen::Vector3d carriage = z0 + Eigen::Vector3d(x, 0, z) + offset - c0;
    const Eigen::Vector3d expected(std::cos(c) * carriage.x() - std::sin(c) * carriage.y(),
                                   std::sin(c) * carriage.x() + std::cos(c) * carriage.y(), carriage.z());
    EXPECT_LE((nominal_workpiece_from_tool(machine, {c, x, z}).translation - expected).norm(), 1e-9);
  }
}

TEST(WangGrinder, ForwardKinematicsIsTheCorrectedEquation32) {
  // x = x_i + x_t cosB + z_t sinB and so on, as seen from the bed; the workpiece turns by +C.
  const Machine machine = test::wang_grinder();
  std::mt19937_64 generator(4);
  for (int i = 0; i < 200; ++i) {
    const std::vector<double> q = test::random_commands(machine, generator);
    const double c = q[0], x = q[1], z = q[2], a = q[3], y = q[4], b = q[5], t = 200;
    const Eigen::Vector3d tool(x + t * std::cos(b), y * std::cos(a) + std::sin(a) * t * std::sin(b),
                               z + y * std::sin(a) - std::cos(a) * t * std::sin(b));
    const Eigen::Vector3d expected(std::cos(c) * tool.x() + std::sin(c) * tool.y(),
                                   -std::sin(c) * tool.x() + std::cos(c) * tool.y(), tool.z() - 400);
    EXPECT_LE((nominal_workpiece_from_tool(machine, q).translation - expected).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace abbe
