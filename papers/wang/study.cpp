#include "wang/study.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/parallel_blocks.h"
#include "wang/integrated.h"
#include "wang/tables.h"

namespace abbe {
namespace {

constexpr std::size_t kWangAxes = 6;
constexpr std::size_t kTableX = 0, kTableY = 1, kTableZ = 2, kTableA = 3, kTableB = 4,
                      kTableC = 5;  // order of the tables
constexpr std::array<std::size_t, kWangAxes> kChainToTable = {kTableC, kTableX, kTableZ, kTableA, kTableY, kTableB};

double position_of(std::size_t table, std::size_t row) {
  return wang_row(table, row).position * (table >= kTableA ? kDegree : 1.0);
}

}  // namespace

Machine wang_machine() {
  Machine machine;
  machine.name = "Gear grinder of Wang et al. (2020)";
  machine.description = "six axes; Tables A1 to A6 are measured on it";
  for (std::size_t table : kChainToTable) {
    Axis axis;
    axis.name = kWangAxisNames[table];
    axis_kind_from_letter(axis.name[0], axis.kind);
    axis.direction = direction_from_letter(axis.name[0]);
    axis.side = table == kTableC ? ChainSide::workpiece : ChainSide::tool;
    axis.travel_min = position_of(table, 0);
    axis.travel_max = position_of(table, 11);
    machine.axes.push_back(axis);
  }
  machine.tool_offset = {200, 0, 0};
  return machine;
}

ErrorSet wang_errors(const WangReading& reading) {
  double angle_unit = 0;
  if (reading.angles == WangAngleUnit::degrees) angle_unit = kDegree;
  if (reading.angles == WangAngleUnit::millidegrees) angle_unit = 1e-3 * kDegree;
  ErrorSet errors;
  errors.composition = reading.composition;
  for (std::size_t axis = 0; axis < kWangAxes; ++axis) {
    const std::size_t table = kChainToTable[axis];
    Basis basis{.kind = BasisKind::table_linear};
    for (std::size_t i = 0; i < reading.rows; ++i) basis.nodes.push_back(position_of(table, i));
    basis.from = basis.nodes.front();
    basis.to = basis.nodes.back();
    for (int k = 0; k < kComponentCount; ++k) {
      ErrorMotion motion{axis, static_cast<Component>(k), basis, {}, {}};
      for (std::size_t i = 0; i < reading.rows; ++i) {
        const WangRow& row = wang_row(table, i);
        const std::array<double, kComponentCount> values = {row.dx, row.dy, row.dz, row.ex, row.ey, row.ez};
        const double unit = k < 3 ? (reading.displacements ? 1e-3 : 0.0) : angle_unit;
        motion.coefficients.push_back(values[static_cast<std::size_t>(k)] * unit);
      }
      errors.motions.push_back(motion);
    }
  }
  return errors;
}

WangError wang_integrated_error(const Machine& machine, const ErrorSet& errors, const std::vector<double>& positions) {
  WangError result;
  result.tool_actual = actual_bed_from_tool(machine, errors, positions).translation;
  result.workpiece_actual = actual_bed_from_workpiece(machine, errors, positions) * wang_workpiece_point();
  const Eigen::Vector3d tool = nominal_bed_from_tool(machine, positions).translation;
  const Eigen::Vector3d workpiece = nominal_bed_from_workpiece(machine, positions) * wang_workpiece_point();
  result.machine = (result.workpiece_actual - result.tool_actual) - (workpiece - tool);
  return result;
}

std::vector<double> wang_positions(const std::vector<std::size_t>& rows_xyzabc) {
  std::vector<double> positions;
  for (std::size_t table : kChainToTable) positions.push_back(position_of(table, rows_xyzabc[table]));
  return positions;
}

std::vector<std::size_t> wang_zero_rows() { return {0, 0, 0, 0, 6, 0}; }

std::vector<double> wang_zero_pose() { return wang_positions(wang_zero_rows()); }

bool is_of_the_order(double value, double order) {
  return value >= std::sqrt(0.1) * order && value <= std::sqrt(10.0) * order;
}

WangPopulation wang_all_poses(const WangReading& reading, int threads) {
  const Machine machine = wang_machine();
  const ErrorSet errors = wang_errors(reading);
  const WangIntegratedPlan plan(machine, errors);

  PoseGrid grid;
  for (std::size_t table : kChainToTable) {
    std::vector<double> values;
    for (std::size_t i = 0; i < reading.rows; ++i) values.push_back(position_of(table, i));
    grid.values.push_back(values);
  }
  const PoseSource poses = pose_source(grid);
  std::vector<double> norm(poses.count);
  constexpr std::size_t kBlock = 4096;
  const std::size_t blocks = (poses.count + kBlock - 1) / kBlock;
  std::vector<Eigen::Vector3d> sums(blocks, Eigen::Vector3d::Zero());

  for_each_block(blocks, threads, [&](std::size_t block) {
    const std::size_t first = block * kBlock;
    const std::size_t count = std::min(kBlock, poses.count - first);
    std::array<std::vector<double>, kWangAxes> axis;
    axis.fill(std::vector<double>(kBlock));
    std::array<double*, kWangAxes> writable;
    std::array<const double*, kWangAxes> readable;
    for (std::size_t i = 0; i < kWangAxes; ++i) readable[i] = writable[i] = axis[i].data();
    poses.fill(first, count, writable.data());
    const PositionArrays positions{readable, count};

    std::array<std::vector<double>, 3> e;
    e.fill(std::vector<double>(count));
    plan.evaluate(positions, {e[0].data(), e[1].data(), e[2].data()});
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector3d error(e[0][k], e[1][k], e[2][k]);
      norm[first + k] = error.norm();
      sums[block] += error;
    }
  });

  WangPopulation population;
  population.norm = sample_statistics(norm);
  for (std::size_t block = 0; block < blocks; ++block) {
    population.mean_components += sums[block] / static_cast<double>(poses.count);
  }
  const auto near = std::count_if(norm.begin(), norm.end(), [](double e) { return is_of_the_order(e, 1); });
  population.share_of_order_1_mm = static_cast<double>(near) / static_cast<double>(norm.size());
  population.histogram = histogram(norm, 0, population.norm.maximum, 60);
  population.worst_pose.resize(kWangAxes);
  std::array<double*, kWangAxes> worst;
  for (std::size_t i = 0; i < kWangAxes; ++i) worst[i] = &population.worst_pose[i];
  poses.fill(population.norm.maximum_at, 1, worst.data());
  return population;
}

}  // namespace abbe
