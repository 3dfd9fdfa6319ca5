#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/reference_rows_for_test.h"

/// Compiled chains against numbers computed by others from published errors; see tests/golden/*/README.md.
namespace abbe {
namespace {

using Row = test::ReferenceRow;

std::vector<Row> read_rows(const std::string& name) {
  return test::reference_rows(std::string(ABBE_GOLDEN "/") + name);
}

double value(const Row& row, const std::string& column) { return std::stod(row.at(column)); }

Eigen::Vector3d vector(const Row& row, const std::string& stem) {
  return {value(row, stem + "x"), value(row, stem + "y"), value(row, stem + "z")};
}

Eigen::Vector3d seen(const Machine& machine, const ErrorSet& errors, Body from, Body to,
                     const std::vector<double>& positions, const Eigen::Vector3d& start) {
  const ChainPlan plan(machine, errors, from, to);
  std::vector<const double*> pointers;
  for (const double& position : positions) pointers.push_back(&position);
  Eigen::Vector3d point;
  plan.transform({pointers, 1}, {&start[0], &start[1], &start[2]}, {&point[0], &point[1], &point[2]});
  return point;
}

Axis axis_of_letter(char letter, ChainSide side) {
  Axis axis;
  axis.name.push_back(letter);
  axis_kind_from_letter(letter, axis.kind);
  axis.direction = direction_from_letter(letter);
  axis.side = side;
  return axis;
}

Machine grinding_machine() {
  Machine machine;
  for (const char letter : std::string("CXZAYB")) {
    machine.axes.push_back(axis_of_letter(letter, letter == 'C' ? ChainSide::workpiece : ChainSide::tool));
  }
  return machine;
}

/// Tables A1 to A6 as linear tables. @param angle_unit  rad per printed degree
ErrorSet grinding_errors(const Machine& machine, double angle_unit) {
  const std::vector<Row> rows = read_rows("wang/errors_all_wide.csv");
  const char* components[] = {"dx", "dy", "dz", "ex", "ey", "ez"};
  ErrorSet errors;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::string& name = machine.axes[i].name;
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    Basis basis;
    basis.kind = BasisKind::table_linear;
    for (const Row& row : rows) {
      basis.nodes.push_back(rotary ? value(row, name + "_pos_deg") * kDegree : value(row, name + "_pos_mm"));
    }
    basis.from = basis.nodes.front();
    basis.to = basis.nodes.back();
    for (int k = 0; k < kComponentCount; ++k) {
      ErrorMotion motion{i, static_cast<Component>(k), basis, {}, {}};
      for (const Row& row : rows) {
        const double printed = value(row, name + "_" + components[k] + (k < 3 ? "_um" : "_deg"));
        motion.coefficients.push_back(printed * (k < 3 ? 1e-3 : angle_unit));
      }
      errors.motions.push_back(motion);
    }
  }
  return errors;
}

TEST(PublishedErrors, GrindingMachineGivesTheReferencePosesInEveryConventionAndUnit) {
  const Machine machine = grinding_machine();
  const Eigen::Vector3d tool(200, 0, 0), workpiece(0, 0, 400);
  const std::map<std::string, double> units = {{"deg", kDegree}, {"mdeg", 1e-3 * kDegree}, {"none", 0.0}};
  const std::map<std::string, Composition> conventions = {{"iso", {}},
                                                          {"post", {ErrorOrder::after_motion, false}},
                                                          {"pre", {ErrorOrder::before_motion, false}},
                                                          {"post_lin", {ErrorOrder::after_motion, true}}};
  int compared = 0;
  for (const Row& row : read_rows("wang/forward_chain.csv")) {
    ErrorSet errors = grinding_errors(machine, units.at(row.at("angle_unit")));
    errors.composition = conventions.at(row.at("convention"));
    std::vector<double> positions;
    for (const Axis& axis : machine.axes) {
      positions.push_back(value(row, "q" + axis.name) * (axis.kind == AxisKind::rotary ? kDegree : 1.0));
    }
    const Eigen::Vector3d tool_actual = seen(machine, errors, Body::tool, Body::bed, positions, tool);
    const Eigen::Vector3d workpiece_actual = seen(machine, errors, Body::workpiece, Body::bed, positions, workpiece);
    const Eigen::Vector3d tool_nominal = seen(machine, {}, Body::tool, Body::bed, positions, tool);
    const Eigen::Vector3d workpiece_nominal = seen(machine, {}, Body::workpiece, Body::bed, positions, workpiece);
    const Eigen::Vector3d error = (workpiece_actual - tool_actual) - (workpiece_nominal - tool_nominal);
    EXPECT_LE((tool_actual - vector(row, "Tact_")).norm(), 1e-8) << row.at("convention") << row.at("angle_unit");
    EXPECT_LE((workpiece_actual - vector(row, "Wact_")).norm(), 1e-8);
    EXPECT_LE((error - vector(row, "E_")).norm(), 1e-8);
    ++compared;
  }
  EXPECT_EQ(compared, 117);
}

TEST(PublishedErrors, TrackerPointsOfTheTableMachineAreReproduced) {
  std::ifstream file(std::string(ABBE_GOLDEN "/aguado/truth.json"));
  const nlohmann::json truth = nlohmann::json::parse(file);
  const auto vector3 = [](const nlohmann::json& v) {
    return Eigen::Vector3d(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  Machine machine;  // w C' X' b Z t
  machine.axes = {axis_of_letter('C', ChainSide::workpiece), axis_of_letter('X', ChainSide::workpiece),
                  axis_of_letter('Z', ChainSide::tool)};
  machine.axes[0].primed = machine.axes[1].primed = true;
  machine.axes[0].point = vector3(truth["C0"]);
  machine.bed_from_workpiece = RigidTransform::translate(machine.axes[0].point);
  machine.axes[2].point = machine.tool_reference = vector3(truth["Z0"]);

  ErrorSet errors;
  const auto add = [&](std::size_t axis, const char* name, const Basis& basis) {
    for (std::size_t k = 0; k < 6; ++k) {
      ErrorMotion motion{axis, static_cast<Component>(k), basis, {}, {}};
      for (const nlohmann::json& row : truth[name]) motion.coefficients.push_back(row[k].get<double>());
      errors.motions.push_back(motion);
    }
  };
  Basis basis;
  basis.order = 4;
  basis.to = truth["Xrange"][1].get<double>();
  add(1, "X_legendre_rows_P0_Pn_cols_dx_dy_dz_EA_EB_EC", basis);
  basis.to = truth["Zrange"][1].get<double>();
  add(2, "Z_legendre", basis);
  basis.kind = BasisKind::fourier;
  basis.to = basis.period = 2 * std::numbers::pi;
  add(0, "C_fourier_rows_1_c1_s1_c2_s2", basis);

  const nlohmann::json& lt = truth["lt"];
  const Eigen::Matrix3d tracker_axes =
      rotation_from_error_angles({lt[3].get<double>(), lt[4].get<double>(), lt[5].get<double>()});
  const std::vector<Row> rows = read_rows("aguado/aguado_500_noise0.csv");
  ASSERT_EQ(rows.size(), 500u);
  for (const Row& row : rows) {
    const std::vector<double> positions = {value(row, "c_deg") * kDegree, value(row, "x_mm"), value(row, "z_mm")};
    const Eigen::Vector3d offset(value(row, "Tx_mm"), value(row, "Ty_mm"), value(row, "Tz_mm"));
    const Eigen::Vector3d on_table = seen(machine, errors, Body::tool, Body::workpiece, positions, offset);
    const Eigen::Vector3d in_tracker = tracker_axes.transpose() * (on_table - vector3(lt));
    const Eigen::Vector3d measured(value(row, "XLT_x_mm"), value(row, "XLT_y_mm"), value(row, "XLT_z_mm"));
    EXPECT_LE((in_tracker - measured).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace abbe
