#include "wang/integrated.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "abbe/machine/axis_unit.h"
#include "abbe/study/report/report_data.h"
#include "abbe/verify/error_map.h"

namespace abbe {
namespace {

/// Points of a body over a block of poses.
struct PointBlock {
  std::array<std::vector<double>, 3> xyz;
  explicit PointBlock(std::size_t count) { xyz.fill(std::vector<double>(count)); }
  PointBlock(std::size_t count, const Eigen::Vector3d& point) : PointBlock(count) {
    for (std::size_t d = 0; d < 3; ++d) std::fill(xyz[d].begin(), xyz[d].end(), point[static_cast<Eigen::Index>(d)]);
  }
  PointArrays arrays() { return {xyz[0].data(), xyz[1].data(), xyz[2].data()}; }
  ConstPointArrays constant() const { return {xyz[0].data(), xyz[1].data(), xyz[2].data()}; }
};

/// Derivatives of a seen point's three coordinates at one pose by all parameters, [3, parameters].
Eigen::MatrixXd point_slopes(const ChainPlan& plan, PositionArrays positions, const Eigen::Vector3d& start,
                             std::size_t parameters) {
  const PointBlock from(1, start);
  PointBlock seen(1);
  plan.transform(positions, from.constant(), seen.arrays());
  constexpr double kOne = 1, kNone = 0;
  const RowArrays rows[] = {
      {{&kOne, &kNone, &kNone}, {}}, {{&kNone, &kOne, &kNone}, {}}, {{&kNone, &kNone, &kOne}, {}}};
  std::vector<std::size_t> all(parameters);
  std::iota(all.begin(), all.end(), std::size_t{0});
  Eigen::MatrixXd slopes(3, static_cast<Eigen::Index>(parameters));  // column by column, as differentiate() fills it
  plan.differentiate(positions, from.constant(), seen.constant(), rows, all, slopes.data(), 3);
  return slopes;
}

}  // namespace

WangIntegratedPlan::WangIntegratedPlan(const Machine& machine, const ErrorSet& errors,
                                       const Eigen::Vector3d& workpiece_point)
    : tool_offset_(machine.tool_offset),
      workpiece_point_(workpiece_point),
      parameters_(errors.parameter_count()),
      tool_actual_(machine, errors, Body::tool, Body::bed),
      tool_nominal_(machine, ErrorSet{}, Body::tool, Body::bed),
      work_actual_(machine, errors, Body::workpiece, Body::bed),
      work_nominal_(machine, ErrorSet{}, Body::workpiece, Body::bed) {}

void WangIntegratedPlan::evaluate(PositionArrays positions, PointArrays error, PointArrays machining_point) const {
  const std::size_t count = positions.count;
  const PointBlock on_tool(count, tool_offset_), on_work(count, workpiece_point_);
  PointBlock tool(count), tool_nominal(count), work(count), work_nominal(count);
  tool_actual_.transform(positions, on_tool.constant(), tool.arrays());
  tool_nominal_.transform(positions, on_tool.constant(), tool_nominal.arrays());
  work_actual_.transform(positions, on_work.constant(), work.arrays());
  work_nominal_.transform(positions, on_work.constant(), work_nominal.arrays());
  double* const errors[] = {error.x, error.y, error.z};
  double* const points[] = {machining_point.x, machining_point.y, machining_point.z};
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t k = 0; k < count; ++k) {
      const double nominal = work_nominal.xyz[d][k] - tool_nominal.xyz[d][k];
      errors[d][k] = (work.xyz[d][k] - tool.xyz[d][k]) - nominal;
      if (points[d] != nullptr) points[d][k] = 0.0 - nominal;  // no minus zero
    }
  }
}

Eigen::Matrix3d WangIntegratedPlan::covariance_at(const std::vector<double>& positions,
                                                  const Eigen::MatrixXd& covariance) const {
  std::vector<const double*> axis;
  for (const double& position : positions) axis.push_back(&position);
  const PositionArrays pose{axis, 1};
  const Eigen::MatrixXd slopes = point_slopes(work_actual_, pose, workpiece_point_, parameters_) -
                                 point_slopes(tool_actual_, pose, tool_offset_, parameters_);
  // A table has one or two values that count at a position: a tenth of the parameters.
  std::vector<Eigen::Index> used;
  for (Eigen::Index p = 0; p < slopes.cols(); ++p) {
    if (!slopes.col(p).isZero(0)) used.push_back(p);
  }
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  for (const Eigen::Index p : used) {
    for (const Eigen::Index q : used) result += covariance(p, q) * slopes.col(p) * slopes.col(q).transpose();
  }
  return result;
}

WangMap wang_map(const ErrorSet& errors, const PoseList& poses, const Eigen::MatrixXd* covariance) {
  const WangIntegratedPlan plan(wang_machine(), errors);
  const std::size_t count = poses.count();
  WangMap map;
  map.poses = poses;
  map.error.fill(std::vector<double>(count));
  map.machining_point = map.error;
  std::vector<const double*> axis;
  for (const std::vector<double>& values : map.poses.axis) axis.push_back(values.data());
  plan.evaluate({axis, count}, {map.error[0].data(), map.error[1].data(), map.error[2].data()},
                {map.machining_point[0].data(), map.machining_point[1].data(), map.machining_point[2].data()});
  const auto error_at = [&](std::size_t k) {
    return Eigen::Vector3d(map.error[0][k], map.error[1][k], map.error[2][k]);
  };
  for (std::size_t k = 0; k < count; ++k) map.norm.push_back(error_at(k).norm());
  map.statistics = sample_statistics(map.norm);
  if (covariance == nullptr) return map;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Matrix3d at = plan.covariance_at(poses.pose(k), *covariance);
    for (std::size_t d = 0; d < 3; ++d) {
      const auto i = static_cast<Eigen::Index>(d);
      map.uncertainty[d].push_back(std::sqrt(std::max(0.0, at(i, i))));
    }
    const Eigen::Vector3d along = error_at(k).normalized();
    map.norm_uncertainty.push_back(std::sqrt(std::max(0.0, along.dot(at * along))));
  }
  return map;
}

PoseList wang_poses_of(const PoseGrid& grid) {
  const PoseSource source = pose_source(grid);
  PoseList poses;
  poses.axis.assign(source.axes, std::vector<double>(source.count));
  std::vector<double*> pointers;
  for (std::vector<double>& values : poses.axis) pointers.push_back(values.data());
  source.fill(0, source.count, pointers.data());
  return poses;
}

WangMap wang_grid_map(const ErrorSet& errors, const Eigen::MatrixXd* covariance) {
  constexpr std::size_t kRows[] = {0, 3, 6, 10};
  PoseGrid grid;
  grid.values.resize(wang_machine().axes.size());
  for (const std::size_t row : kRows) {
    const std::vector<double> positions = wang_positions({row, row, row, row, row, row});
    for (std::size_t i = 0; i < positions.size(); ++i) grid.values[i].push_back(positions[i]);
  }
  WangMap map = wang_map(errors, wang_poses_of(grid), covariance);
  map.counts.assign(grid.values.size(), std::size(kRows));
  return map;
}

MapData wang_map_data(const WangMap& map) {
  const Machine machine = wang_machine();
  MapData data;
  data.points = map.machining_point;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    data.fields.push_back({axis.name,
                           axis.kind == AxisKind::rotary ? Quantity::angle : Quantity::length,
                           position_suffix(axis),
                           {map.poses.axis[i]}});
  }
  const auto three = [](const std::array<std::vector<double>, 3>& v) {
    return std::vector<std::vector<double>>{v[0], v[1], v[2]};
  };
  data.fields.push_back({"E", Quantity::length, "um", three(map.error)});
  if (!map.norm_uncertainty.empty()) {
    data.fields.push_back({"standard_uncertainty_E", Quantity::length, "um", three(map.uncertainty)});
  }
  // Poses run with the last axis fastest, map files with the first direction fastest.
  data.grid.assign(map.counts.rbegin(), map.counts.rend());
  return data;
}

nlohmann::ordered_json wang_report_map(const WangMap& map, const std::string& description) {
  ErrorMap drawn;
  drawn.point = map.machining_point;
  drawn.displacement = map.error;
  drawn.norm = map.norm;
  drawn.norm_uncertainty = map.norm_uncertainty;
  drawn.covered.assign(map.norm.size(), 1);
  drawn.statistics = map.statistics;
  nlohmann::ordered_json json = report_map(wang_machine(), map.poses, drawn, nullptr,
                                           map.norm_uncertainty.empty() ? nullptr : &drawn, description);
  json["frame"] = "machine";
  json["quantity"] = "integrated error E of equation (18)";
  json["note"] =
      "E is the displacement of the workpiece point relative to the tool point, in the machine frame. It is not the "
      "volumetric error of the tool in the workpiece frame. The nominal points are the machining points: nominal tool "
      "point minus nominal workpiece point.";
  return json;
}

}  // namespace abbe
